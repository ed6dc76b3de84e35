// Generated volumes with known answers. Densities are integers, so that every writer is exact.
#pragma once

#include <functional>
#include <string>

#include "volumes/geometry/geometry.h"

namespace supple {

/// A dense volume as a function of the voxel.
struct Phantom {
  Geometry geometry;
  std::function<float(int i, int j, int k)> density;
};

/// A head in HU: skin, fat, skull with jaws and orbits, brain, ventricles, airways; dims voxels,
/// geometry like ct_head (left-handed index frame, +j to the face, +k up).
Phantom head_phantom(const Vec3i& dims);
/// Ball of `value` with a soft rim in 0, centred.
Phantom sphere_phantom(int size, float radius, float value);
/// Grey 0 (rigid) … 255 (soft): horizontal gradient square in a white surrounding, one slice, as in
/// the thesis' figure 4.10.
Phantom gradient_phantom(int size);
/// Rigid T (0) in soft tissue (255), one slice, as in figures 4.5 and 4.9.
Phantom t_shape_phantom(int size);
/// Irregular, non-square shape with rigid and soft parts, void outside (figure 4.13): void is 255,
/// material 0…254.
Phantom irregular_phantom(int size);
/// The one-slice phantom repeated `count` times along k (figure 4.15).
Phantom extrude(const Phantom& slice, int count);
/// Two lips in HU, 40 x 24 x 28 voxels of 1 mm: soft bars along i, k = 2 to 11 and 16 to 25, with a
/// slit of air between them.
Phantom lips_phantom();
/// Constant value (figure 4.14).
Phantom constant_phantom(const Vec3i& dims, float value);

}  // namespace supple

// Procedural sampling paths (thesis sections 3.3.1 and 3.3.5, figure 3.3): a body is shown deformed
// by sampling it along bent, and possibly broken, paths.
//
// Functions are given by the deformation that one sees. Of each the map and its inverse are known:
// material seen at x was at p(x), and the sampling path is o(x) = p(x) - x. Several functions act
// on the body one after another; a body that was moved before (a simulated deformation) is followed
// on from p(x), so that o(x) = p(x) - x + o_moved(p(x)).
// Cost: 0.1 to 0.5 µs per voxel of the seen body, function and core, once; bricks in which the body
// falls apart cost as much per sample.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/field/offset_field.h"
#include "volumes/geometry/geometry.h"

namespace supple {

/// A deformation of space, in LPS mm, continuous but for the faces of its pieces.
class PathFunction {
 public:
  virtual ~PathFunction() = default;

  /// Pieces that the body falls into; each has a smooth map of its own, defined everywhere.
  virtual int pieces() const { return 1; }
  /// The place at which material from `from`, as part of the piece, is seen. Throws InputError
  /// where the function would turn the body inside out.
  virtual Vec3d forward(const Vec3d& from, int piece) const = 0;
  /// The source of material seen at `at`, as part of the piece; exactly `at` where nothing moves,
  /// NaN where nothing is seen.
  virtual Vec3d backward(const Vec3d& at, int piece) const = 0;
  /// Distance of `from` to the nearest face of the piece, negative outside of the piece.
  virtual double depth_mm(const Vec3d& from, int piece) const;
};

/// Functions that act on a body one after another.
using SamplingPath = std::vector<std::shared_ptr<const PathFunction>>;

/// A body at rest, `body` (elements and shell, or all that a volume holds), as seen along the path.
/// The path may lead out of the source box; offsets are there where the body is seen. Identity
/// regions have offsets of exactly 0. Throws InputError where a function would turn the body inside
/// out, for a path with more than 4096 pieces and for one that leads beyond 10^6 voxels; Cancelled.
OffsetField follow_path(const SamplingPath& path, const Geometry& geometry,
                        const BrickTopology& body, Progress* progress = nullptr);

/// A body that has moved already, seen along the path. Keeps the certificate.
OffsetField follow_path(const SamplingPath& path, const OffsetField& moved,
                        Progress* progress = nullptr);

/// The same in the material direction: material at X + u(X) moves on along the path.
Displacement move_along(const SamplingPath& path, const Displacement& displacement);

}  // namespace supple

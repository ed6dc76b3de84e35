// The thesis' figures as generated volumes (sections 4.2 and 4.3). Plain grey images, one slice
// thick, with 1 mm voxels; grey is softness.
#include "volumes/phantom/phantom.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

constexpr float kRigid = 0, kSoft = 255;

Geometry plain_geometry(const Vec3i& dims) {
  return Geometry(dims, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
}

/// Position of a voxel centre within 0…1 of `size` voxels.
double unit_position(int voxel, int size) {
  return (voxel + 0.5) / size;
}

bool within(double value, double lo, double hi) {
  return value >= lo && value < hi;
}

}  // namespace

Phantom sphere_phantom(int size, float radius, float value) {
  const double center = 0.5 * (size - 1);
  return {plain_geometry({size, size, size}), [=](int i, int j, int k) {
            constexpr double kRim = 2.0;  // voxels from full to no density
            const double distance = Vec3d(i - center, j - center, k - center).length();
            const double inside = std::clamp(0.5 - (distance - double(radius)) / kRim, 0.0, 1.0);
            return float(std::round(inside * double(value)));
          }};
}

Phantom gradient_phantom(int size) {
  return {plain_geometry({size, size, 1}), [=](int i, int j, int) {
            const double x = unit_position(i, size), y = unit_position(j, size);
            if (!within(x, 0.2, 0.8) || !within(y, 0.2, 0.8)) return kSoft;
            return float(std::round((x - 0.2) / 0.6 * double(kSoft)));
          }};
}

Phantom t_shape_phantom(int size) {
  return {plain_geometry({size, size, 1}), [=](int i, int j, int) {
            const double x = unit_position(i, size), y = unit_position(j, size);
            const bool bar = within(x, 0.2, 0.8) && within(y, 0.2, 0.36);
            const bool stem = within(x, 0.42, 0.58) && within(y, 0.2, 0.8);
            return bar || stem ? kRigid : kSoft;
          }};
}

Phantom irregular_phantom(int size) {
  return {plain_geometry({size, size, 1}), [=](int i, int j, int) {
            constexpr float kVoid = 255, kSoftest = 254;
            const double x = 2 * unit_position(i, size) - 1, y = 2 * unit_position(j, size) - 1;
            const double radius = std::hypot(x, y), angle = std::atan2(y, x);
            const double outline = 0.68 + 0.16 * std::cos(3 * angle) + 0.10 * std::sin(2 * angle);
            const bool hole = std::hypot(x + 0.30, y - 0.05) < 0.11;
            if (radius > outline || hole) return kVoid;
            // A rigid bone in the lower lobe, stiffening towards it.
            const double from_bone = std::hypot((x - 0.35) / 1.6, y + 0.02) - 0.12;
            return float(std::round(std::clamp(from_bone / 0.30, 0.0, 1.0) * double(kSoftest)));
          }};
}

Phantom extrude(const Phantom& slice, int count) {
  const Vec3i& dims = slice.geometry.dims();
  return {slice.geometry.with_dims({dims.x, dims.y, count}),
          [density = slice.density](int i, int j, int) { return density(i, j, 0); }};
}

Phantom lips_phantom() {
  return {plain_geometry({40, 24, 28}), [](int i, int j, int k) {
            constexpr double kAir = -1000, kFlesh = 60;
            const double across = std::hypot(j - 11.5, k - (k < 14 ? 6.5 : 20.5)) - 5;
            const double ends = std::abs(i - 19.5) - 17;
            const double inside = std::clamp(0.5 - std::max(across, ends), 0.0, 1.0);
            return float(std::round(kAir + inside * (kFlesh - kAir)));
          }};
}

Phantom constant_phantom(const Vec3i& dims, float value) {
  return {plain_geometry(dims), [value](int, int, int) { return value; }};
}

}  // namespace supple

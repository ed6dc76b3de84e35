#include "lib/contact/collider_contact.h"

#include <algorithm>
#include <cmath>

#include "lib/contact/friction.h"
#include "lib/contact/mesh_surface.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr int kRounds = 16;
constexpr double kToleranceMm = 1e-9;

[[noreturn]] void fail(const std::string& found, const std::string& expected) {
  throw InputError({"", "collider", found, expected});
}

/// Distance from a point or segment's nearest point, which has no direction where both coincide.
SurfaceDistance round_distance(const Vec3d& from, double radius) {
  const double length = from.length();
  if (length == 0) return {-radius, {0, 0, 1}};
  return {length - radius, from / length};
}

SurfaceDistance distance_of(const SphereShape& s, const Vec3d& p) {
  return round_distance(p - s.centre_mm, s.radius_mm);
}

SurfaceDistance distance_of(const PlaneShape& s, const Vec3d& p) {
  return {s.normal.dot(p - s.point_mm), s.normal};
}

SurfaceDistance distance_of(const CapsuleShape& s, const Vec3d& p) {
  const Vec3d axis = s.b_mm - s.a_mm;
  const double length2 = axis.length2();
  const double part = length2 > 0 ? std::clamp(axis.dot(p - s.a_mm) / length2, 0.0, 1.0) : 0;
  return round_distance(p - (s.a_mm + axis * part), s.radius_mm);
}

SurfaceDistance distance_of(const BoxShape& s, const Vec3d& p) {
  // In the box's own axes q is how far beyond each pair of faces the point lies.
  Vec3d outside(0.0), nearest_axis(0.0);
  double deepest = -HUGE_VAL;
  for (const Vec3d& half : s.half_axes_mm) {
    const double extent = half.length();
    const Vec3d axis = half / extent;
    const double along = axis.dot(p - s.centre_mm);
    const double q = std::abs(along) - extent;
    const Vec3d facing = along < 0 ? -axis : axis;
    if (q > 0) outside += facing * q;
    if (q > deepest) {
      deepest = q;
      nearest_axis = facing;
    }
  }
  if (deepest <= 0) return {deepest, nearest_axis};
  const double length = outside.length();
  return {length, outside / length};
}

SurfaceDistance distance_of(const MeshShape& s, const Vec3d& p) {
  return s.surface->distance_to(p - s.offset_mm);
}

/// True where the box of a mesh alone clears a point: most nodes need no search for a triangle.
bool is_clear(const Collider& collider, const Vec3d& p, double reach_mm) {
  const auto* mesh = std::get_if<MeshShape>(&collider.shape);
  return mesh != nullptr &&
         mesh->surface->is_farther(p - mesh->offset_mm, collider.thickness_mm + reach_mm);
}

void validate_shape(const SphereShape& s) {
  if (!(s.radius_mm > 0)) fail("a sphere of radius " + number_text(s.radius_mm), "above 0 mm");
}
void validate_shape(const PlaneShape& s) {
  if (!(std::abs(s.normal.length() - 1) < 1e-6)) {
    fail("a normal of length " + number_text(s.normal.length()), "length 1");
  }
}
void validate_shape(const CapsuleShape& s) {
  if (!(s.radius_mm > 0)) fail("a capsule of radius " + number_text(s.radius_mm), "above 0 mm");
}
void validate_shape(const BoxShape& s) {
  for (int a = 0; a < 3; ++a) {
    const Vec3d& half = s.half_axes_mm[a];
    const Vec3d& next = s.half_axes_mm[(a + 1) % 3];
    if (!(half.length() > 0)) fail("a box with a half axis of length 0", "three above 0 mm");
    if (!(std::abs(half.dot(next)) < 1e-6 * half.length() * next.length())) {
      fail("a box with oblique axes", "perpendicular axes");
    }
  }
}
void validate_shape(const MeshShape& s) {
  if (s.surface == nullptr) fail("no mesh", "a mesh surface");
}

void shift(SphereShape& s, const Vec3d& by) {
  s.centre_mm += by;
}
void shift(PlaneShape& s, const Vec3d& by) {
  s.point_mm += by;
}
void shift(CapsuleShape& s, const Vec3d& by) {
  s.a_mm += by;
  s.b_mm += by;
}
void shift(BoxShape& s, const Vec3d& by) {
  s.centre_mm += by;
}
void shift(MeshShape& s, const Vec3d& by) {
  s.offset_mm += by;
}

}  // namespace

Shape shifted(Shape shape, const Vec3d& by_mm) {
  std::visit([&](auto& s) { shift(s, by_mm); }, shape);
  return shape;
}

void validate(const Collider& collider) {
  std::visit([](const auto& shape) { validate_shape(shape); }, collider.shape);
  if (!(collider.thickness_mm >= 0) || !(collider.friction >= 0)) {
    fail("thickness " + number_text(collider.thickness_mm) + ", friction " +
             number_text(collider.friction),
         "at least 0");
  }
}

SurfaceDistance distance_to(const Shape& shape, const Vec3d& pos_mm) {
  return std::visit([&](const auto& s) { return distance_of(s, pos_mm); }, shape);
}

double depth_in(const Collider& collider, const Vec3d& pos_mm, double reach_mm, Vec3d& normal) {
  if (is_clear(collider, pos_mm, reach_mm)) return -1 - reach_mm;
  const SurfaceDistance surface = distance_to(collider.shape, pos_mm);
  normal = surface.normal;
  return collider.thickness_mm - surface.distance_mm;
}

Vec3d after_friction(const Collider& collider, const Vec3d& normal, double depth_mm,
                     const Vec3d& start_mm, double dt_s, const Vec3d& pos_mm) {
  if (collider.friction == 0) return pos_mm;
  const Vec3d moved = pos_mm - start_mm - collider.velocity_mm_s * dt_s;
  return pos_mm - slip_taken_back(collider.friction, normal, depth_mm, moved);
}

std::vector<PressedNode> take_pressure(const std::vector<Collider>& colliders,
                                       const std::vector<char>& is_held,
                                       const std::vector<Vec3d>& pos_mm,
                                       std::vector<Vec3d>& force_mn) {
  constexpr double kTouchMm = 1e-6;
  std::vector<PressedNode> pressed;
  for (std::size_t n = 0; n < pos_mm.size() && !colliders.empty(); ++n) {
    if (is_held[n]) continue;
    for (std::size_t c = 0; c < colliders.size(); ++c) {
      Vec3d normal(0.0);
      if (depth_in(colliders[c], pos_mm[n], kTouchMm, normal) < -kTouchMm) continue;
      const double outwards = force_mn[n].dot(normal);
      if (outwards >= 0) continue;
      pressed.push_back({int(n), int(c), normal, -outwards});
      force_mn[n] -= normal * outwards;
    }
  }
  return pressed;
}

double push_out(const std::vector<Collider>& colliders, const Vec3d& start_mm, double dt_s,
                Vec3d& pos_mm, bool& touched) {
  double left = 0;
  for (int round = 0; round < kRounds; ++round) {
    left = 0;
    for (const Collider& collider : colliders) {
      Vec3d normal(0.0);
      const double depth = depth_in(collider, pos_mm, 0, normal);
      if (depth <= 0) continue;
      left = std::max(left, depth);
      touched = true;
      pos_mm = after_friction(collider, normal, depth, start_mm, dt_s, pos_mm + normal * depth);
    }
    if (left <= kToleranceMm) return 0;
  }
  // The last round moved the node; the depth that is left now counts.
  left = 0;
  for (const Collider& collider : colliders) {
    left = std::max(left, collider.thickness_mm - distance_to(collider.shape, pos_mm).distance_mm);
  }
  return left;
}

ContactReport leave_shapes(const std::vector<Collider>& colliders, const std::vector<char>& is_held,
                           std::vector<Vec3d>& pos_mm) {
  ContactReport report;
  if (colliders.empty()) return report;
  std::vector<Collider> smooth = colliders;
  for (Collider& collider : smooth) collider.friction = 0;
  for (std::size_t n = 0; n < pos_mm.size(); ++n) {
    if (is_held[n]) continue;
    bool touched = false;
    const double left = push_out(smooth, pos_mm[n], 0, pos_mm[n], touched);
    report.penetration_mm = std::max(report.penetration_mm, left);
    report.contacts += touched;
  }
  return report;
}

ContactReport resolve_contacts(const std::vector<Collider>& colliders,
                               const std::vector<char>& is_held, const std::vector<Vec3d>& start_mm,
                               double dt_s, std::vector<Vec3d>& pos_mm,
                               std::vector<Vec3d>& velocity_mm_s) {
  ContactReport report;
  if (colliders.empty()) return report;
  for (std::size_t n = 0; n < pos_mm.size(); ++n) {
    if (is_held[n]) continue;
    bool touched = false;
    const double left = push_out(colliders, start_mm[n], dt_s, pos_mm[n], touched);
    if (!touched) continue;
    velocity_mm_s[n] = (pos_mm[n] - start_mm[n]) / dt_s;
    report.penetration_mm = std::max(report.penetration_mm, left);
    ++report.contacts;
  }
  return report;
}

}  // namespace supple

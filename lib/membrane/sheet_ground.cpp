#include "lib/membrane/sheet_ground.h"

#include <algorithm>
#include <cmath>

#include "lib/contact/friction.h"

namespace supple {

namespace {

SurfaceDistance distance_of(const HollowSphere& s, const Vec3d& p) {
  const Vec3d inward = s.centre_mm - p;
  const double length = std::sqrt(inward.length2());
  return {s.radius_mm - length, length > 0 ? inward / length : Vec3d(0, 0, -1)};
}

SurfaceDistance distance_of(const LensShape& s, const Vec3d& p) {
  const SurfaceDistance front = distance_to(Shape(s.front), p),
                        back = distance_to(Shape(s.back), p);
  return front.distance_mm > back.distance_mm ? front : back;
}

SurfaceDistance distance_of(const VoxelSolid& s, const Vec3d& p) {
  const Approach near = s.distance_to(p);
  return {near.distance_mm, near.normal};
}

template <class Known>
SurfaceDistance distance_of(const Known& s, const Vec3d& p) {
  return distance_to(Shape(s), p);
}

/// True where a quick look says that a point is farther away than that.
template <class Surface>
bool is_clear(const Surface&, const Vec3d&, double) {
  return false;
}
bool is_clear(const HollowSphere& s, const Vec3d& p, double reach_mm) {
  const double room = s.radius_mm - reach_mm;
  return room > 0 && (p - s.centre_mm).length2() < room * room;
}
bool is_clear(const SphereShape& s, const Vec3d& p, double reach_mm) {
  const double reach = s.radius_mm + reach_mm;
  return (p - s.centre_mm).length2() > reach * reach;
}
bool is_clear(const LensShape& s, const Vec3d& p, double reach_mm) {
  return is_clear(s.front, p, reach_mm) || is_clear(s.back, p, reach_mm);
}

}  // namespace

SurfaceDistance distance_to(const RigidSurface& surface, const Vec3d& pos_mm) {
  return std::visit([&](const auto& s) { return distance_of(s, pos_mm); }, surface);
}

std::vector<char> SheetGround::settle(std::vector<Vec3d>& points_mm, double reach_mm) const {
  std::vector<char> is_near(points_mm.size(), 0);
  for (std::size_t n = 0; n < points_mm.size(); ++n) {
    for (const Obstacle& obstacle : m_obstacles) {
      const SurfaceDistance near = distance_to(obstacle.surface, points_mm[n]);
      is_near[n] |= std::abs(near.distance_mm) <= reach_mm;
      points_mm[n] += near.normal * std::max(0.0, m_thickness_mm - near.distance_mm);
    }
  }
  return is_near;
}

void SheetGround::begin(const Sheet& sheet) {
  m_pushes_mm.assign(std::size_t(sheet.node_count()), Vec3d(0.0));
}

void SheetGround::push(Sheet& sheet) {
  m_mesh = 0;
  for (const Obstacle& obstacle : m_obstacles) {
    std::visit([&](const auto& s) { push_from(s, sheet); }, obstacle.surface);
  }
}

template <class Surface>
void SheetGround::push_from(const Surface& surface, Sheet& sheet) {
  // Distances round: a node that has just been put onto the surface is not moved again.
  constexpr double kRoundingMm = 1e-12;
  const double reach_mm = m_thickness_mm - kRoundingMm;
  for (std::size_t n = 0; n < m_pushes_mm.size(); ++n) {
    Vec3d& pos = sheet.body.pos_mm[n];
    if (sheet.mobility[n] == 0 || is_clear(surface, pos, reach_mm)) continue;
    const SurfaceDistance near = distance_of(surface, pos);
    const double depth = m_thickness_mm - near.distance_mm;
    if (depth <= kRoundingMm) continue;
    pos += near.normal * depth;
    m_pushes_mm[n] += near.normal * depth;
  }
}

void SheetGround::push_from(const MeshShape& surface, Sheet& sheet) {
  const std::size_t count = m_pushes_mm.size(), first = count * m_mesh++;
  if (m_planes.size() < first + count) m_planes.resize(first + count);
  for (std::size_t n = 0; n < count; ++n) {
    Vec3d& pos = sheet.body.pos_mm[n];
    if (sheet.mobility[n] == 0) continue;
    NearPlane& plane = m_planes[first + n];
    const double far = plane.surface.distance_mm - m_thickness_mm;
    const double moved = (pos - plane.at_mm).length();
    if (moved < far) continue;
    if (!(moved < 0.25 * m_thickness_mm)) plane = {pos, distance_of(surface, pos)};
    const double depth =
        m_thickness_mm - plane.surface.distance_mm - plane.surface.normal.dot(pos - plane.at_mm);
    if (depth <= 0) continue;
    pos += plane.surface.normal * depth;
    m_pushes_mm[n] += plane.surface.normal * depth;
  }
}

void SheetGround::rub(Sheet& sheet, double friction) const {
  if (friction == 0) return;
  for (std::size_t n = 0; n < m_pushes_mm.size(); ++n) {
    const double push = m_pushes_mm[n].length();
    if (push == 0 || sheet.mobility[n] == 0) continue;
    const Vec3d normal = m_pushes_mm[n] / push;
    Vec3d& pos = sheet.body.pos_mm[n];
    pos -= slip_taken_back(friction, normal, push, pos - sheet.start_mm[n]);
  }
}

}  // namespace supple

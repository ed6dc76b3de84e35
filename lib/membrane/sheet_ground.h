// Ground under a membrane: rigid surfaces that nodes never enter.
//
// Triangle meshes are looked at anew where a node has gone a quarter of its thickness; in between
// the plane that is nearest stands for them.
#pragma once

#include "lib/membrane/sheet.h"

namespace supple {

/// Distance of a point to a surface, negative behind it, and the direction into free space. Next to
/// the rim of a lens it is too small, and its sign right.
SurfaceDistance distance_to(const RigidSurface& surface, const Vec3d& pos_mm);

class SheetGround {
 public:
  SheetGround() = default;
  SheetGround(std::vector<Obstacle> obstacles, double thickness_mm)
      : m_obstacles(std::move(obstacles)), m_thickness_mm(thickness_mm) {}

  /// Moves points at rest out of the ground, and tells which are near enough to cling.
  std::vector<char> settle(std::vector<Vec3d>& points_mm, double reach_mm) const;

  /// Forgets pushes of the substep before.
  void begin(const Sheet& sheet);
  /// Moves nodes that no one holds out of the ground, and adds up by how much.
  void push(Sheet& sheet);
  /// Takes back slip along the ground, up to `friction` times the push.
  void rub(Sheet& sheet, double friction) const;

  /// Sum of this substep's pushes per node.
  const std::vector<Vec3d>& pushes_mm() const { return m_pushes_mm; }

 private:
  template <class Surface>
  void push_from(const Surface& surface, Sheet& sheet);
  void push_from(const MeshShape& surface, Sheet& sheet);

  /// Plane that stood for a mesh when a node was here.
  struct NearPlane {
    Vec3d at_mm{HUGE_VAL, 0, 0};
    SurfaceDistance surface{0, {0, 0, 1}};
  };
  std::vector<Obstacle> m_obstacles;
  double m_thickness_mm = 0;
  std::vector<Vec3d> m_pushes_mm;
  std::vector<NearPlane> m_planes;  // per node, of each mesh
  std::size_t m_mesh = 0;           // that push_from is at
};

}  // namespace supple

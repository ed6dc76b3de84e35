// Triangle meshes of a scene that changes all the time, for packets of rays of a camera and to a
// lamp.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/microscope/layer_lanes.h"
#include "raycast/microscope/packet.h"
#include "raycast/microscope/shape_normals.h"
#include "raycast/microscope/triangle_bins.h"
#include "raycast/microscope/triangle_lanes.h"

namespace supple {

/// Columns of a motion of a shape, in floats as rays have them.
struct ShapeMotion {
  Vec3f x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin{0, 0, 0};
  Vec3f turned(const Vec3f& v) const { return x * v.x + y * v.y + z * v.z; }
};

/// Part of the light that passes a shape.
struct ShapeShadow {
  bool blocks = true;
  double dims = 1;  // where it does not block
};

class ShapeScene {
 public:
  /// Adds a shape without triangles and returns its number.
  int add(const ShapeShadow& shadow);
  /// Gives a shape its triangles. Throws InputError: an index without vertex, a vertex that is not
  /// finite.
  void shape(int number, const std::vector<Vec3d>& vertices_mm, const Triangles& triangles,
             double crease_degrees);
  void place(int number, const ShapeMotion& motion);
  /// Makes changes known to rays.
  void commit();
  /// Takes the lamp and the disc that its light comes from, as of the last commit.
  void light_from(const LampFloats& lamp, const DiscReach& disc);

  /// Sorts the triangles by blocks of a camera's picture, as of the last commit.
  void sort_seen(const LensFloats& lens, int width, int height, TriangleBins& seen) const;
  /// First of the listed triangles along rays.
  void first_hits(const PacketRays& rays, const TriangleList& list, PacketHits& hits) const {
    supple::first_hits(m_triangles.data(), list, rays, hits);
  }
  /// Smooth normals of all triangles.
  const CornerNormals* normals() const { return m_normals.data(); }
  /// Triangles that may stand before the lamp, sorted by the directions of its light.
  const TriangleBins& before_lamp() const { return m_before_lamp; }
  /// Part of light that passes the listed triangles along each ray, 0 … 1.
  void passing(const PacketRays& rays, const TriangleList& list, LaneFloats& part) const;

 private:
  struct SceneShape {
    int dim_steps = 0;  // as of its triangles
    ShapeMotion motion;
    std::vector<Vec3f> vertices;  // before its motion
    Triangles triangles;
    std::vector<Vec3f> corner_normals;
    std::size_t first = 0;  // of its triangles among all
    bool is_changed = true;
  };
  void move_triangles(SceneShape& shape, int number);

  std::vector<SceneShape> m_shapes;
  std::vector<TriangleFloats> m_triangles;  // of all shapes, in the world
  std::vector<CornerNormals> m_normals;
  std::vector<Vec3f> m_moved;  // vertices of the shape that is looked at
  TriangleBins m_before_lamp;
};

}  // namespace supple

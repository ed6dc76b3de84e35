// Triangle meshes of a scene that changes all the time, for packets of rays: rigid ones are built
// once and placed as instances, soft ones are built anew for every shape. Embree is known to this
// file's source alone.
#pragma once

#include <memory>
#include <vector>

#include "raycast/microscope/packet.h"
#include "raycast/microscope/shape_normals.h"

namespace supple {

/// Part of the light that passes a shape.
struct ShapeShadow {
  bool blocks = true;
  double dims = 1;  // where it does not block
};

/// Columns of a motion of a shape, in floats as rays have them.
struct ShapeMotion {
  Vec3f x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin{0, 0, 0};
  Vec3f turned(const Vec3f& v) const { return x * v.x + y * v.y + z * v.z; }
};

class ShapeScene {
 public:
  /// Throws SystemError when Embree gives no device.
  ShapeScene();
  ~ShapeScene();
  ShapeScene(const ShapeScene&) = delete;
  ShapeScene& operator=(const ShapeScene&) = delete;

  /// Adds a shape without triangles and returns its number.
  int add(const ShapeShadow& shadow);
  /// Gives a shape its triangles: built to be fast to hit, or fast to build. Throws InputError: an
  /// index without vertex, a vertex that is not finite.
  void shape(int number, const std::vector<Vec3d>& vertices_mm, const Triangles& triangles,
             double crease_degrees, bool is_rigid);
  void place(int number, const ShapeMotion& motion);
  /// Makes changes known to rays. Throws SystemError.
  void commit();

  /// First triangles of rays that are near each other.
  void first_hits(const PacketRays& rays, PacketHits& hits) const;
  /// Smooth unit normal of a hit, in the world.
  Vec3f normal(const PacketHits& hits, int lane) const;
  /// Part of light that passes along each ray, 0 … 1.
  void passing(const PacketRays& rays, LaneFloats& part) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple

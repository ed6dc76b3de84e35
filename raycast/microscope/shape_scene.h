// Triangle meshes of a scene that changes all the time, for packets of rays: rigid ones are built
// once and placed as instances, soft ones are built anew for every shape. Embree is known to this
// file's source alone.
#pragma once

#include <memory>
#include <vector>

#include "raycast/microscope/caster_box.h"
#include "raycast/microscope/packet.h"
#include "raycast/microscope/seen_blocks.h"
#include "raycast/microscope/shape_normals.h"

namespace supple {

/// Part of the light that passes a shape.
struct ShapeShadow {
  bool blocks = true;
  double dims = 1;  // where it does not block
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

  /// Marks where a camera may see triangles, as of the last commit.
  void mark_seen(SeenBlocks& seen) const;
  /// First triangles of rays that are near each other.
  void first_hits(const PacketRays& rays, PacketHits& hits) const;
  /// Smooth unit normal of a hit, in the world.
  Vec3f normal(const PacketHits& hits, int lane) const;
  /// False where nothing can stand between any of the wanted places and what lies within `reach_mm`
  /// of the light: most places of an eye need no rays for their shadows.
  bool may_shade(const PacketPlaces& places, std::uint32_t wanted, const Vec3f& light,
                 float reach_mm) const;
  /// Part of light that passes along each ray, 0 … 1.
  void passing(const PacketRays& rays, LaneFloats& part) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple

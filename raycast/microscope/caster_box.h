// Boxes around what casts shadows, and whether light to a packet of places can meet them: a cheap
// question before rays are sent.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/microscope/packet.h"
#include "volumes/base/vec.h"

namespace supple {

/// Columns of a motion of a shape, in floats as rays have them.
struct ShapeMotion {
  Vec3f x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin{0, 0, 0};
  Vec3f turned(const Vec3f& v) const { return x * v.x + y * v.y + z * v.z; }
};

/// All straight ways between two balls of a radius.
struct WideSegment {
  Vec3f from, to;
  float radius_mm;
};

/// The ways from wanted places, lifted from their surfaces, to what lies within `reach_mm` of the
/// light.
WideSegment segment_between(const PacketPlaces& places, std::uint32_t wanted, const Vec3f& light,
                            float reach_mm);

/// The box around a shape's vertices, moved with it.
class CasterBox {
 public:
  CasterBox(const std::vector<Vec3d>& vertices_mm, const ShapeMotion& motion);
  void move(const ShapeMotion& motion);
  /// Never false where a way meets the shape.
  bool may_meet(const WideSegment& segment) const;

 private:
  Vec3f m_low{0, 0, 0}, m_high{0, 0, 0};  // before the motion
  Vec3f m_origin{0, 0, 0};
  Vec3f m_rows[3], m_widths{0, 0, 0};  // back to before the motion; the rows' lengths
};

}  // namespace supple

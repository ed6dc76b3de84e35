#include "raycast/microscope/caster_box.h"

#include <algorithm>
#include <limits>

namespace supple {

namespace {

constexpr float kMarginMm = 0.03f;  // for lifts of places and rounding

}  // namespace

WideSegment segment_between(const PacketPlaces& places, std::uint32_t wanted, const Vec3f& light,
                            float reach_mm) {
  const Vec3f endless(std::numeric_limits<float>::max());
  Vec3f low = endless, high = -endless;
  for (int c = 0; c < 3; ++c) {
    const LaneFloats& at = c == 0 ? places.at.x : c == 1 ? places.at.y : places.at.z;
    for (int lane = 0; lane < kPacketRays; ++lane) {
      const bool is_wanted = (wanted >> lane & 1) != 0;
      low[c] = std::min(low[c], is_wanted ? at[lane] : low[c]);
      high[c] = std::max(high[c], is_wanted ? at[lane] : high[c]);
    }
  }
  const float radius = (high - low).length() / 2;
  return {(low + high) * 0.5f, light, std::max(radius, reach_mm) + kMarginMm};
}

CasterBox::CasterBox(const std::vector<Vec3d>& vertices_mm, const ShapeMotion& motion) {
  if (!vertices_mm.empty()) m_low = m_high = Vec3f(vertices_mm[0]);
  for (const Vec3d& vertex : vertices_mm) {
    for (int c = 0; c < 3; ++c) {
      m_low[c] = std::min(m_low[c], float(vertex[c]));
      m_high[c] = std::max(m_high[c], float(vertex[c]));
    }
  }
  move(motion);
}

void CasterBox::move(const ShapeMotion& motion) {
  m_origin = motion.origin;
  const Vec3f across = motion.y.cross(motion.z);
  const float volume = motion.x.dot(across);
  m_rows[0] = across / volume;
  m_rows[1] = motion.z.cross(motion.x) / volume;
  m_rows[2] = motion.x.cross(motion.y) / volume;
  for (int c = 0; c < 3; ++c) m_widths[c] = m_rows[c].length();
}

bool CasterBox::may_meet(const WideSegment& segment) const {
  const Vec3f from = segment.from - m_origin, way = segment.to - segment.from;
  float enters = 0, leaves = 1;
  for (int c = 0; c < 3; ++c) {
    const float start = m_rows[c].dot(from), speed = m_rows[c].dot(way);
    const float wide = segment.radius_mm * m_widths[c];
    const float a = (m_low[c] - wide - start) / speed, b = (m_high[c] + wide - start) / speed;
    // What is no number, as of a shape that is pressed flat, changes nothing.
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return !(enters > leaves);
}

}  // namespace supple

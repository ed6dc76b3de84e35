#include "lib/instruments/tool_path.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/units.h"

namespace supple {

namespace {

/// Rodrigues' formula.
Vec3d turned(const Vec3d& v, const Vec3d& axis, double radians) {
  const double c = std::cos(radians), s = std::sin(radians);
  return v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1 - c));
}

/// The axis of the turn that takes one frame to another, times the sine of its angle.
Vec3d turn_between(const ToolFrame& a, const ToolFrame& b) {
  return (a.x.cross(b.x) + a.y.cross(b.y) + a.z.cross(b.z)) * 0.5;
}

}  // namespace

ToolPath::ToolPath(const InstrumentPose& from, const InstrumentPose& to, const Vec3d* pivot_mm)
    : m_from(from), m_to(to), m_frame(frame_of(from)) {
  const ToolFrame end = frame_of(to);
  const auto depth = [&](const ToolFrame& frame) {
    return pivot_mm == nullptr ? 0.0 : (*pivot_mm - frame.tip_mm).dot(frame.z);
  };
  m_depth_mm = depth(m_frame);
  m_deeper_mm = depth(end) - m_depth_mm;
  m_centre_mm = m_frame.tip_mm + m_frame.z * m_depth_mm;
  m_way_mm = end.tip_mm + end.z * depth(end) - m_centre_mm;
  const Vec3d turn = turn_between(m_frame, end);
  const double cosine =
      (m_frame.x.dot(end.x) + m_frame.y.dot(end.y) + m_frame.z.dot(end.z) - 1) / 2;
  const double sine = turn.length();
  m_turn_radians = std::atan2(sine, cosine);
  if (sine > 1e-12) {
    m_turn_axis = turn / sine;
  } else if (cosine < 0) {  // half a turn: its axis is between a direction and where that goes
    const Vec3d sums[3] = {m_frame.x + end.x, m_frame.y + end.y, m_frame.z + end.z};
    m_turn_axis = std::max_element(sums, sums + 3, [](const Vec3d& a, const Vec3d& b) {
                    return a.length2() < b.length2();
                  })->normalized();
  }
}

InstrumentPose ToolPath::at(double part) const {
  if (part >= 1) return m_to;
  if (part <= 0) return m_from;
  const double radians = m_turn_radians * part;
  InstrumentPose pose;
  pose.axis = turned(m_frame.z, m_turn_axis, radians).normalized();
  pose.tip_mm = m_centre_mm + m_way_mm * part - pose.axis * (m_depth_mm + m_deeper_mm * part);
  const Vec3d x = turned(m_frame.x, m_turn_axis, radians);
  const ToolFrame level = frame_of({pose.tip_mm, pose.axis, 0, 0, 0});
  const double roll = std::atan2(x.dot(level.y), x.dot(level.x)) * kDegreesPerRadian;
  pose.roll_degrees = roll + 360 * std::round((m_to.roll_degrees - roll) / 360);
  pose.opening_degrees = m_from.opening_degrees * (1 - part) + m_to.opening_degrees * part;
  pose.active = m_to.active;
  return pose;
}

double ToolPath::reach_mm(const InstrumentPart& part) const {
  const double highest = std::max(m_depth_mm, m_depth_mm + m_deeper_mm);
  const double lowest = std::min(m_depth_mm, m_depth_mm + m_deeper_mm);
  double reach = 0;
  for (const Vec3d& end : {part.shape.a_mm, part.shape.b_mm}) {
    reach = std::max(
        {reach, (end - Vec3d(0, 0, lowest)).length(), (end - Vec3d(0, 0, highest)).length()});
  }
  return reach;
}

double ToolPath::sag_mm(const Instrument& instrument, const InstrumentPart& part,
                        double share) const {
  const double turn = m_turn_radians * share;
  double sag = reach_mm(part) * turn * turn / 8 + std::abs(m_deeper_mm) * share * turn / 4;
  if (part.jaw == 0) return sag;
  const double opened =
      std::abs(m_to.opening_degrees - m_from.opening_degrees) * kRadiansPerDegree / 2 * share;
  const double length = std::max((part.shape.a_mm - instrument.hinge_mm).length(),
                                 (part.shape.b_mm - instrument.hinge_mm).length());
  return sag + length * opened * (opened / 8 + turn / 4);
}

double ToolPath::longest_mm(const Instrument& instrument) const {
  double longest = 0;
  for (const InstrumentPart& part : instrument.parts) {
    longest = std::max(longest, reach_mm(part) * m_turn_radians);
  }
  const double opened = std::abs(m_to.opening_degrees - m_from.opening_degrees);
  return longest + m_way_mm.length() + std::abs(m_deeper_mm) +
         instrument.hinge_mm.length() * opened * kRadiansPerDegree / 2;
}

}  // namespace supple

#include <cmath>

#include "lib/instruments/instrument.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// A direction or place turned about the x axis.
Vec3d about_x(const Vec3d& v, double degrees) {
  const double c = std::cos(degrees * kRadiansPerDegree), s = std::sin(degrees * kRadiansPerDegree);
  return {v.x, v.y * c - v.z * s, v.y * s + v.z * c};
}

/// The angle of a jaw at a pose.
double jaw_degrees(const InstrumentPose& pose, int jaw) {
  return jaw * pose.opening_degrees / 2;
}

double mixed(double a, double b, double part) {
  return a + (b - a) * part;
}

/// Direction on the great circle; the nearer one of two that are opposite or nearly equal.
Vec3d mixed_axis(const Vec3d& a, const Vec3d& b, double part) {
  const double angle = std::atan2(a.cross(b).length(), a.dot(b));
  const double sine = std::sin(angle);
  const Vec3d axis = sine > 1e-9
                         ? (a * std::sin(angle * (1 - part)) + b * std::sin(angle * part)) / sine
                         : (part < 0.5 ? a : b);
  return axis.normalized();
}

}  // namespace

InstrumentPose pose_between(const InstrumentPose& from, const InstrumentPose& to, double part) {
  return {from.tip_mm + (to.tip_mm - from.tip_mm) * part, mixed_axis(from.axis, to.axis, part),
          mixed(from.roll_degrees, to.roll_degrees, part),
          mixed(from.opening_degrees, to.opening_degrees, part),
          mixed(from.active, to.active, part)};
}

ToolFrame frame_of(const InstrumentPose& pose) {
  // The shortest turn from the world's z to the axis takes x and y along: for the axis (a, b, c)
  // columns of 1 - [a² ab; ab b²] / (1 + c). Written by 1 + |c| it is exact near -z, too.
  const double length = pose.axis.length();
  const Vec3d z = length > 0 ? pose.axis / length : Vec3d(0, 0, 1);
  const double flat2 = z.x * z.x + z.y * z.y;
  const double below = z.z >= 0 ? 1 / (1 + z.z) : (flat2 > 0 ? (1 - z.z) / flat2 : 0);
  const Vec3d x(1 - z.x * z.x * below, -z.x * z.y * below, -z.x);
  const Vec3d y = z.cross(x);
  const double c = std::cos(pose.roll_degrees * kRadiansPerDegree);
  const double s = std::sin(pose.roll_degrees * kRadiansPerDegree);
  return {pose.tip_mm, x * c + y * s, y * c - x * s, z};
}

ToolFrame jaw_frame(const Instrument& instrument, const InstrumentPose& pose, int jaw) {
  const ToolFrame frame = frame_of(pose);
  if (jaw == 0) return frame;
  const double degrees = jaw_degrees(pose, jaw);
  const Vec3d tip = instrument.hinge_mm - about_x(instrument.hinge_mm, degrees);
  return {frame.place(tip), frame.x, frame.direction(about_x({0, 1, 0}, degrees)),
          frame.direction(about_x({0, 0, 1}, degrees))};
}

std::vector<RoundCone> parts_at(const Instrument& instrument, const InstrumentPose& pose) {
  const ToolFrame shaft = frame_of(pose);
  const ToolFrame jaws[2] = {jaw_frame(instrument, pose, -1), jaw_frame(instrument, pose, 1)};
  std::vector<RoundCone> placed;
  placed.reserve(instrument.parts.size());
  for (const InstrumentPart& part : instrument.parts) {
    const ToolFrame& frame = part.jaw == 0 ? shaft : jaws[part.jaw > 0];
    placed.push_back({frame.place(part.shape.a_mm), frame.place(part.shape.b_mm),
                      part.shape.a_radius_mm, part.shape.b_radius_mm});
  }
  return placed;
}

ToolMotion motion_of(int tool, const Instrument& instrument, const InstrumentPose& from,
                     const InstrumentPose& to) {
  ToolMotion motion{tool, from, to, {}};
  const std::vector<RoundCone> before = parts_at(instrument, from);
  const std::vector<RoundCone> after = parts_at(instrument, to);
  motion.parts.reserve(before.size());
  for (std::size_t n = 0; n < before.size(); ++n) motion.parts.push_back({before[n], after[n]});
  return motion;
}

}  // namespace supple

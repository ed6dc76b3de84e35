#include "lib/membrane/gripping.h"

#include <cmath>

#include "lib/instruments/round_cone.h"

namespace supple {

namespace {

Vec3d axis_between(const Vec3d& from, const Vec3d& to, double part) {
  const double angle = std::atan2(from.cross(to).length(), from.dot(to));
  // Great circles of nearly equal axes are straight, those of opposite axes are anything.
  if (angle < 1e-6 || angle > 3.1415) return part < 0.5 && angle > 1 ? from : to;
  return (from * std::sin((1 - part) * angle) + to * std::sin(part * angle)).normalized();
}

void add_event(MembraneReport& report, MembraneEvent::Kind kind, int tool, int count,
               const Vec3d& sum) {
  if (count > 0) report.events.push_back({kind, count, tool, sum / double(count)});
}

void take_hold(Sheet& sheet, const MembraneParams& params, int tool, const RoundCone& zone,
               const ToolFrame& frame, MembraneReport& report) {
  int count = 0;
  Vec3d sum(0.0);
  for (int n = 0; n < sheet.node_count(); ++n) {
    if (sheet.holder[n] >= 0) continue;
    const Vec3d local = frame.local(sheet.body.pos_mm[n]);
    if (approach(local, zone).distance_mm > params.thickness_mm) continue;
    sheet.holder[n] = tool;
    sheet.grip_mm[n] = local;
    sheet.mobility[n] = 0;
    ++count;
    sum += sheet.body.pos_mm[n];
  }
  add_event(report, MembraneEvent::Kind::gripped, tool, count, sum);
}

void let_go(Sheet& sheet, int tool, MembraneReport& report) {
  int count = 0;
  Vec3d sum(0.0);
  for (int n = 0; n < sheet.node_count(); ++n) {
    if (sheet.holder[n] != tool) continue;
    sheet.holder[n] = -1;
    sheet.mobility[n] = 1 / sheet.mass_kg[n];
    ++count;
    sum += sheet.body.pos_mm[n];
  }
  add_event(report, MembraneEvent::Kind::released, tool, count, sum);
}

}  // namespace

InstrumentPose pose_between(const InstrumentPose& from, const InstrumentPose& to, double part) {
  const auto mix = [part](const auto& a, const auto& b) { return a + (b - a) * part; };
  InstrumentPose pose;
  pose.tip_mm = mix(from.tip_mm, to.tip_mm);
  pose.axis = axis_between(from.axis, to.axis, part);
  pose.roll_degrees = mix(from.roll_degrees, to.roll_degrees);
  pose.opening_degrees = mix(from.opening_degrees, to.opening_degrees);
  pose.active = mix(from.active, to.active);
  return pose;
}

void grip(Sheet& sheet, const MembraneParams& params, int tool, const Instrument& instrument,
          const InstrumentPose& pose, std::vector<char>& is_closed, MembraneReport& report) {
  if (!instrument.grip) return;
  if (is_closed.size() <= std::size_t(tool)) is_closed.resize(std::size_t(tool) + 1, 0);
  char& closed = is_closed[std::size_t(tool)];
  const ToolFrame frame = frame_of(pose);
  if (!closed && pose.opening_degrees < instrument.grip->grips_below_degrees) {
    closed = 1;
    take_hold(sheet, params, tool, instrument.grip->zone, frame, report);
  } else if (closed && pose.opening_degrees > instrument.grip->releases_above_degrees) {
    closed = 0;
    let_go(sheet, tool, report);
  }
  if (!closed) return;
  for (int n = 0; n < sheet.node_count(); ++n) {
    if (sheet.holder[n] == tool) sheet.body.pos_mm[n] = frame.place(sheet.grip_mm[n]);
  }
}

}  // namespace supple

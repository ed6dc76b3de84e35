#include "lib/membrane/gripping.h"

#include "lib/instruments/round_cone.h"

namespace supple {

namespace {

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

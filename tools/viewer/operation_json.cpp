#include "tools/viewer/operation_json.h"

#include <filesystem>

#include "tools/scene/operation/operation_keys.h"

namespace supple::tools {

namespace {

Value pose_json(const InstrumentPose& pose) {
  return {{"tip", pose.tip_mm},
          {"axis", pose.axis},
          {"roll", pose.roll_degrees},
          {"opening", pose.opening_degrees},
          {"active", pose.active}};
}

/// The poses of instruments are told in the head's frame, as hands ask for them.
Value instruments_json(const LiveOperation& live) {
  Value all = Value::List();
  const Operation& operation = live.operation();
  for (std::size_t n = 0; n < operation.instruments().size(); ++n) {
    const InstrumentSample& sample = operation.sample().instruments[n];
    InstrumentPose pose = sample.pose;
    pose.tip_mm = operation.turn().to_head(pose.tip_mm);
    pose.axis = operation.turn().to_head(pose.axis);
    all.push_back({{"name", operation.instruments()[n].name},
                   {"is_led", live.is_led(int(n))},
                   {"asked", pose_json(live.asked(int(n)))},
                   {"pose", pose_json(pose)},
                   {"force_n", sample.force_n}});
  }
  return all;
}

Value membranes_json(const LiveOperation& live) {
  Value all = Value::List();
  for (const MembraneSample& sample : live.operation().sample().membranes) {
    ModelChange now{0, live.model(int(all.size()))};
    all.push_back({{"name", sample.body},
                   {"model", fields_value(fields(now))["model"]},
                   {"clinging_mm2", sample.clinging_mm2}});
  }
  return all;
}

Value microscope_json(const Camera& camera) {
  return {{"position", camera.position_lps_mm},
          {"target", camera.target_lps_mm},
          {"up", camera.up_lps},
          {"fov", camera.vertical_fov_degrees}};
}

Value view_json(const MicroscopeView& view, double time_s) {
  MicroscopeView copy = view;
  const Value keys = fields_value(fields(copy));
  return {{"focus", view.focus_at(time_s)},
          {"zoom", view.zoom_at(time_s)},
          {"stereo", keys["stereo"]},
          {"shadow", keys["shadow"]},
          {"size", Value::List{view.size[0], view.size[1]}},
          {"camera", microscope_json(view.camera_at(time_s))}};
}

/// Points of each category, and how far tasks have come.
Value score_json(const OperationScore& score) {
  const Value whole = to_value(score);
  Value points = Value::Entries();
  for (const Value::Entry& part : whole["categories"].entries()) {
    points[part.key] = {{"title", part.value["title"]}, {"points", part.value["points"]}};
  }
  return {{"total", score.total()}, {"categories", points}, {"tasks", whole["tasks"]}};
}

}  // namespace

Value operation_json(const LiveOperation& live) {
  const OperationScene& scene = live.scene();
  Value instruments = Value::List(), membranes = Value::List();
  for (const Instrument& one : live.operation().instruments()) {
    OperationTool tool = scene.setup.tools[instruments.size()];
    instruments.push_back({{"name", one.name},
                           {"kind", fields_value(fields(tool.shape))["kind"]},
                           {"incision", tool.incision},
                           {"start", pose_json(tool.start)},
                           {"has_jaws", one.grip.has_value()},
                           {"is_lamp", one.lamp.has_value()}});
  }
  for (const OperationMembrane& one : scene.setup.membranes) membranes.push_back(one.name);
  return {{"name", std::filesystem::path(scene.file).stem().string()},
          {"step_s", scene.setup.step_s},
          {"instruments", instruments},
          {"membranes", membranes},
          {"has_vitreous", scene.setup.vitreous.has_value()}};
}

Value operation_status(const LiveOperation& live) {
  const OperationSample& sample = live.operation().sample();
  Value bleedings = Value::List();
  for (const Bleeding& spot : live.operation().bleedings()) bleedings.push_back(spot.radius_mm);
  return {{"time_s", live.time_s()},
          {"instruments", instruments_json(live)},
          {"view", view_json(live.view(), live.time_s())},
          {"membranes", membranes_json(live)},
          {"turn_degrees", sample.turn_degrees},
          {"clinging_mm2", sample.clinging_mm2},
          {"vitreous_left", sample.vitreous_left},
          {"bleedings_mm", bleedings},
          {"score", score_json(live.record().keeper().score())}};
}

Value events_json(const std::vector<OperationEvent>& events) {
  Value all = Value::List();
  for (const OperationEvent& event : events) {
    all.push_back({{"time_s", event.time_s},
                   {"kind", event.kind},
                   {"instrument", event.instrument},
                   {"at", event.at},
                   {"place", event.place_mm},
                   {"value", event.value}});
  }
  return all;
}

}  // namespace supple::tools

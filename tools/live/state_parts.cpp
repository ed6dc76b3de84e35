#include "tools/live/state_parts.h"

#include <algorithm>

#include "tools/scene/json.h"

namespace supple::tools {

namespace {

void rename_key(Json& json, const char* from, const char* to) {
  if (!json.contains(from)) return;
  json[to] = json[from];
  json.erase(from);
}

/// Of a recorded drag what it took hold of.
Json handle_of(const Json& drag) {
  Json keys = Json::object();
  for (const char* key : {"grab", "grab_box", "grab_ball", "radius", "grab_label", "grab_density",
                          "rigid_at", "piece_at"}) {
    if (drag.contains(key)) keys[key] = drag[key];
  }
  if (drag.contains("soft_mm")) keys["soft"] = drag["soft_mm"];
  return keys;
}

Json cut_of(Json cut) {
  if (!cut.contains("curve")) return cut;
  rename_key(cut["curve"], "depth_mm", "depth");
  rename_key(cut["curve"], "above_mm", "above");
  cut["curve"].erase("file");
  return cut;
}

void add_step(const Json& step, StateParts& parts) {
  if (step.value("release", false)) parts.handles.clear();
  for (const Json& drag : step.value("handles", Json::array())) {
    const Json keys = handle_of(drag);
    const bool is_new =
        std::find(parts.handles.begin(), parts.handles.end(), keys) == parts.handles.end();
    if (is_new && !keys.empty()) parts.handles.push_back(keys);
  }
  for (const Json& cut : step.value("cut", Json::array())) parts.cuts.push_back(cut_of(cut));
}

void add_anchors(const State& state, StateParts& parts) {
  for (const IndexBox& box : state.anchors) {
    parts.anchors.push_back(
        {{"grab_box", {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z}}});
  }
  for (const std::int32_t label : state.anchor_labels) {
    parts.anchors.push_back({{"grab_label", label}});
  }
  for (const std::string& selection : state.anchor_selections) {
    parts.anchors.push_back(Json::parse(selection, nullptr, false));
  }
}

}  // namespace

StateParts parts_of(const State& state) {
  StateParts parts;
  add_anchors(state, parts);
  const Json record = Json::parse(state.configuration, nullptr, false);
  if (!record.is_object() || !record.contains("steps")) return parts;
  for (const Json& step : record["steps"]) {
    if (step.is_object()) add_step(step, parts);
  }
  return parts;
}

}  // namespace supple::tools

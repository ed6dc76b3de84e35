#include "tools/scene/live/state_parts.h"

#include <algorithm>

#include "tools/scene/file/cut_keys.h"
#include "tools/scene/file/json.h"
#include "tools/scene/file/live_event.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

void rename_key(Json& json, const char* from, const char* to) {
  if (!json.contains(from)) return;
  json[to] = json[from];
  json.erase(from);
}

void require_numbers(const Json& value) {
  if (!value.is_array()) return void(value.get<double>());
  for (const Json& number : value) number.get<double>();
}

/// Of a recorded drag what it took hold of.
Json handle_of(const Json& drag) {
  Json keys = Json::object();
  for (const char* key : {"grab", "grab_box", "grab_ball", "radius", "grab_label", "grab_density",
                          "rigid_at", "piece_at"}) {
    if (!drag.contains(key)) continue;
    require_numbers(drag[key]);
    keys[key] = drag[key];
  }
  if (drag.contains("soft_mm")) keys["soft"] = drag["soft_mm"];
  return keys;
}

StateParts::Cut cut_of(Json cut) {
  if (cut.contains("curve")) {
    rename_key(cut["curve"], "depth_mm", "depth");
    rename_key(cut["curve"], "above_mm", "above");
    cut["curve"].erase("file");
  } else if (!cut.contains("plane")) {
    return {cut, std::nullopt};
  }
  Table root = Table::parse(toml_document(Json{{"cut", {cut}}}.dump()), "state");
  return {cut, read_cut(root.tables("cut").front(), {})};
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
  const StateParts anchors = parts;
  try {
    for (const Json& step : record["steps"]) add_step(step, parts);
  } catch (const Json::exception&) {
    return anchors;
  } catch (const InputError&) {
    return anchors;
  }
  return parts;
}

}  // namespace supple::tools

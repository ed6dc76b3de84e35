#include "tools/scene/live/state_parts.h"

#include <algorithm>

#include "lib/session/file/cut_keys.h"
#include "tools/scene/file/live_event.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"

namespace supple::tools {

namespace {

void rename_key(Value& keys, const char* from, const char* to) {
  if (!keys.contains(from)) return;
  const Value value = std::as_const(keys)[from];
  keys[to] = value;
  keys.erase(from);
}

void require_numbers(const Value& value) {
  if (!value.is_list()) return void(value.number());
  numbers_of(value);
}

/// Returns the keys of a recorded drag that say what it took hold of.
Value handle_of(const Value& drag) {
  Value keys = Value::Entries();
  for (const char* key : {"grab", "grab_box", "grab_ball", "radius", "grab_label", "grab_density",
                          "rigid_at", "piece_at"}) {
    if (!drag.contains(key)) continue;
    require_numbers(drag[key]);
    keys[key] = drag[key];
  }
  if (drag.contains("soft_mm")) keys["soft"] = drag["soft_mm"];
  return keys;
}

StateParts::Cut cut_of(Value cut) {
  if (cut.contains("curve")) {
    rename_key(cut["curve"], "depth_mm", "depth");
    rename_key(cut["curve"], "above_mm", "above");
    cut["curve"].erase("file");
  } else if (!cut.contains("plane")) {
    return {cut, std::nullopt};
  }
  Table table(cut, "state");
  return {cut, read_cut(table, {})};
}

void add_step(const Value& step, StateParts& parts) {
  if (step["release"] == true) parts.handles.clear();
  for (const Value& drag : step["handles"].items()) {
    const Value keys = handle_of(drag);
    const bool is_new =
        std::find(parts.handles.begin(), parts.handles.end(), keys) == parts.handles.end();
    if (is_new && !keys.empty()) parts.handles.push_back(keys);
  }
  for (const Value& cut : step["cut"].items()) parts.cuts.push_back(cut_of(cut));
}

void add_anchors(const State& state, StateParts& parts) {
  for (const IndexBox& box : state.anchors) {
    parts.anchors.push_back({{"grab_box", box}});
  }
  for (const std::int32_t label : state.anchor_labels) {
    parts.anchors.push_back({{"grab_label", label}});
  }
  parts.anchors.insert(parts.anchors.end(), state.anchor_selections.begin(),
                       state.anchor_selections.end());
}

}  // namespace

StateParts parts_of(const State& state) {
  StateParts parts;
  add_anchors(state, parts);
  const Value record = json_or_null(state.configuration);
  const StateParts anchors = parts;
  try {
    for (const Value& step : record["steps"].items()) add_step(step, parts);
  } catch (const std::invalid_argument&) {
    return anchors;
  } catch (const InputError&) {
    return anchors;
  }
  return parts;
}

}  // namespace supple::tools

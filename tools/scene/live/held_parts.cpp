#include "tools/scene/live/held_parts.h"

#include <algorithm>

#include "volumes/base/value.h"

namespace supple::tools {

namespace {

/// Returns those keys of a handle or a step that say what it takes hold of.
Value selection_keys(const Value& all) {
  std::vector<std::string> names = {"grab", "grab_box", "at_mm",       "points", "grab_label",
                                    "soft", "push",     "spare_fixed", "slide"};
  PlacedSelection selection;
  for (const Field& field : fields(selection)) names.push_back(field.name());
  Value keys = Value::table();
  for (const auto& [name, value] : all.entries()) {
    if (std::find(names.begin(), names.end(), name) != names.end()) keys[name] = value;
  }
  return keys;
}

HeldPart anchor_of(const PlacedSelection& given, const Value& keys) {
  HeldPart part;
  static_cast<PlacedSelection&>(part.held.placed.emplace()) = given;
  part.keys = keys;
  return part;
}

HeldPart anchor_of(const IndexBox& box) {
  PlacedSelection given;
  given.corners = {Vec3d(box.lo), Vec3d(box.hi)};
  return anchor_of(given, {{"grab_box", box}});
}

/// Returns the part as it is held, without what moved it.
HeldPart handle_of(const Drag& moved, const Value& keys) {
  HeldPart part = anchor_of(*moved.placed, selection_keys(keys));
  PlacedHandle still = std::move(*part.held.placed);
  still.by = Vec3d(0);
  part.held = moved;
  part.held.placed = std::move(still);
  return part;
}

void add_parts(const LiveSession::DoneStep& done, HeldParts& parts) {
  const Step& step = done.step;
  const Value& keys = done.keys;
  if (step.release) parts = {};
  for (std::size_t n = 0; n < step.drags.size(); ++n) {
    parts.handles.push_back(
        handle_of(step.drags[n], keys.contains("handles") ? keys["handles"].at(n) : keys));
  }
  const Value& anchors = keys["anchors"];
  std::size_t n = 0;
  for (const ChosenPart& part : step.fix) {
    const bool is_of_points = part.placed && part.placed->points;
    parts.has_others = parts.has_others || part.label != 0 || is_of_points;
    if (!part.placed || is_of_points) continue;
    parts.anchors.push_back(anchor_of(*part.placed, anchors.is_list() ? anchors.at(n++) : anchors));
  }
  for (const ChosenPart& part : step.fix) {
    if (const IndexBox* box = part.box()) parts.anchors.push_back(anchor_of(*box));
  }
}

}  // namespace

HeldParts held_parts(const std::vector<LiveSession::DoneStep>& done) {
  HeldParts parts;
  int last_stroke = -1;
  for (const LiveSession::DoneStep& step : done) {
    const bool is_same_drag = step.kind == EventKind::drag && step.stroke == last_stroke;
    last_stroke = step.stroke;
    if (!is_same_drag) add_parts(step, parts);
  }
  return parts;
}

Step step_that_keeps(const HeldParts& parts, Value& keys) {
  Step step;
  step.release = step.no_relax = true;
  keys = {{"release", true}, {"no_relax", true}};
  for (const HeldPart& part : parts.handles) {
    step.drags.push_back(part.held);
    keys["handles"].push_back(part.keys)["by"] = {0, 0, 0};
  }
  for (const HeldPart& part : parts.anchors) {
    step.fix.emplace_back().placed = part.given();
    keys["anchors"].push_back(part.keys);
  }
  return step;
}

}  // namespace supple::tools

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
  static_cast<PlacedSelection&>(part.given) = given;
  part.keys = keys;
  return part;
}

HeldPart anchor_of(const IndexBox& box) {
  PlacedSelection given;
  given.corners = {Vec3d(box.lo), Vec3d(box.hi)};
  return anchor_of(given, {{"grab_box", box}});
}

/// Returns the part as it is held, without what moved it.
HeldPart handle_of(const PlacedHandle& moved, const Value& keys) {
  HeldPart part;
  static_cast<PlacedSelection&>(part.given) = moved;
  part.given.by = Vec3d(0);
  part.given.soft_mm = moved.soft_mm;
  part.given.push = moved.push;
  part.given.spares_fixed = moved.spares_fixed;
  part.given.slides = moved.slides;
  part.keys = selection_keys(keys);
  return part;
}

void add_parts(const LiveSession::DoneStep& done, HeldParts& parts) {
  const Step& step = done.step;
  const Value& keys = done.keys;
  if (step.release) parts = {};
  for (std::size_t n = 0; n < step.handles.size(); ++n) {
    parts.handles.push_back(
        handle_of(step.handles[n], keys.contains("handles") ? keys["handles"].at(n) : keys));
  }
  const Value& anchors = keys["anchors"];
  for (std::size_t n = 0; n < step.anchors.size(); ++n) {
    parts.anchors.push_back(
        anchor_of(step.anchors[n], anchors.is_list() ? anchors.at(n) : anchors));
  }
  for (const IndexBox& box : step.fix) parts.anchors.push_back(anchor_of(box));
  parts.has_others = parts.has_others || !step.fix_labels.empty() || !step.fix_points.empty();
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
    step.handles.push_back(part.given);
    keys["handles"].push_back(part.keys)["by"] = {0, 0, 0};
  }
  for (const HeldPart& part : parts.anchors) {
    step.anchors.push_back(part.given);
    keys["anchors"].push_back(part.keys);
  }
  return step;
}

}  // namespace supple::tools

#include "tools/scene/live/held_parts.h"

namespace supple::tools {

namespace {

PlacedSelection anchor_of(const IndexBox& box) {
  PlacedSelection given;
  given.corners = {Vec3d(box.lo), Vec3d(box.hi)};
  given.keys = {{"grab_box", box}};
  return given;
}

/// Returns the handle as it is held, without what moved it.
Drag still(Drag handle) {
  PlacedHandle held;
  static_cast<PlacedSelection&>(held) = *handle.placed;
  held.by = Vec3d(0);
  handle.placed = std::move(held);
  return handle;
}

void add_parts(const Step& step, HeldParts& parts) {
  if (step.release) parts = {};
  for (const Drag& handle : step.drags) parts.handles.push_back(still(handle));
  for (const ChosenPart& part : step.fix) {
    const bool is_one = part.placed && !part.placed->points;
    if (is_one) parts.anchors.push_back(*part.placed);
    parts.has_others = parts.has_others || (!is_one && part.box() == nullptr);
  }
  for (const ChosenPart& part : step.fix) {
    if (const IndexBox* box = part.box()) parts.anchors.push_back(anchor_of(*box));
  }
}

}  // namespace

HeldParts held_parts(const std::vector<DoneStep>& done, bool is_state_anchored) {
  HeldParts parts;
  parts.has_others = is_state_anchored;
  int last_stroke = -1;
  for (const DoneStep& step : done) {
    const bool is_same_drag = step.kind == EventKind::drag && step.stroke == last_stroke;
    last_stroke = step.stroke;
    if (!is_same_drag) add_parts(step.step, parts);
  }
  return parts;
}

Step step_that_keeps(const HeldParts& parts) {
  Step step;
  step.release = step.no_relax = true;
  step.keys = {{"release", true}, {"no_relax", true}};
  step.drags = parts.handles;
  for (const Drag& handle : parts.handles) {
    step.keys["handles"].push_back(handle.placed->keys)["by"] = {0, 0, 0};
  }
  for (const PlacedSelection& anchor : parts.anchors) {
    step.fix.emplace_back().placed = anchor;
    step.keys["anchors"].push_back(anchor.keys);
  }
  return step;
}

}  // namespace supple::tools

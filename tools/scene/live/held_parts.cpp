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

/// A step that lets go of everything but these, which stay where they are.
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

}  // namespace

HeldParts held_parts(const std::vector<DoneStep>& done, bool has_others) {
  HeldParts parts;
  parts.has_others = has_others;
  int last_stroke = -1;
  for (const DoneStep& step : done) {
    const bool is_same_drag = step.kind == EventKind::drag && step.stroke == last_stroke;
    last_stroke = step.stroke;
    if (!is_same_drag) add_parts(step.step, parts);
  }
  return parts;
}

Step step_without(const LiveEvent& event, HeldParts parts) {
  const bool is_handle = event.handle > 0;
  const char* const field = is_handle ? "handle" : "anchor";
  const int number = is_handle ? event.handle : event.anchor;
  const std::size_t count = is_handle ? parts.handles.size() : parts.anchors.size();
  if (std::size_t(number) > count) {
    throw InputError({event.place, field, std::to_string(number),
                      "one of " + std::to_string(count) + " that there are, from 1"});
  }
  if (parts.has_others) {
    throw InputError({event.place, field, "fixed labels, points or anchors of a state beside it",
                      "all, which lets go of everything"});
  }
  if (is_handle) {
    parts.handles.erase(parts.handles.begin() + number - 1);
  } else {
    parts.anchors.erase(parts.anchors.begin() + number - 1);
  }
  Step step = step_that_keeps(parts);
  step.place = event.place;
  return step;
}

}  // namespace supple::tools

// Events of a live session as a journal's [[event]] and a page's messages describe them:
// what was grabbed, where it was dragged, what was cut, fixed, relaxed, taken back, and how it is
// looked at. The head of a journal is that of a scene.
#pragma once

#include <string>
#include <vector>

#include "lib/session/step.h"
#include "volumes/base/table.h"
#include "volumes/base/text.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// grab and push name a handle; drag says where it is now, counted from where it was grabbed, in
/// the directions of a scene's `by`; release ends that, the handle stays held unless everything is
/// let go. cut, anchor, relax, material and step are those of a scene. model chooses what moves the
/// body in later drags. undo and redo count events that changed the body, and
/// looks, clips and measures where `looks` asks for it. camera, look and clip
/// replace that part of the view; measure adds one, or takes some away.
enum class EventKind {
  grab,
  push,
  drag,
  release,
  cut,
  anchor,
  relax,
  limits,
  step,
  undo,
  redo,
  model,
  material,
  camera,
  look,
  clip,
  measure
};

struct LiveEvent {
  std::string place;  // "file:line", for errors
  EventKind kind = EventKind::step;
  double at_ms = 0;         // since the session was opened
  int merged = 0;           // earlier events that this one replaced before they had begun
  std::int64_t number = 0;  // of who posts it, in no file
  int page = 0;             // the page that posts it, in no file; 0: none
  Vec3d to{0, 0, 0};
  Vec3d turn{0, 0, 0};  // of drag: axis times degrees, about the middle, in directions as `to`
  double joint_mm = 0;  // of grab and push
  bool all = false, looks = false;
  bool restore = false, no_relax = false;
  int handle = 0, anchor = 0, cut = 0;  // of release: the only one, from 1; 0: none
  int remove = 0;                       // of measure, likewise
  Limits limits = Limits::box;
  bool under_hand = false;                // of model: it moves what is dragged, live
  std::vector<HandDirection> directions;  // of grab: those whose responses are found for that
  /// Its keys are those of a [[step]]; of grab and push its one handle, which does not move.
  Step step;
  Value view;  // of camera, look and clip: the keys of that part of a view; of measure: its own

  /// True if it leaves the body alone.
  bool is_of_view() const { return kind >= EventKind::camera; }
  /// True if it takes the place of the last one of its kind, which nobody has seen.
  bool replaces_its_kind() const {
    return kind == EventKind::drag || (is_of_view() && kind != EventKind::measure);
  }
};
Fields fields(LiveEvent& event);
/// The keys of an event that are not its own fields, as a journal has them.
const Value& keys_of(const LiveEvent& event);
const char* name_of(EventKind kind);
/// Says why the model of the step cannot be under a hand; empty where it can be.
std::string why_not_under_hand(const Step& step);

/// Reads an entry of [[event]]. Throws InputError as Table does.
LiveEvent read_event(Table& table, const LabelNames& names);

}  // namespace supple::tools

#include "tools/scene/file/live_event.h"

#include "lib/session/file/cut_keys.h"
#include "lib/session/file/fem_keys.h"
#include "lib/session/file/handle_keys.h"
#include "lib/session/file/step_keys.h"
#include "lib/session/kept_voxels.h"
#include "lib/session/step_model.h"
#include "tools/scene/file/measure.h"
#include "volumes/base/value.h"

namespace supple::tools {

namespace {

const std::vector<std::string>& kind_names() {
  static const std::vector<std::string> names = {
      "grab", "push", "drag",  "release",  "cut",    "anchor", "relax", "limits", "step",
      "undo", "redo", "model", "material", "camera", "look",   "clip",  "measure"};
  return names;
}

/// The fields that an event of its kind has. Those of a step may have the same names.
Fields own_fields(LiveEvent& event) {
  const EventKind kind = event.kind;
  const bool is_release = kind == EventKind::release;
  const bool is_back = kind == EventKind::undo || kind == EventKind::redo;
  const bool is_measure = kind == EventKind::measure;
  Fields own;
  for (const Field& field : fields(event)) {
    const std::string& name = field.name();
    const bool is_missing =
        ((name == "to" || name == "turn") && kind != EventKind::drag) ||
        (name == "joint" && kind != EventKind::grab) ||
        (name == "all" && !is_release && !is_back && !is_measure) ||
        (name == "remove" && !is_measure) || (name == "looks" && !is_back) ||
        (name == "restore" && !is_release) || (name == "handle" && !is_release) ||
        (name == "anchor" && !is_release) || (name == "cut" && !is_release) ||
        (name == "no_relax" && !is_release) || (name == "limits" && kind != EventKind::limits) ||
        (name == "under_hand" && kind != EventKind::model);
    if (!is_missing) own.push_back(field);
  }
  return own;
}

/// The keys of the table that are not the event's own.
Value other_keys(const Table& table, const Fields& own) {
  Value keys = table.written();
  for (const Field& field : own) keys.erase(field.name());
  return keys;
}

void read_grab(Table& table, const LabelNames& names, LiveEvent& event) {
  Drag& handle = event.step.drags.emplace_back();
  static_cast<PlacedSelection&>(handle.placed.emplace()) = read_anchor(table, names);
  handle.soft_mm = table.get<double>("soft").value_or(0);
  handle.spares_fixed = table.get<bool>("spare_fixed").value_or(false);
  handle.slides = table.get<bool>("slide").value_or(false);
  handle.pushes = event.kind == EventKind::push;
  if (event.joint_mm > 0 && !handle.placed->rigid_at) {
    table.fail("joint", "no rigid piece that is grabbed", "rigid_at = [i, j, k] beside it");
  }
  event.directions = read_directions(table);
}

void read_model_event(Table& table, const LabelNames& names, LiveEvent& event) {
  StepKeys keys;
  const Fields all = fields(event.step, keys);
  table.require(table.get<std::string>("model"), "model", model_names("\""));
  table.read({all.front()});
  read_model(table, names, keys.model, event.step);
  if (event.under_hand) {
    const std::string refused = why_not_under_hand(event.step);
    if (!refused.empty()) table.fail("under_hand", refused, "linear equilibria of voxels");
  }
  if (!event.step.fem || (!event.step.fem->modes && !event.step.fem->motion)) return;
  table.fail("fem", "modes or a motion", "an equilibrium; these are a `step`");
}

/// Checks one that is added, or which of them are taken away.
void read_measure_event(Table& table, const LiveEvent& event) {
  const bool adds = table.has("points");
  if (int(adds) + int(event.all) + int(event.remove > 0) != 1) {
    table.fail("measure", adds ? "points beside what is taken away" : "nothing to measure",
               "points, remove or all");
  }
  if (adds) read_measure(table);
}

/// The view's part that the event replaces; the rest of a view is read where it is drawn.
void read_part_of_view(Table& table, EventKind kind) {
  switch (kind) {
    case EventKind::camera:
      table.require(table.table("camera"), "camera", "a table");
      break;
    case EventKind::look:
      if (!table.has("preset") && !table.has("transfer")) {
        table.fail_missing("preset", "a preset, or transfer, a file");
      }
      break;
    default:
      table.tables("clip");
  }
}

void read_keys(Table& table, const LabelNames& names, LiveEvent& event) {
  switch (event.kind) {
    case EventKind::grab:
    case EventKind::push:
      return read_grab(table, names, event);
    case EventKind::drag:
      table.require(table.get<Vec3d>("to"), "to", "[x, y, z] in mm");
      return;
    case EventKind::anchor:
      event.step.fix.emplace_back().placed = read_anchor(table, names);
      return;
    case EventKind::cut:
      event.step.cuts.push_back(read_cut(table, names));
      return;
    case EventKind::relax:
      event.step.relax = tissue_relaxation();
      table.read(fields(*event.step.relax));
      return;
    case EventKind::step:
      event.step = read_step(table, names);
      return;
    case EventKind::model:
      return read_model_event(table, names, event);
    case EventKind::material: {
      Table material = table.require(table.table("material"), "material", "a table");
      event.step.material = read_material_choice(material, names);
      return;
    }
    case EventKind::camera:
    case EventKind::look:
    case EventKind::clip:
      return read_part_of_view(table, event.kind);
    case EventKind::measure:
      return read_measure_event(table, event);
    default:
      return;
  }
}

/// The keys of a [[step]] for those of the event; grab and push keep theirs with their handle.
void keep_keys(Value keys, LiveEvent& event) {
  switch (event.kind) {
    case EventKind::cut:
      event.step.keys = {{"cut", Value::List{std::move(keys)}}};
      return;
    case EventKind::anchor:
      event.step.keys = {{"anchors", Value::List{std::move(keys)}}};
      return;
    case EventKind::relax:
      event.step.keys = {{"relax", std::move(keys)}};
      return;
    default:
      (event.is_of_view() ? event.view : event.step.keys) = std::move(keys);
  }
}

}  // namespace

std::string why_not_under_hand(const Step& step) {
  if (!step.fem || step.fem->tets) return "the model " + model_of(step).name;
  if (step.fem->halvings > 0) return "smaller elements";
  return why_no_sum(step.fem->params);
}

const Value& keys_of(const LiveEvent& event) {
  const Step& step = event.step;
  switch (event.kind) {
    case EventKind::grab:
    case EventKind::push:
      return step.drags.front().placed->keys;
    case EventKind::cut:
      return step.keys["cut"].front();
    case EventKind::anchor:
      return step.keys["anchors"].front();
    case EventKind::relax:
      return step.keys["relax"];
    default:
      return event.is_of_view() ? event.view : step.keys;
  }
}

const char* name_of(EventKind kind) {
  return kind_names()[std::size_t(kind)].c_str();
}

Fields fields(LiveEvent& event) {
  return {
      Field("kind", event.kind, kind_names(), "What happens").required(),
      Field("at", event.at_ms, "Since the session was opened").unit("ms").at_least(0),
      Field("merged", event.merged, "Earlier events that it replaced before they had begun")
          .at_least(0),
      Field("to", event.to, "Of drag: from where it was grabbed, in directions as a scene's by")
          .unit("mm"),
      Field("turn", event.turn,
            "Of drag, where the grab has rigid_at: axis times angle of the piece's turn about its "
            "middle since it was grabbed, right-handed, in the same directions")
          .unit("degrees"),
      Field("joint", event.joint_mm,
            "Of grab, where it has rigid_at: tissue around the piece is parted before it moves, "
            "where another piece is so near")
          .unit("mm")
          .at_least(0),
      Field("all", event.all,
            "Of release: let go of everything that is held or fixed; of undo and redo: all drags "
            "since one grab, or all of a relaxation; of measure: take all away"),
      Field("looks", event.looks,
            "Of undo and redo: looks, clips and measures count as steps, too; looks or clips that "
            "follow each other within a second are one"),
      Field("restore", event.restore, "Of release: take the drags since the grab back"),
      Field("handle", event.handle,
            "Of release: let go of this one alone, the first being 1; the others stay held")
          .at_least(0),
      Field("anchor", event.anchor, "Of release: likewise of what is fixed").at_least(0),
      Field("cut", event.cut,
            "Of release: take this cut out; the steps after it are made again without it")
          .at_least(0),
      Field("remove", event.remove, "Of measure: take this one away, the first being 1")
          .at_least(0),
      Field("no_relax", event.no_relax, "Of release: even where the material asks for it"),
      Field("limits", event.limits, {"box", "ball", "tighten"}, "Of limits: those of later drags"),
      Field("under_hand", event.under_hand,
            "Of model: finite elements follow the hand, and a stroke is one step of them"),
  };
}

LiveEvent read_event(Table& table, const LabelNames& names) {
  LiveEvent event;
  event.place = table.place();
  event.step.place = event.place;
  table.read({fields(event).front()});
  const Fields own = own_fields(event);
  table.read(own);
  table.know({"kind", "at", "merged"});  // a step finishes its table
  if (event.is_of_view()) table.know({"preset", "transfer"});
  read_keys(table, names, event);
  table.finish();
  event.step.place = event.place;
  keep_keys(other_keys(table, own), event);
  return event;
}

}  // namespace supple::tools

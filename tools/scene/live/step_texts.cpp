#include "tools/scene/live/step_texts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "lib/session/step_model.h"
#include "tools/scene/file/measure.h"
#include "volumes/base/json.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

using Steps = std::vector<DoneStep>;
using Looks = std::vector<DoneLook>;

std::string mm_text(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, mm < 10 ? "%.1f mm" : "%.0f mm", mm);
  return text;
}

std::string degrees_text(double degrees) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f\u00b0", degrees);
  return text;
}

/// Numbers of a list, separated by commas.
std::string list_text(const Value& list) {
  std::string text;
  for (const Value& value : list.items()) text += (text.empty() ? "" : ", ") + json_text(value);
  return text;
}

std::string drag_text(const DoneStep& first, const Vec3d& way, double turned_deg) {
  const bool is_push = first.step.drags.front().pushes;
  const std::size_t handles = first.step.drags.size();
  std::string text = std::string(is_push ? "push " : "drag ") + mm_text(std::sqrt(way.dot(way)));
  if (turned_deg > 0) text += ", turn " + degrees_text(turned_deg);
  if (handles > 1) return text + ", " + std::to_string(handles) + " handles";
  text += " at " + place_text(first.step.drags.front().placed->keys);
  return has_own_model(first.step) ? text + " by " + model_of(first.step).title : text;
}

std::string cut_text(const DoneStep& done) {
  const std::size_t cuts = done.step.cuts.size();
  if (cuts != 1) return std::to_string(cuts) + " cuts";
  const Value& cut = done.step.keys["cut"];
  if (!cut.is_list() || cut.size() != 1) return "cut";
  const auto& [shape, keys] = cut.front().entries().front();
  const Value& points = keys["points"];
  return points.is_list() ? "cut along " + std::to_string(points.size()) + " points"
                          : "cut by a " + shape;
}

std::string release_text(const Step& step) {
  const std::size_t kept = step.drags.size() + step.fix.size();
  return kept == 0 ? "let go of everything" : "let go of one, " + std::to_string(kept) + " stay";
}

int relaxation_passes(const std::vector<const DoneStep*>& stroke) {
  int passes = 0;
  for (const DoneStep* done : stroke) {
    if (done->step.relax) passes += done->step.relax->passes;
  }
  return passes;
}

std::string anchor_text(const Step& step) {
  const bool is_one = step.fix.size() == 1 && step.fix.front().placed;
  return is_one ? "anchor at " + place_text(step.fix.front().placed->keys) : "anchors";
}

/// Names a step of a scene by what it does first.
std::string scene_step_text(const DoneStep& done) {
  const Step& step = done.step;
  if (step.release) return release_text(step);
  if (!step.cuts.empty()) return cut_text(done);
  if (!step.drags.empty()) {
    return drag_text(done, step.drags.front().placed->by.value_or(Vec3d(0)), 0);
  }
  if (!step.remove.empty()) return "parts removed";
  if (!step.retract.empty()) return "wound opened";
  if (has_own_model(step)) return model_of(step).title;
  if (step.turn_pieces) return "turn of rigid pieces";
  if (!step.rigid.empty() || step.rigid.joint_mm > 0) {
    return "rigid pieces";
  }
  if (!step.fix.empty()) return anchor_text(step);
  if (step.material) return "material";
  return step.relax ? "relaxation" : "step";
}

std::string material_text(const DoneStep& done) {
  const Value& material = done.step.keys["material"];
  return material.contains("preset") ? "material " + material["preset"].text()
                                     : std::string("material table");
}

/// Tells a measure by its value at rest, and its name.
std::string measure_text(const Value& keys) {
  Table table(keys, "");
  const Measure measure = read_measure(table);
  const double value = measured_value(measure.points);
  const std::string text =
      std::string("measure ") + (measure.is_angle() ? degrees_text(value) : mm_text(value));
  return measure.name.empty() ? text : text + ", " + measure.name;
}

/// Steps of equal strokes in a row, in the order that is given.
using Stroke = std::vector<const DoneStep*>;
std::vector<Stroke> strokes_of(const Steps& steps, bool from_end) {
  std::vector<Stroke> strokes;
  const auto add = [&](const DoneStep& done) {
    if (strokes.empty() || strokes.back().back()->stroke != done.stroke) strokes.emplace_back();
    strokes.back().push_back(&done);
  };
  if (from_end) {
    std::for_each(steps.rbegin(), steps.rend(), add);
  } else {
    std::for_each(steps.begin(), steps.end(), add);
  }
  return strokes;
}

std::vector<History::Entry> entries_of(const Steps& steps, const Looks& looks, bool from_end) {
  std::vector<std::pair<int, History::Entry>> ordered;
  for (const Stroke& stroke : strokes_of(steps, from_end)) {
    const auto kind = stroke.front()->kind;
    ordered.push_back(
        {stroke.front()->order, {step_text(stroke), name_of(kind), int(stroke.size())}});
  }
  for (const DoneLook& look : looks) {
    ordered.push_back({look.order, {look_text(look), name_of(look.kind), 1}});
  }
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<History::Entry> entries;
  for (auto& [order, entry] : ordered) entries.push_back(std::move(entry));
  return entries;
}

}  // namespace

std::string place_text(const Value& keys) {
  const std::vector<std::pair<const char*, const char*>> words = {
      {"grab", ""},         {"grab_ball", ""},        {"at_mm", "LPS mm "},
      {"grab_box", "box "}, {"grab_label", "label "}, {"grab_density", "densities "},
      {"piece_at", ""},     {"rigid_at", ""}};
  for (const auto& [key, before] : words) {
    if (!keys.contains(key)) continue;
    const Value& value = keys[key];
    return before + (value.is_list()   ? list_text(value)
                     : value.is_text() ? value.text()
                                       : json_text(value));
  }
  return keys.contains("points") ? "points" : "a part of the body";
}

std::string step_text(const Stroke& stroke) {
  const DoneStep& first = *stroke.front();
  switch (first.kind) {
    case EventKind::drag: {
      Vec3d way(0);
      double turned_deg = 0;
      for (const DoneStep* done : stroke) {
        if (done->kind != EventKind::drag) continue;
        way = done->reached;
        turned_deg = done->turned_deg;
      }
      return drag_text(first, way, turned_deg);
    }
    case EventKind::cut:
      return cut_text(first);
    case EventKind::anchor:
      return anchor_text(first.step);
    case EventKind::release:
      return release_text(first.step);
    case EventKind::relax: {
      const int passes = relaxation_passes(stroke);
      return "relaxation, " + std::to_string(passes) + (passes == 1 ? " pass" : " passes");
    }
    case EventKind::material:
      return material_text(first);
    default:
      return scene_step_text(first);
  }
}

std::string look_text(const DoneLook& look) {
  if (look.kind == EventKind::clip) {
    const std::size_t clips = look.after["clip"].size();
    return clips == 0 ? "no clips" : with_count(std::int64_t(clips), "clip");
  }
  if (look.kind == EventKind::measure) {
    const std::size_t before = look.before["measure"].size(), after = look.after["measure"].size();
    return after > before ? measure_text(look.after["measure"][after - 1])
                          : with_count(std::int64_t(before - after), "measure") + " taken away";
  }
  const Value& preset = look.after["preset"];
  return preset.is_text() && preset != "" ? "look " + preset.text() : "look of its own";
}

History history_of(const LiveHistory& history) {
  return {entries_of(history.done, history.looks, false),
          entries_of(history.undone, history.undone_looks, true)};
}

Value to_value(const LiveHand::Led& led) {
  constexpr double kWholeMm = 1e-3, kWholeDegrees = 1e-3;
  const bool is_whole = (led.asked - led.reached).length() < kWholeMm &&
                        std::abs(led.asked_deg - led.reached_deg) < kWholeDegrees;
  Value json = {{"asked", led.asked}, {"reached", led.reached}, {"moved", led.moved}};
  if (led.asked_deg > 0 || led.reached_deg > 0) {
    json["turn"] = {{"asked", led.asked_deg}, {"reached", led.reached_deg}};
  }
  json["stopped_by"] = is_whole ? Value(nullptr) : Value(led.by_cut ? "cut" : "held");
  return json;
}

}  // namespace supple::tools

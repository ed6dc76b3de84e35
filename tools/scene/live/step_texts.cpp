#include "tools/scene/live/step_texts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tools/scene/file/json.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

using Steps = std::vector<LiveSession::DoneStep>;
using Looks = std::vector<LiveSession::DoneLook>;

std::string mm_text(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, mm < 10 ? "%.1f mm" : "%.0f mm", mm);
  return text;
}

/// Numbers of a list, separated by commas.
std::string list_text(const Json& list) {
  std::string text;
  for (const Json& value : list) text += (text.empty() ? "" : ", ") + value.dump();
  return text;
}

const Json& first_handle(const Json& keys) {
  const bool has_list = keys.contains("handles") && !keys["handles"].empty();
  return has_list ? keys["handles"].front() : keys;
}

std::string drag_text(const LiveSession::DoneStep& first, const Vec3d& way) {
  const Json keys = Json::parse(first.keys);
  const bool is_push = first.step.handles.front().push;
  const std::size_t handles = first.step.handles.size();
  std::string text = std::string(is_push ? "push " : "drag ") + mm_text(std::sqrt(way.dot(way)));
  if (handles > 1) return text + ", " + std::to_string(handles) + " handles";
  text += " at " + place_text(first_handle(keys));
  return first.step.springs ? text + " by springs" : text;
}

std::string cut_text(const LiveSession::DoneStep& done) {
  const std::size_t cuts = done.step.cuts.size();
  if (cuts != 1) return std::to_string(cuts) + " cuts";
  const Json cut = Json::parse(done.keys).value("cut", Json::array());
  if (!cut.is_array() || cut.size() != 1) return "cut";
  const Json::const_iterator shape = cut.front().begin();
  const bool has_points = shape->is_object() && shape->contains("points");
  if (!has_points || !(*shape)["points"].is_array()) return "cut by a " + shape.key();
  return "cut along " + std::to_string((*shape)["points"].size()) + " points";
}

std::string release_text(const SceneStep& step) {
  const std::size_t kept = step.handles.size() + step.anchors.size();
  return kept == 0 ? "let go of everything" : "let go of one, " + std::to_string(kept) + " stay";
}

int relaxation_passes(const std::vector<const LiveSession::DoneStep*>& stroke) {
  int passes = 0;
  for (const LiveSession::DoneStep* done : stroke) {
    if (done->step.relax) passes += done->step.relax->passes;
  }
  return passes;
}

std::string anchor_text(const LiveSession::DoneStep& done) {
  const Json keys = Json::parse(done.keys);
  const Json anchors = keys.value("anchors", Json::array());
  if (anchors.is_array() && anchors.size() == 1) return "anchor at " + place_text(anchors.front());
  return anchors.is_object() ? "anchor at " + place_text(anchors) : "anchors";
}

/// Of a step of a scene, by what it does first.
std::string scene_step_text(const LiveSession::DoneStep& done) {
  const SceneStep& step = done.step;
  if (step.release) return release_text(step);
  if (!step.cuts.empty()) return cut_text(done);
  if (!step.handles.empty()) return drag_text(done, step.handles.front().by.value_or(Vec3d(0)));
  if (!step.remove.empty()) return "parts removed";
  if (!step.retract.empty()) return "wound opened";
  if (step.fem) return "finite elements";
  if (step.springs) return "springs";
  if (step.turn_pieces) return "turn of rigid pieces";
  if (!step.rigid.empty() || !step.rigid_seeds.empty() || step.rigid_density || step.joint_mm > 0) {
    return "rigid pieces";
  }
  if (!step.anchors.empty() || !step.fix.empty() || !step.fix_labels.empty()) {
    return anchor_text(done);
  }
  if (step.material) return "material";
  return step.relax ? "relaxation" : "step";
}

std::string material_text(const LiveSession::DoneStep& done) {
  const Json material = Json::parse(done.keys).value("material", Json::object());
  return material.contains("preset") ? "material " + material["preset"].get<std::string>()
                                     : std::string("material table");
}

/// Steps of equal strokes in a row, in the order that is given.
using Stroke = std::vector<const LiveSession::DoneStep*>;
std::vector<Stroke> strokes_of(const Steps& steps, bool from_end) {
  std::vector<Stroke> strokes;
  const auto add = [&](const LiveSession::DoneStep& done) {
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
  for (const LiveSession::DoneLook& look : looks) {
    ordered.push_back({look.order, {look_text(look), name_of(look.kind), 1}});
  }
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<History::Entry> entries;
  for (auto& [order, entry] : ordered) entries.push_back(std::move(entry));
  return entries;
}

}  // namespace

std::string place_text(const Json& keys) {
  const std::vector<std::pair<const char*, const char*>> words = {
      {"grab", ""},         {"grab_ball", ""},        {"at_mm", "LPS mm "},
      {"grab_box", "box "}, {"grab_label", "label "}, {"grab_density", "densities "},
      {"piece_at", ""},     {"rigid_at", ""}};
  for (const auto& [key, before] : words) {
    if (!keys.contains(key)) continue;
    const Json& value = keys[key];
    return before + (value.is_array()    ? list_text(value)
                     : value.is_string() ? value.get<std::string>()
                                         : value.dump());
  }
  return keys.contains("points") ? "points" : "a part of the body";
}

std::string step_text(const Stroke& stroke) {
  const LiveSession::DoneStep& first = *stroke.front();
  switch (first.kind) {
    case EventKind::drag: {
      Vec3d way(0);
      for (const LiveSession::DoneStep* done : stroke) {
        if (done->kind == EventKind::drag) way = done->reached;
      }
      return drag_text(first, way);
    }
    case EventKind::cut:
      return cut_text(first);
    case EventKind::anchor:
      return anchor_text(first);
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

std::string look_text(const LiveSession::DoneLook& look) {
  const Json after = Json::parse(look.after);
  if (look.kind == EventKind::clip) {
    const std::size_t clips = after.value("clip", Json::array()).size();
    return clips == 0 ? "no clips" : with_count(std::int64_t(clips), "clip");
  }
  const std::string preset = after.value("preset", "");
  return preset.empty() ? "look of its own" : "look " + preset;
}

History history_of(const LiveSession& live) {
  return {entries_of(live.done(), live.looks(), false),
          entries_of(live.undone(), live.undone_looks(), true)};
}

}  // namespace supple::tools

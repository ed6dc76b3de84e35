#include <algorithm>

#include "lib/session/handles/handle_motion.h"
#include "lib/session/handles/handles.h"
#include "tools/scene/file/measure.h"
#include "tools/scene/run/reports.h"
#include "tools/viewer/scene_json.h"
#include "volumes/base/json.h"

namespace supple::tools {

namespace {

/// A selection's keys in few words.
std::string words_of(const Value& keys) {
  for (const char* key : {"grab", "grab_box", "grab_ball", "grab_label", "grab_density", "at_mm",
                          "piece_at", "rigid_at", "points"}) {
    if (!keys.contains(key)) continue;
    std::string words = std::string(key) + " " + json_text(keys[key]);
    if (keys.contains("radius")) words += ", " + json_text(keys["radius"]) + " mm";
    return words;
  }
  return "a part of the body";
}

/// Keys of an event from those of a step's entry.
Value event_json(const char* kind, Value keys) {
  for (const char* key : {"by", "by_mm_lps", "push"}) keys.erase(key);
  Value event = {{"kind", kind}};
  event.update(keys);
  return event;
}

Value held_json(const char* kind, const Value& keys) {
  return {{"text", words_of(keys)}, {"event", event_json(kind, keys)}};
}

/// Where what is held was and is.
void add_places(Value& json, const Vec3d& rest_index, const State& state,
                const Displacement& moved) {
  json["voxel"] = rest_index;
  json["lps"] = state.geometry.world_from_index(place_now(rest_index, moved));
  json["rest_lps"] = state.geometry.world_from_index(rest_index);
}

/// The middle of a voxel, box or ball, or the place of a piece; nothing of other selections.
std::optional<Vec3d> middle_of(const PlacedSelection& given, const Geometry& geometry) {
  for (const auto& place : {given.piece_at, given.rigid_at}) {
    if (place) return index_of(*place, given.frame, geometry);
  }
  if (given.at_lps_mm) return geometry.index_from_world(*given.at_lps_mm);
  if (given.ball) return index_of(*given.ball, given.frame, geometry);
  if (!given.corners) return std::nullopt;
  return (index_of((*given.corners)[0], given.frame, geometry) +
          index_of((*given.corners)[1], given.frame, geometry)) /
         2;
}

/// The middle of what the keys of an entry name, as of an event.
std::optional<Vec3d> middle_of(const Value& keys) {
  for (const char* key : {"grab", "grab_ball", "grab_box"}) {
    if (!keys.contains(key) || !keys[key].is_list()) continue;
    const std::vector<double> v = numbers_of(keys[key]);
    if (v.size() == 3) return Vec3d(v[0], v[1], v[2]);
    if (v.size() == 6) return Vec3d(v[0] + v[3], v[1] + v[4], v[2] + v[5]) / 2;
  }
  return std::nullopt;
}

struct PatchSide {
  std::vector<Vec3d> line;  // in the frame of the patch
  Vec3d down{0, 0, 0};      // across the patch, in that frame
};

/// The side of a patch that lies furthest out, where a knife goes in.
PatchSide outermost_side(const CutSurface& cut, const Geometry& geometry) {
  const Vec3d &a = cut.edge1, &b = cut.edge2, &corner = cut.corner;
  const PatchSide sides[] = {{{corner, corner + a}, b},
                             {{corner + b, corner + b + a}, b * -1.},
                             {{corner, corner + b}, a},
                             {{corner + a, corner + a + b}, a * -1.}};
  const Vec3d middle = Vec3d(geometry.dims() - Vec3i(1)) / 2;
  const auto from_middle = [&](const PatchSide& side) {
    const Vec3d place = (side.line[0] + side.line[1]) / 2;
    const Vec3d index = cut.in_voxels ? place : geometry.index_from_world(place);
    return geometry.world_vector_from_index(index - middle).length();
  };
  return *std::max_element(std::begin(sides), std::end(sides), [&](const auto& x, const auto& y) {
    return from_middle(x) < from_middle(y);
  });
}

/// What is swept along a curve or over a patch, to be drawn: the line where the body is now, and
/// how far it goes to either side. Nothing of meshes and labels.
Value sheet_json(const CutSurface& cut, const State& state, const Displacement& moved) {
  if (cut.mesh || cut.label != 0) return nullptr;
  const Geometry& geometry = state.geometry;
  const auto vector_of = [&](const Vec3d& v) {
    return cut.in_voxels ? geometry.world_vector_from_index(v) : v;
  };
  std::vector<Vec3d> line;
  Vec3d down, up(0);
  if (!cut.curve) {
    const PatchSide side = outermost_side(cut, geometry);
    line = side.line;
    down = vector_of(side.down);
  } else {
    line = cut.curve->points;
    const Vec3d along = vector_of(cut.curve->direction);
    down = along * (cut.curve->depth_mm / along.length());
    up = along * (-cut.curve->above_mm / along.length());
  }
  Value places = Value::List();
  for (const Vec3d& point : line) {
    const Vec3d index = cut.in_voxels ? point : geometry.index_from_world(point);
    places.push_back(geometry.world_from_index(place_now(index, moved)));
  }
  return {{"line", places}, {"down", down}, {"up", up}};
}

Value cut_json(const Value& keys, const CutSurface* surface, const State& state,
               const Displacement& moved) {
  return {{"text", keys.empty() ? "cut" : keys.entries().front().key},
          {"event", event_json("cut", keys)},
          {"sheet", surface == nullptr ? Value(nullptr) : sheet_json(*surface, state, moved)}};
}

}  // namespace

Value handles_json(const HeldParts& held, const StateParts& of_state, const State& state,
                   const Displacement& moved) {
  Value handles = Value::List();
  for (const Value& keys : of_state.handles) {
    const auto middle = middle_of(keys);
    if (!middle) continue;
    add_places(handles.push_back(held_json("grab", keys)), *middle, state, moved);
    handles.back()["is_place"] = true;
  }
  for (std::size_t n = 0; n < held.handles.size(); ++n) {
    const auto middle = middle_of(*held.handles[n].placed, state.geometry);
    if (!middle) continue;
    Value& handle = handles.push_back(held_json("grab", held.handles[n].placed->keys));
    add_places(handle, *middle, state, moved);
    if (!held.has_others) handle["number"] = n + 1;
  }
  return handles;
}

Value anchors_json(const HeldParts& held, const StateParts& of_state, const State& state,
                   const Displacement& moved) {
  Value anchors = Value::List();
  for (const Value& keys : of_state.anchors) {
    Value& anchor = anchors.push_back(held_json("anchor", keys));
    const auto middle = middle_of(keys);
    if (middle) add_places(anchor, *middle, state, moved);
  }
  for (std::size_t n = 0; n < held.anchors.size(); ++n) {
    const PlacedSelection& part = held.anchors[n];
    Value& anchor = anchors.push_back(held_json("anchor", part.keys));
    const auto middle = middle_of(part, state.geometry);
    if (middle) add_places(anchor, *middle, state, moved);
    if (!held.has_others) anchor["number"] = n + 1;
  }
  return anchors;
}

Value measures_json(const std::vector<Measure>& measures, const Displacement& moved) {
  Value list = Value::List();
  for (const Measure& measure : measures) {
    const std::vector<Vec3d> now = points_now(measure, moved);
    Value& json = list.push_back({{"name", measure.name},
                                  {"kind", measure.kind()},
                                  {"unit", measure.unit()},
                                  {"at_rest", measured_value(measure.points)},
                                  {"now", measured_value(now)}});
    for (const Vec3d& point : now) json["lps"].push_back(point);
    for (const Vec3d& point : measure.points) json["rest_lps"].push_back(point);
  }
  return list;
}

Value cuts_json(const std::vector<DoneStep>& done, const StateParts& of_state, const State& state,
                const Displacement& moved) {
  Value cuts = Value::List();
  for (const StateParts::Cut& cut : of_state.cuts) {
    cuts.push_back(cut_json(cut.keys, cut.surface ? &*cut.surface : nullptr, state, moved));
  }
  std::size_t number = 0;
  for (const DoneStep& step : done) {
    if (step.step.cuts.empty()) continue;
    const Value& all = step.step.keys["cut"];
    for (std::size_t n = 0; n < all.size(); ++n) {
      const std::vector<CutSurface>& surfaces = step.step.cuts;
      cuts.push_back(cut_json(all[n], n < surfaces.size() ? &surfaces[n] : nullptr, state, moved));
      cuts.back()["number"] = ++number;
    }
  }
  return cuts;
}

}  // namespace supple::tools

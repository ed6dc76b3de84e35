// The message `scene`: all that the page's panels show.
#include <algorithm>

#include "tools/live/held_parts.h"
#include "tools/live/step_texts.h"
#include "tools/outputs/reports.h"
#include "tools/outputs/view_pictures.h"
#include "tools/scene/json.h"
#include "tools/viewer/open_scene.h"
#include "tools/viewer/page_queries.h"
#include "volumes/grid/volume.h"

namespace supple::tools {

namespace {

Json keys_json(const std::vector<OpacityKey>& keys) {
  Json rows = Json::array();
  for (const OpacityKey& key : keys) rows.push_back({key.density, key.opacity});
  return rows;
}

Json clip_json(const ClipChoice& choice) {
  Json json;
  if (choice.voxel_corners) {
    const auto& [a, b] = *choice.voxel_corners;
    json["box"] = {a.x, a.y, a.z, b.x, b.y, b.z};
  } else if (!choice.clip.region.empty()) {
    json["plane"] = {{"point", vector_json(choice.clip.region[0].point_lps_mm)},
                     {"normal", vector_json(choice.clip.region[0].normal_lps)}};
  }
  json["keep"] = choice.clip.keep == ClipKeep::inside ? "inside" : "outside";
  json["space"] = choice.clip.space == ClipSpace::source ? "source" : "deformed";
  return json;
}

Json volume_json(const Scene& scene, const State& state, const ScalarRange& densities) {
  const Geometry& geometry = state.geometry;
  const auto& axes = geometry.axes_mm();
  const Vec3d& origin = geometry.origin_lps_mm();
  Json affine = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) affine.push_back(axes[std::size_t(column)][row]);
    affine.push_back(origin[row]);
  }
  for (const double last : {0., 0., 0., 1.}) affine.push_back(last);
  const Vec3i& dims = geometry.dims();
  return {{"name", state.source_name},
          {"path", scene.volume_path},
          {"dims", {dims.x, dims.y, dims.z}},
          {"spacing", vector_json(geometry.spacing_mm())},
          {"affine", affine},
          {"hu", are_hounsfield_units(state.density.background())},
          {"density", {densities.lo, densities.hi}},
          {"elements", state.elements.active_count()}};
}

Json history_json(const std::vector<History::Entry>& entries) {
  Json list = Json::array();
  for (const History::Entry& entry : entries) {
    list.push_back({{"text", entry.text}, {"kind", entry.kind}, {"steps", entry.steps}});
  }
  return list;
}

/// A selection's keys in few words.
std::string words_of(const Json& keys) {
  for (const char* key : {"grab", "grab_box", "grab_ball", "grab_label", "grab_density", "at_mm",
                          "piece_at", "rigid_at", "points"}) {
    if (!keys.contains(key)) continue;
    std::string words = std::string(key) + " " + keys[key].dump();
    if (keys.contains("radius")) words += ", " + keys["radius"].dump() + " mm";
    return words;
  }
  return "a part of the body";
}

Json drag_json(const LiveSession::LedDrag& led) {
  constexpr double kWholeMm = 1e-3;
  const bool is_whole = (led.asked - led.reached).length() < kWholeMm;
  Json json = {{"asked", vector_json(led.asked)},
               {"reached", vector_json(led.reached)},
               {"moved", led.moved}};
  json["stopped_by"] = is_whole ? Json(nullptr) : Json(led.by_cut ? "cut" : "held");
  return json;
}

/// Keys of an event from those of a step's entry.
Json event_json(const char* kind, Json keys) {
  for (const char* key : {"by", "by_mm_lps", "push"}) keys.erase(key);
  Json event = {{"kind", kind}};
  event.update(keys);
  return event;
}

/// Where a place of the body at rest is now, in LPS mm.
Vec3d place_now(const Vec3d& rest_index, const State& state, const Displacement& moved) {
  Vec3d u(0);
  if (!moved.u.sample(rest_index, u)) u = Vec3d(0);
  return state.geometry.world_from_index(rest_index + u);
}

Json held_json(const char* kind, const Json& keys) {
  return {{"text", words_of(keys)}, {"event", event_json(kind, keys)}};
}

/// Where what is held was and is.
void add_places(Json& json, const Vec3d& rest_index, const State& state,
                const Displacement& moved) {
  json["voxel"] = vector_json(rest_index);
  json["lps"] = vector_json(place_now(rest_index, state, moved));
  json["rest_lps"] = vector_json(state.geometry.world_from_index(rest_index));
}

/// The middle of a voxel, box or ball, or the place of a piece; nothing of other selections.
std::optional<Vec3d> middle_of(const GivenSelection& given, const Geometry& geometry) {
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
std::optional<Vec3d> middle_of(const Json& keys) {
  for (const char* key : {"grab", "grab_ball", "grab_box"}) {
    if (!keys.contains(key) || !keys[key].is_array()) continue;
    const std::vector<double> v = keys[key].get<std::vector<double>>();
    if (v.size() == 3) return Vec3d(v[0], v[1], v[2]);
    if (v.size() == 6) return Vec3d(v[0] + v[3], v[1] + v[4], v[2] + v[5]) / 2;
  }
  return std::nullopt;
}

/// Numbered as a release counts them; those of the state that was opened have no number. Handles
/// without a middle are not listed.
Json handles_json(const HeldParts& held, const StateParts& of_state, const State& state,
                  const Displacement& moved) {
  Json handles = Json::array();
  for (const Json& keys : of_state.handles) {
    const auto middle = middle_of(keys);
    if (middle) add_places(handles.emplace_back(held_json("grab", keys)), *middle, state, moved);
  }
  for (std::size_t n = 0; n < held.handles.size(); ++n) {
    const auto middle = middle_of(held.handles[n].given, state.geometry);
    if (!middle) continue;
    Json& handle = handles.emplace_back(held_json("grab", Json::parse(held.handles[n].keys)));
    add_places(handle, *middle, state, moved);
    handle["number"] = n + 1;
  }
  return handles;
}

Json anchors_json(const HeldParts& held, const StateParts& of_state, const State& state,
                  const Displacement& moved) {
  Json anchors = Json::array();
  for (const Json& keys : of_state.anchors) {
    Json& anchor = anchors.emplace_back(held_json("anchor", keys));
    const auto middle = middle_of(keys);
    if (middle) add_places(anchor, *middle, state, moved);
  }
  for (std::size_t n = 0; n < held.anchors.size(); ++n) {
    const HeldPart& part = held.anchors[n];
    Json& anchor = anchors.emplace_back(held_json("anchor", Json::parse(part.keys)));
    const auto middle = middle_of(part.given, state.geometry);
    if (middle) add_places(anchor, *middle, state, moved);
    anchor["number"] = n + 1;
  }
  return anchors;
}

/// What is swept along a curve or over a patch, to be drawn: the line where the body is now, and
/// how far it goes to either side. Nothing of meshes and labels.
Json sheet_json(const CutSurface& cut, const State& state, const Displacement& moved) {
  if (cut.mesh || cut.label != 0) return nullptr;
  const Geometry& geometry = state.geometry;
  const auto vector_of = [&](const Vec3d& v) {
    return cut.in_voxels ? geometry.world_vector_from_index(v) : v;
  };
  std::vector<Vec3d> line = {cut.corner, cut.corner + cut.edge1};
  Vec3d down = vector_of(cut.edge2), up(0);
  if (cut.curve) {
    line = cut.curve->points;
    const Vec3d along = vector_of(cut.curve->direction);
    down = along * (cut.curve->depth_mm / along.length());
    up = along * (-cut.curve->above_mm / along.length());
  }
  Json places = Json::array();
  for (const Vec3d& point : line) {
    const Vec3d index = cut.in_voxels ? point : geometry.index_from_world(point);
    places.push_back(vector_json(place_now(index, state, moved)));
  }
  return {{"line", places}, {"down", vector_json(down)}, {"up", vector_json(up)}};
}

Json cut_json(const Json& keys, const CutSurface* surface, const State& state,
              const Displacement& moved) {
  return {{"text", keys.begin().key()},
          {"event", event_json("cut", keys)},
          {"sheet", surface == nullptr ? Json(nullptr) : sheet_json(*surface, state, moved)}};
}

Json cuts_json(const std::vector<LiveSession::DoneStep>& done, const StateParts& of_state,
               const State& state, const Displacement& moved) {
  Json cuts = Json::array();
  for (const StateParts::Cut& cut : of_state.cuts) {
    cuts.push_back(cut_json(cut.keys, cut.surface ? &*cut.surface : nullptr, state, moved));
  }
  std::size_t number = 0;
  for (const LiveSession::DoneStep& step : done) {
    if (step.step.cuts.empty()) continue;
    const Json all = Json::parse(step.keys).value("cut", Json::array());
    for (std::size_t n = 0; n < all.size(); ++n) {
      const std::vector<CutSurface>& surfaces = step.step.cuts;
      cuts.push_back(cut_json(all[n], n < surfaces.size() ? &surfaces[n] : nullptr, state, moved));
      cuts.back()["number"] = ++number;
    }
  }
  return cuts;
}

Json memory_json(const Session& session, const LivePicture::Memory& memory) {
  const auto part = [](const char* name, std::size_t bytes, const char* why) {
    return Json{{"part", name}, {"bytes", bytes}, {"why", why}};
  };
  return {part("densities", memory.source, "what pictures sample: elements and two voxels around"),
          part("body", session.body().bytes(), "classes, offsets and cuts of the elements"),
          part("displacement", memory.displacement, "of elements and the air around, for pictures"),
          part("offsets", memory.offsets, "by which samples solve for themselves while dragging"),
          part("undo", session.undo_bytes(), "bricks that steps changed, as they were before")};
}

}  // namespace

Json camera_json(const Camera& camera) {
  Json json = {
      {"projection", camera.projection == Projection::perspective ? "perspective" : "orthographic"},
      {"position", vector_json(camera.position_lps_mm)},
      {"target", vector_json(camera.target_lps_mm)},
      {"up", vector_json(camera.up_lps)}};
  if (camera.projection == Projection::perspective) {
    json["fov"] = camera.vertical_fov_degrees;
  } else {
    json["height"] = camera.height_mm;
  }
  return json;
}

Json transfer_json(const TransferFunction& function) {
  Json colours = Json::array();
  for (const ColourKey& key : function.colour) {
    colours.push_back({key.density, key.rgb[0], key.rgb[1], key.rgb[2]});
  }
  Json json = {{"name", function.name},
               {"blend", function.blend == Blend::maximum ? "maximum" : "composite"},
               {"opacity", keys_json(function.opacity)},
               {"colour", colours}};
  if (!function.gradient_opacity.empty()) {
    json["gradient_opacity"] = keys_json(function.gradient_opacity);
  }
  if (!function.background.empty()) json["background"] = function.background;
  json["unit_distance"] = function.unit_distance_mm;
  json["full_shading_gradient"] = function.full_shading_gradient;
  json["ambient"] = function.ambient;
  json["diffuse"] = function.diffuse;
  json["specular"] = function.specular;
  json["specular_power"] = function.specular_power;
  return json;
}

/// Of the elements and their surroundings.
const ScalarRange& OpenScene::densities() {
  const DensityGrid& density = picture().opened().density;
  if (m_densities) return *m_densities;
  float lo = density.background(), hi = lo;
  for (std::size_t b = 0; b < density.bricks().brick_count(); ++b) {
    const auto [least, most] =
        std::minmax_element(density.values(b), density.values(b) + kBrickVoxels);
    lo = std::min(lo, *least);
    hi = std::max(hi, *most);
  }
  m_densities = {lo, hi};
  return *m_densities;
}

Json OpenScene::slices_json() {
  const SliceSettings& slices = m_settings.slices;
  Json json = supple::tools::slices_json(slices);
  if (slices.overlay == FieldOverlay::none) return json;
  const ScalarRange range = overlay_range();
  json["overlay_range"] = {range.lo, range.hi};
  for (int n = 0; n < 16; ++n) {
    Json& colour = json["overlay_colours"].emplace_back();
    for (const double c : value_colour(colours_of(slices.overlay), n / 15.)) {
      colour.push_back(int(std::lround(255 * c)));
    }
  }
  return json;
}

Json OpenScene::description() {
  if (!m_is_moving) m_body_told = body_description();
  const SceneView& view = picture().view();
  Json clips = Json::array();
  for (const ClipChoice& clip : view.clips) clips.push_back(clip_json(clip));
  Json scene = m_body_told;
  scene["view"] = {{"camera", camera_json(*view.camera.camera)},
                   {"preset", view.transfer ? "" : view.preset},
                   {"transfer", transfer_json(look_of(view))},
                   {"clips", clips}};
  scene["slices"] = slices_json();
  scene["deformed"] = m_settings.deformed;
  return scene;
}

Json OpenScene::body_description() {
  const State& state = picture().opened();
  const Session& session = m_live.session();
  const HeldParts held = held_parts(m_live.done());
  // A release lets go of what the state has held; its cuts stay.
  const std::vector<LiveSession::DoneStep>& done = m_live.done();
  const bool was_released =
      std::any_of(done.begin(), done.end(),
                  [](const LiveSession::DoneStep& step) { return step.step.release; });
  const StateParts of_state = was_released ? StateParts() : *m_state_parts;
  Json scene;
  scene["volume"] = volume_json(m_live.scene(), state, densities());
  if (!m_assumed.empty()) {
    const Vec3i& dims = state.geometry.dims();
    scene["assumed"] = m_assumed + ": " + std::to_string(state.elements.active_count()) + " of " +
                       std::to_string(std::int64_t(dims.x) * dims.y * dims.z) +
                       " voxels are tissue";
  }
  scene["grab"] = nullptr;
  if (const auto& grab = m_live.grabbed()) {
    Json event = {{"kind", name_of(grab->kind)}};
    event.update(Json::parse(grab->keys));
    scene["grab"] = {
        {"event", event}, {"reached", vector_json(m_live.reached())}, {"page", grab->page}};
  }
  if (const auto& led = m_live.led()) scene["drag"] = drag_json(*led);
  const Displacement& moved = picture().displacement();
  scene["handles"] = handles_json(held, of_state, state, moved);
  scene["anchors"] = anchors_json(held, of_state, state, moved);
  scene["cuts"] = cuts_json(m_live.done(), *m_state_parts, state, moved);
  const History history = history_of(m_live);
  scene["undo"] = history_json(history.done);
  scene["redo"] = history_json(history.undone);
  const char* const limits[] = {"box", "ball", "tighten"};
  scene["limits"] = limits[std::size_t(m_live.limits())];
  const char* const models[] = {"ecm", "springs", "fem"};
  scene["model"] = models[std::size_t(m_live.model())];
  scene["relaxing"] = m_live.passes_left();
  scene["settling"] = m_live.has_more();
  scene["relaxes"] = session.material().relaxes;
  scene["material"] = {{"name", m_live.scene().material_path},
                       {"fold_free", session.links().fold_free}};
  if (!session.records().empty()) {
    const EcmReport& report = session.records().back().report;
    scene["moved"] = report.moved;
    scene["fraction"] = report.fraction();
  }
  scene["memory"] = memory_json(session, picture().memory());
  scene["warnings"] = session.messages();
  return scene;
}

}  // namespace supple::tools

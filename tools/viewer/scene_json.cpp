#include "tools/viewer/scene_json.h"

#include <algorithm>
#include <cmath>

#include "lib/session/step_model.h"
#include "tools/scene/live/hand_lead.h"
#include "tools/scene/live/step_texts.h"
#include "tools/scene/run/reports.h"
#include "tools/scene/run/view_pictures.h"
#include "tools/viewer/page_queries.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

namespace {

Value keys_json(const std::vector<OpacityKey>& keys) {
  Value rows = Value::List();
  for (const OpacityKey& key : keys) rows.push_back({key.density, key.opacity});
  return rows;
}

Value clip_json(const ClipChoice& choice) {
  Value json;
  if (choice.voxel_corners) {
    const auto& [a, b] = *choice.voxel_corners;
    json["box"] = {a.x, a.y, a.z, b.x, b.y, b.z};
  } else if (!choice.clip.region.empty()) {
    json["plane"] = {{"point", choice.clip.region[0].point_lps_mm},
                     {"normal", choice.clip.region[0].normal_lps}};
  }
  json["keep"] = choice.clip.keep == ClipKeep::inside ? "inside" : "outside";
  json["space"] = choice.clip.space == ClipSpace::source ? "source" : "deformed";
  return json;
}

Value volume_json(const Scene& scene, const State& state, const ScalarRange& densities) {
  const Geometry& geometry = state.geometry;
  const auto& axes = geometry.axes_mm();
  const Vec3d& origin = geometry.origin_lps_mm();
  Value affine = Value::List();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) affine.push_back(axes[std::size_t(column)][row]);
    affine.push_back(origin[row]);
  }
  for (const double last : {0., 0., 0., 1.}) affine.push_back(last);
  Value straight = Value::Entries();
  for (std::size_t plane = 0; plane < 3; ++plane) {
    const SliceAxes slice = slice_axes(geometry, SlicePlane(plane));
    straight[kViewNames[plane + 1]] = {{"right", slice.right}, {"down", slice.down}};
  }
  const Vec3i& dims = geometry.dims();
  return {{"name", state.source_name},
          {"path", scene.volume_path},
          {"dims", {dims.x, dims.y, dims.z}},
          {"spacing", geometry.spacing_mm()},
          {"affine", affine},
          {"straight", straight},
          {"hu", are_hounsfield_units(state.density.background())},
          {"density", {densities.lo, densities.hi}},
          {"elements", state.elements.active_count()}};
}

Value history_json(const std::vector<History::Entry>& entries) {
  Value list = Value::List();
  for (const History::Entry& entry : entries) {
    list.push_back({{"text", entry.text}, {"kind", entry.kind}, {"steps", entry.steps}});
  }
  return list;
}

Value memory_json(const Session& session, const LivePicture::Memory& memory) {
  const auto part = [](const char* name, std::size_t bytes, const char* why) {
    return Value{{"part", name}, {"bytes", bytes}, {"why", why}};
  };
  return {part("densities", memory.source, "what pictures sample: elements and two voxels around"),
          part("body", session.body().bytes(), "classes, offsets and cuts of the elements"),
          part("displacement", memory.displacement, "of elements and the air around, for pictures"),
          part("offsets", memory.offsets, "by which samples solve for themselves while dragging"),
          part("undo", session.undo_bytes(), "bricks that steps changed, as they were before")};
}

Value camera_json(const Camera& camera) {
  Value json = {
      {"projection", camera.projection == Projection::perspective ? "perspective" : "orthographic"},
      {"position", camera.position_lps_mm},
      {"target", camera.target_lps_mm},
      {"up", camera.up_lps}};
  if (camera.projection == Projection::perspective) {
    json["fov"] = camera.vertical_fov_degrees;
  } else {
    json["height"] = camera.height_mm;
  }
  return json;
}

/// The settings of slices, with the colours of an overlay and the range of its values.
Value shown_slices(const SliceSettings& slices, const ScalarRange& range) {
  Value json = slices_json(slices);
  if (slices.overlay == FieldOverlay::none) return json;
  json["overlay_range"] = {range.lo, range.hi};
  for (int n = 0; n < 16; ++n) {
    Value& colour = json["overlay_colours"].push_back({});
    for (const double c : value_colour(colours_of(slices.overlay), n / 15.)) {
      colour.push_back(int(std::lround(255 * c)));
    }
  }
  return json;
}

}  // namespace

Value transfer_json(const TransferFunction& function) {
  Value colours = Value::List();
  for (const ColourKey& key : function.colour) {
    colours.push_back({key.density, key.rgb[0], key.rgb[1], key.rgb[2]});
  }
  Value json = {{"name", function.name},
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

SceneDescription::SceneDescription(LiveSession& live, LivePicture& picture,
                                   const ViewSettings& settings)
    : m_live(live),
      m_picture(picture),
      m_settings(settings),
      m_state_parts(parts_of(picture.opened())) {}

void SceneDescription::note_opening(const OpenedFile& file, int number) {
  m_assumed = file.assumed;
  m_number = number;
  m_modality = {{"name", file.modality}, {"by", "header"}};
  if (file.modality.empty()) {
    const bool is_ct = are_hounsfield_units(m_picture.opened().density.background());
    m_modality = {{"name", is_ct ? "CT" : "MR"}, {"by", "densities"}};
  }
}

/// Range of the densities of the elements and their surroundings.
const ScalarRange& SceneDescription::densities() {
  const DensityGrid& density = m_picture.opened().density;
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

Value SceneDescription::told(bool is_moving, const ScalarRange& overlay_range) {
  if (!is_moving) m_body_told = body();
  const SceneView& view = m_picture.view();
  Value clips = Value::List();
  for (const ClipChoice& clip : view.clips) clips.push_back(clip_json(clip));
  Value scene = m_body_told;
  scene["view"] = {{"camera", camera_json(*view.camera.camera)},
                   {"preset", view.transfer ? "" : view.preset},
                   {"transfer", transfer_json(look_of(view))},
                   {"clips", clips}};
  if (m_first.is_null()) {
    const char* key = view.transfer ? "transfer" : "preset";
    m_first = {{"window", m_settings.slices.window},
               {"level", m_settings.slices.level},
               {key, scene["view"][key]}};
  }
  scene["first"] = m_first;
  scene["slices"] = shown_slices(m_settings.slices, overlay_range);
  scene["measures"] = measures_json(m_live.history().measures(), m_picture.displacement());
  scene["deformed"] = m_settings.deformed();
  scene["amount"] = m_settings.amount;
  scene["curtain"] = m_settings.curtain;
  return scene;
}

Value SceneDescription::body() {
  const State& state = m_picture.opened();
  const Session& session = m_live.session();
  const HeldParts held = m_live.held();
  // A release lets go of what the state has held; its cuts stay.
  const std::vector<DoneStep>& done = m_live.history().done;
  const bool was_released =
      std::any_of(done.begin(), done.end(), [](const DoneStep& step) { return step.step.release; });
  const StateParts of_state = was_released ? StateParts() : m_state_parts;
  Value scene;
  scene["volume"] = volume_json(m_live.scene(), state, densities());
  scene["volume"]["modality"] = m_modality;
  scene["volume"]["opened"] = m_number;
  if (!m_assumed.empty()) {
    const Vec3i& dims = state.geometry.dims();
    scene["assumed"] = m_assumed + ": " + std::to_string(state.elements.active_count()) + " of " +
                       std::to_string(std::int64_t(dims.x) * dims.y * dims.z) +
                       " voxels are tissue";
  }
  scene["grab"] = nullptr;
  const LiveHand& hand = m_live.hand();
  if (const auto& grab = hand.grab) {
    Value event = {{"kind", name_of(grab->kind)}};
    event.update(keys_of(*grab));
    scene["grab"] = {{"event", event}, {"reached", hand.reached}, {"page", grab->page}};
  }
  if (hand.led) scene["drag"] = to_value(*hand.led);
  const Displacement& moved = m_picture.displacement();
  scene["handles"] = handles_json(held, of_state, state, moved);
  scene["anchors"] = anchors_json(held, of_state, state, moved);
  scene["cuts"] = cuts_json(done, m_state_parts, state, moved);
  const History history = history_of(m_live.history());
  scene["undo"] = history_json(history.done);
  scene["redo"] = history_json(history.undone);
  const char* const limits[] = {"box", "ball", "tighten"};
  scene["limits"] = limits[std::size_t(m_live.limits())];
  scene["model"] = m_live.model().name;
  scene["under_hand"] = m_live.is_under_hand();
  if (m_live.lead() != nullptr) scene["lead"] = to_value(m_live.lead()->state());
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
  scene["memory"] = memory_json(session, m_picture.memory());
  scene["warnings"] = session.messages();
  return scene;
}

}  // namespace supple::tools

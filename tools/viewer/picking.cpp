#include "tools/viewer/picking.h"

#include <algorithm>
#include <cmath>

#include "lib/session/session_body.h"
#include "lib/session/step_model.h"
#include "tools/scene/run/reports.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/value.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

namespace {

/// Size of the picture of one ray: narrow enough to be that ray.
constexpr double kRayDegrees = 1e-4, kRayHeightMm = 1e-4;
/// An element further from what is seen than this, in voxels, is not what was meant.
constexpr double kFurthestVoxels = 4;
/// Bone may lie so far below what is seen of it.
constexpr double kBelowSurfaceVoxels = 1.3;

/// A camera whose picture of one pixel is the ray.
Camera ray_camera(const Camera& camera, const Ray& ray) {
  Camera narrow = camera;
  narrow.position_lps_mm = ray.origin_lps_mm;
  narrow.target_lps_mm = ray.origin_lps_mm + ray.direction_lps * 100.;
  narrow.up_lps = camera_frame(camera).up;
  narrow.vertical_fov_degrees = kRayDegrees;
  narrow.height_mm = kRayHeightMm;
  narrow.window_shift = 0;
  return narrow;
}

/// mm along the grid axes of a vector in LPS.
Vec3d along_grid(const Geometry& geometry, const Vec3d& vector_mm) {
  const Vec3d steps = geometry.index_vector_from_world(vector_mm), mm = geometry.spacing_mm();
  return {steps.x * mm.x, steps.y * mm.y, steps.z * mm.z};
}

/// Depth in mm at which the ray meets what is seen; none where it meets nothing.
std::optional<double> seen_depth(const LivePicture& picture, const Renderer& renderer,
                                 const Camera& camera, const Ray& ray) {
  RenderSettings settings = view_settings(picture.view());
  settings.clips = resolve_clips(picture.view().clips, picture.opened().geometry);
  settings.width = settings.height = 1;
  settings.auxiliary = true;
  const FloatImage seen =
      renderer.render_float(ray_camera(camera, ray), look_of(picture.view()), settings);
  if (!(seen.depth_mm[0] >= 0)) return std::nullopt;
  return seen.depth_mm[0];
}

/// The element at a place at rest, or the nearest one not far from it.
bool element_at(const BrickTopology& elements, const Vec3d& at_rest, Vec3i& element) {
  const Vec3i middle(int(std::lround(at_rest.x)), int(std::lround(at_rest.y)),
                     int(std::lround(at_rest.z)));
  const int reach = int(kFurthestVoxels);
  double nearest = kFurthestVoxels * kFurthestVoxels;
  bool found = false;
  for (int k = -reach; k <= reach; ++k) {
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const Vec3i voxel = middle + Vec3i(i, j, k);
        const Vec3d apart = Vec3d(voxel) - at_rest;
        if (apart.dot(apart) >= nearest || !elements.is_active(voxel)) continue;
        nearest = apart.dot(apart);
        element = voxel;
        found = true;
      }
    }
  }
  return found;
}

/// Label, det F and, where finite elements have settled the body, stress of what is seen at a
/// place; `element`: the one there, or the nearest.
void add_tissue_values(OpenScene& scene, const Vec3d& index, const RestPlaceAt& rest,
                       const Vec3i& element, Value& json) {
  const State& state = scene.picture().opened();
  const std::size_t slot =
      std::size_t(state.elements.find(element)) * kBrickVoxels + std::size_t(brick_offset(element));
  if (!state.labels.empty()) json["label"] = state.labels.at(slot);
  const auto f = rest ? deformation_at(rest, index) : std::nullopt;
  if (!f) return;
  json["det_f"] = determinant(*f);
  const LiveSession& live = scene.live();
  if (!live.model().waits_for_hands || live.hand().grab || live.has_more()) return;
  const Session& session = scene.live().session();
  const MaterialClasses classes(session.material());
  const int of = session.body().classes[slot];
  json["stress_kpa"] = von_mises_kpa(*f, state.geometry, classes.physics(of, of).stiffness_kpa,
                                     classes.poisson_of_class(of));
}

/// The rigid piece of the nearest bone to a place at rest, which may lie just below its surface;
/// null where there is none so near.
Value piece_json(OpenScene& scene, const Vec3d& at_rest) {
  const Session& session = scene.live().session();
  const Body& body = session.body();
  const Vec3i middle(int(std::lround(at_rest.x)), int(std::lround(at_rest.y)),
                     int(std::lround(at_rest.z)));
  double nearest = kBelowSurfaceVoxels * kBelowSurfaceVoxels;
  int number = -1;
  Vec3i voxel(0);
  for (int n = 0; n < 27 && !body.rigid.empty(); ++n) {
    const Vec3i tried = middle + Vec3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    const Vec3d apart = Vec3d(tried) - at_rest;
    Slot slot = 0;
    if (apart.dot(apart) > nearest || !slot_of(body.elements, tried, slot)) continue;
    if (body.rigid.at(slot) < 0) continue;
    nearest = apart.dot(apart);
    number = body.rigid.at(slot);
    voxel = tried;
  }
  if (number < 0) return nullptr;
  const RigidPiece& piece = body.rigid.list[std::size_t(number)];
  Slot held = 0;
  const bool is_fixed =
      piece.elements->first_common(scene.live().session().held_body().fixed_elements(), held);
  Vec3d now = piece.centre_index;
  for (int a = 0; a < 3; ++a) now[a] += double(piece.pose.shift_q[std::size_t(a)]) / kFixedOne;
  return {{"name", piece.name},
          {"voxel", voxel},
          {"fixed", is_fixed},
          {"middle", body.geometry.world_from_index(now)}};
}

/// What is seen at a place of the index frame.
Value place_json(OpenScene& scene, const Vec3d& index, const PickRequest& request) {
  LivePicture& picture = scene.picture();
  const State& state = picture.opened();
  const RestPlaceAt rest = request.at_rest ? nullptr : picture.rest_places(false);
  Vec3d at_rest = index;
  const bool is_known = !rest || rest(index, at_rest);
  Vec3i voxel(0);
  const bool is_element = is_known && element_at(state.elements, at_rest, voxel);
  Value json = {
      {"index", index}, {"lps", state.geometry.world_from_index(index)}, {"element", is_element}};
  if (is_element) json["voxel"] = voxel;
  if (is_element && !request.values) {
    const Value piece = piece_json(scene, at_rest);
    if (!piece.is_null()) json["rigid"] = piece;
  }
  if (is_element && request.values) add_tissue_values(scene, index, rest, voxel, json);
  if (is_known) {
    json["rest_lps"] = state.geometry.world_from_index(at_rest);
    json["displacement"] = state.geometry.world_vector_from_index(index - at_rest);
    json["density"] = sample_trilinear(state.density, within_border(at_rest, state.geometry.dims()),
                                       state.density.background());
  }
  return json;
}

Value pick_in_space(OpenScene& scene, const PickRequest& request) {
  LivePicture& picture = scene.picture();
  const Geometry& geometry = picture.opened().geometry;
  const SceneView& view = picture.view();
  const Camera& camera = *view.camera.camera;
  const Ray ray = camera_ray(camera, view.size[0], view.size[1], request.at[0], request.at[1]);
  const CameraFrame frame = camera_frame(camera);
  double depth = 0;
  Value json;
  if (request.ray_only) {
    depth = (camera.target_lps_mm - ray.origin_lps_mm).dot(frame.forward) /
            ray.direction_lps.dot(frame.forward);
    json = Value::Entries();
  } else {
    const Renderer& renderer = request.at_rest ? scene.curtain().renderer() : picture.renderer();
    const std::optional<double> seen = seen_depth(picture, renderer, camera, ray);
    if (!seen) return nullptr;
    depth = *seen;
    json = place_json(
        scene, geometry.index_from_world(ray.origin_lps_mm + ray.direction_lps * depth), request);
  }
  const double along_view = depth * ray.direction_lps.dot(frame.forward);
  const double pixel_mm = camera.projection == Projection::perspective
                              ? 2 * half_height_at_unit_distance(camera) * along_view / view.size[1]
                              : camera.height_mm / view.size[1];
  json["depth"] = depth;
  json["right"] = along_grid(geometry, frame.right * pixel_mm);
  json["down"] = along_grid(geometry, frame.up * -pixel_mm);
  json["towards"] = along_grid(geometry, frame.forward * -1.);
  json["ray"] = {{"origin", ray.origin_lps_mm}, {"direction", ray.direction_lps}};
  return json;
}

Value pick_in_slice(OpenScene& scene, const PickRequest& request) {
  const State& state = scene.picture().opened();
  const ViewSettings& settings = scene.settings();
  const PixelFrame pixels = pane_pixels(state.geometry, settings.slices, request.view - 1,
                                        settings.sizes[std::size_t(request.view)]);
  const Vec3d place = pixels.first_lps_mm + pixels.right_mm * (request.at[0] - 0.5) +
                      pixels.down_mm * (request.at[1] - 0.5);
  const Vec3d index = state.geometry.index_from_world(place);
  for (int a = 0; a < 3; ++a) {
    if (index[a] < -0.5 || index[a] > state.geometry.dims()[a] - 0.5) return nullptr;
  }
  Vec3d away = pixels.right_mm.cross(pixels.down_mm);
  away = away / away.length();
  Value json = place_json(scene, index, request);
  json["depth"] = 0;
  json["right"] = along_grid(state.geometry, pixels.right_mm);
  json["down"] = along_grid(state.geometry, pixels.down_mm);
  json["towards"] = along_grid(state.geometry, away * -1.);
  json["ray"] = {{"origin", place}, {"direction", away}};
  return json;
}

}  // namespace

PickRequest pick_request(Table& table) {
  PickRequest request;
  const std::string view =
      table.require(table.get<std::string>("view"), "view", "the name of a view");
  const auto named = std::find(kViewNames.begin(), kViewNames.end(), view);
  if (named == kViewNames.end()) table.fail("view", view, "3d, axial, coronal or sagittal");
  request.view = int(named - kViewNames.begin());
  const auto at = table.require(table.get<std::vector<double>>("at"), "at", "[x, y] in pixels");
  if (at.size() != 2) table.fail("at", std::to_string(at.size()) + " numbers", "[x, y] in pixels");
  request.at = {at[0], at[1]};
  request.ray_only = table.get<bool>("ray_only").value_or(false);
  request.values = table.get<bool>("values").value_or(false);
  request.at_rest = table.get<bool>("at_rest").value_or(false);
  table.finish();
  return request;
}

Value pick(OpenScene& scene, const PickRequest& request) {
  if (request.view == 0) return pick_in_space(scene, request);
  if (scene.settings().sizes[std::size_t(request.view)][0] == 0) return nullptr;
  return pick_in_slice(scene, request);
}

}  // namespace supple::tools

#include "tools/scene/run/view_pictures.h"

#include <algorithm>
#include <cmath>

#include "raycast/drawings/lattice.h"
#include "raycast/scene/stereo.h"
#include "tools/scene/run/kept_renderer.h"
#include "tools/scene/run/reports.h"
#include "tools/scene/run/slice_pictures.h"
#include "tools/scene/run/space_marks.h"
#include "tools/scene/run/view_record.h"
#include "tools/scene/run/vtk_picture.h"
#include "volumes/base/error.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/offset_field.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

Camera resolve_camera(const CameraChoice& choice, const Geometry& geometry, double aspect) {
  if (choice.camera) return *choice.camera;
  Camera camera = default_camera(geometry, aspect, choice.view, choice.projection,
                                 choice.fov_degrees.value_or(Camera().vertical_fov_degrees));
  camera.height_mm = choice.height_mm.value_or(camera.height_mm);
  return camera;
}

namespace {

Image draw_body_lattice(const PosedVolume& subject, const SceneView& view) {
  const Displacement displacement =
      on_elements(subject.geometry, subject.elements, subject.displacement);
  const Camera camera = camera_of(subject, view);
  LatticeStyle style;
  style.width = view.size[0];
  style.height = view.size[1];
  style.grey_lo = subject.grey_lo;
  style.grey_hi = subject.grey_hi;
  return draw_lattice(subject.geometry, subject.density, displacement, camera, style);
}

}  // namespace

Camera camera_of(const PosedVolume& subject, const SceneView& view) {
  const double aspect = double(view.size[0]) / view.size[1];
  const bool is_flat = view.lattice && subject.geometry.dims().z == 1;
  const CameraChoice& choice = view.camera;
  const bool is_default =
      !choice.camera && choice.view == "anterior" && !choice.fov_degrees && !choice.height_mm;
  if (is_flat && is_default) {
    const Displacement displacement =
        on_elements(subject.geometry, subject.elements, subject.displacement);
    return lattice_camera(subject.geometry, displacement, aspect);
  }
  return resolve_camera(view.camera, subject.geometry, aspect);
}

TransferFunction look_of(const SceneView& view) {
  return view.transfer ? *view.transfer : preset(view.preset);
}

RenderSettings view_settings(const SceneView& view) {
  RenderSettings settings;
  settings.width = view.size[0];
  settings.height = view.size[1];
  view.sampling.apply_to(settings);
  settings.lighting = view.lighting;
  settings.clip_surfaces = view.clip_meshes;
  settings.auxiliary = !view.picture.aux.empty() || view.marks.grid_mm ||
                       !view.marks.overlay.empty() || picture_kind(view.image) == PictureKind::exr;
  settings.tells_surfaces =
      view.picture.shows("motion") || view.picture.shows("id") || !view.marks.overlay.empty();
  return settings;
}

void rethrow_at(const std::string& place, const InputError& error) {
  const Problem& problem = error.problem();
  if (!problem.file.empty() || place.empty()) throw error;
  throw InputError({place, problem.field, problem.found, problem.expected});
}

void check_inverse(const SceneView& view, const std::vector<OffsetFunction>& functions) {
  if (view.inverse || !view.deformed || functions.empty()) return;
  throw InputError({view.place, "inverse", "sampling paths, which follow offsets",
                    "inverse = true, or a deformed state alone"});
}

void check_ids(const SceneView& view, bool has_labels) {
  if (!view.picture.shows("id") || !view.meshes.empty() || has_labels) return;
  throw InputError({view.place, "aux", "id without labels or meshes",
                    "[labels] in the scene, or meshes in the view"});
}

/// Colours mean the same in all frames of a film.
void check_film_colours(const SceneView& view) {
  const PictureOptions& options = view.picture;
  if (options.film == 0) return;
  const char* const wanted = "mm, the same in all frames";
  const bool colours_offsets = options.shows("offset") || (view.marks.arrows_mm && !view.slice);
  if (colours_offsets && options.offset_max_mm <= 0) {
    throw InputError({view.place, "offset_max", "none beside offsets in a film", wanted});
  }
  const TissueMarks& marks = view.slice ? view.slice->marks : view.marks;
  if (marks.shows_displacement() && !marks.overlay_range) {
    throw InputError({view.place, "overlay_range", "none beside displacements in a film", wanted});
  }
}

void check_view(const SceneView& view) {
  check_film_colours(view);
  try {
    if (!view.preset.empty()) preset(view.preset);
    view_settings(view).validate();
    if (view.transfer || !view.preset.empty()) view_settings(view).validate_with(look_of(view));
    check_picture_options(view.picture, view.image, view.place);
    check_inverse(view, view.path);
    if (view.caster == Caster::vtk) check_vtk_view(view);
    check_decoration(view.decoration, view.slice.has_value());
  } catch (const InputError& error) {
    rethrow_at(view.place, error);
  }
}

SceneView effective_view(const SceneView& view, const Geometry& geometry, double min_density) {
  SceneView effective = view;
  effective.lattice = view.lattice || geometry.dims().z == 1;
  if (view.preset.empty() && !view.transfer)
    effective.preset = are_hounsfield_units(min_density) ? "Bone" : "MR-Default";
  // An EXR is composited elsewhere.
  std::string& background = effective.decoration.background;
  const bool is_final = !effective.lattice && picture_kind(view.image) != PictureKind::exr;
  if (background.empty() && is_final && !view.slice) background = look_of(effective).background;
  return effective;
}

bool reads_displacement(const SceneView& view) {
  const auto deforms = [](const MeshChoice& mesh) { return mesh.deform; };
  return !view.inverse || view.lattice || view.picture.sequence > 0 || !view.path.empty() ||
         view.fit == "body" || view.picture.shows("motion") || view.marks.labels != nullptr ||
         std::any_of(view.meshes.begin(), view.meshes.end(), deforms);
}

namespace {

/// Parts of the volume that one picture or two show in space.
std::vector<ViewVolume> seen_by_eyes(const SceneView& view, const Geometry& geometry) {
  const double aspect = double(view.size[0]) / view.size[1];
  const Camera camera = zoomed(resolve_camera(view.camera, geometry, aspect), view.zoom);
  if (view.picture.stereo == StereoMode::none) return {ViewVolume(camera, aspect, geometry)};
  const StereoCameras eyes = stereo_cameras(camera, view.picture.eye_separation_mm);
  return {ViewVolume(eyes.left, aspect, geometry), ViewVolume(eyes.right, aspect, geometry)};
}

}  // namespace

std::optional<std::vector<ViewVolume>> seen_of(const SceneView& view, const Geometry& geometry) {
  const bool is_single = view.path.empty() && !view.picture.is_series() && view.picture.aux.empty();
  if (!is_single || view.lattice || geometry.dims().z == 1) return {};
  const TissueMarks& marks = view.slice ? view.slice->marks : view.marks;
  // A range that is not given comes from the longest offset of all.
  if (marks.shows_displacement() && !marks.overlay_range) return {};
  const bool is_plain = view.fit.empty() && !view.half_offsets && view.caster == Caster::supple &&
                        view.meshes.empty() && !view.lighting.has_paths();
  // Lines in space come from beside the picture.
  const bool has_lines = marks.arrows_mm || marks.grid_mm || view.outline;
  if (!view.slice && (!is_plain || has_lines)) return {};
  try {
    return view.slice ? seen_of(*view.slice, geometry) : seen_by_eyes(view, geometry);
  } catch (const InputError&) {
    return {};  // whoever draws it is told, with the place of the view
  }
}

std::unique_ptr<Renderer> make_renderer(const PosedVolume& subject, const SceneView& view) {
  auto renderer = std::make_unique<Renderer>(subject.geometry, subject.density, subject.air_rings,
                                             view.sampling.interpolation);
  pose(*renderer, subject, view);
  return renderer;
}

void pose(Renderer& renderer, const PosedVolume& subject, const SceneView& view) {
  if (subject.offsets == nullptr && subject.displacement != nullptr) {
    renderer.set_pointwise_offsets(
        std::make_shared<const ForwardOffsets>(*subject.displacement, &subject.elements));
  } else {
    renderer.set_offsets(subject.offsets,
                         view.half_offsets ? OffsetResolution::half : OffsetResolution::full);
  }
  if (has_surfaces(view)) pose_surfaces(renderer, subject, view);
}

bool has_surfaces(const SceneView& view) {
  return !view.meshes.empty() || view.marks.has_surfaces();
}

void pose_surfaces(Renderer& renderer, const PosedVolume& subject, const SceneView& view) {
  renderer.set_surfaces(surfaces_of(subject, view));
}

namespace {

/// Looks count opacity per mm: where voxels are much smaller, all of them are nearly clear.
void warn_of_clear_voxels(const PosedVolume& subject, const TransferFunction& look,
                          Progress& progress) {
  if (look.blend != Blend::composite) return;
  const double lo = subject.grey_lo, hi = subject.grey_hi;
  double opacity = std::max(look.opacity_at(lo), look.opacity_at(hi));
  for (const OpacityKey& key : look.opacity) {
    if (key.density >= lo && key.density <= hi) opacity = std::max(opacity, key.opacity);
  }
  constexpr double kFaint = 0.1;  // meant to be: a veil
  constexpr double kHalf = 0.5;   // of full opacity any part is full
  constexpr double kClear = 0.02;
  const Vec3d spacing = subject.geometry.spacing_mm();
  const double voxel_mm = std::min({spacing.x, spacing.y, spacing.z});
  const double reached = std::min(opacity, kHalf);
  const double of_voxel = 1 - std::pow(1 - reached, voxel_mm / look.unit_distance_mm);
  if (opacity < kFaint || of_voxel >= kClear) return;
  const std::string name = look.name.empty() ? "this look" : "preset " + look.name;
  progress.warn(name + " is clear at voxels of " + number_text(voxel_mm) + " mm: an opacity of " +
                number_text(100 * reached) + " % is " + number_text(100 * of_voxel) +
                " % of a voxel, as its unit_distance is " + number_text(look.unit_distance_mm) +
                " mm; a file of it with " + number_text(look.unit_distance_mm * voxel_mm) +
                " shows more");
}

}  // namespace

FloatImage draw(const PosedVolume& subject, const Renderer* renderer, const SceneView& view,
                RenderReport* report, Progress& progress) {
  return draw_following(subject, renderer, view, nullptr, report, progress);
}

FloatImage draw_following(const PosedVolume& subject, const Renderer* renderer,
                          const SceneView& view, FollowedPictures* followed, RenderReport* report,
                          Progress& progress) {
  if (view.slice) {
    return draw_slices(
        {subject.geometry, subject.density, subject.outlined, subject.offsets, subject.elements},
        *view.slice, view.decoration);
  }
  if (view.lattice && !view.clips.empty()) {
    throw InputError({view.place, "clip", "a lattice to draw", "a volume of several slices"});
  }
  if (view.lattice && !view.meshes.empty()) {
    throw InputError({view.place, "mesh", "a lattice to draw", "a volume of several slices"});
  }
  if (view.lattice && (!view.marks.empty() || view.outline)) {
    throw InputError({view.place, "labels, grid, arrows, overlay or outline", "a lattice to draw",
                      "a volume of several slices"});
  }
  if (view.lattice) return to_float(draw_body_lattice(subject, view));
  warn_of_clear_voxels(subject, look_of(view), progress);
  if (view.caster == Caster::vtk) return draw_by_vtk(subject, view, progress);
  RenderSettings settings = view_settings(view);
  settings.clips = resolve_clips(view.clips, subject.geometry);
  const Camera camera = camera_of(subject, view);
  if (followed == nullptr) {
    return renderer->render_float(camera, look_of(view), settings, report, &progress);
  }
  return followed->render(*renderer, camera, look_of(view), settings,
                          describe_view(view, Value::Entries()), report, &progress);
}

}  // namespace supple::tools

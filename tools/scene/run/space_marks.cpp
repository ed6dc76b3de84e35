#include "tools/scene/run/space_marks.h"

#include <algorithm>
#include <cmath>

#include "raycast/drawings/arrows.h"
#include "raycast/drawings/label_surfaces.h"
#include "raycast/drawings/slice.h"
#include "raycast/drawings/surface_grid.h"
#include "raycast/march/surface_scene.h"
#include "tools/scene/run/overlay_paint.h"
#include "volumes/base/error.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/points/material_points.h"
#include "volumes/io/bytes/value_type.h"

namespace supple::tools {

namespace {

/// One layer of a label's surface: a closed body is seen through two.
constexpr double kLabelOpacity = 0.6;
/// Tolerance of depths, relative to the distance to the camera: depths are floats.
constexpr double kSameDepth = 1e-5;

/// The lighter part of the offsets' colours: arrows are thin, and the ground may be dark.
Rgb arrow_colour(double share) {
  return offset_colour(0.7 * share);
}

/// A warp file says where tissue came from, not where a point of it goes.
void require_displacement(const PosedVolume& subject, const std::string& place, const char* field) {
  if (subject.offsets == nullptr || subject.displacement != nullptr) return;
  throw InputError({place, field, "offsets of a warp file",
                    "a state or the steps of a scene, which know where tissue goes"});
}

/// The arrow of the tissue that is now at a place, or that was there at rest where only the
/// displacement is known.
ArrowAt arrow_of(const PosedVolume& subject, const std::vector<IndexClip>& clips) {
  return [&subject, &clips](const Vec3d& index, Arrow& arrow) {
    Vec3d from = index, to = index;
    if (subject.offsets != nullptr) {
      Vec3d offset;
      if (!subject.offsets->sample(index, offset)) return false;
      from += offset;
    } else {
      Vec3d u;
      if (!subject.displacement->u.sample(index, u)) return false;
      to += u;
    }
    if (!touches(subject.elements, from)) return false;
    const bool is_kept = std::all_of(clips.begin(), clips.end(), [&](const IndexClip& clip) {
      return clip.keeps(clip.space() == ClipSpace::source ? from : to);
    });
    if (!is_kept) return false;
    arrow = {subject.geometry.world_from_index(from), subject.geometry.world_from_index(to)};
    return true;
  };
}

void add_arrows(const PosedVolume& subject, const SceneView& view, std::vector<Surface>& surfaces) {
  if (!view.marks.arrows_mm) return;
  if (subject.offsets == nullptr && subject.displacement == nullptr) return;  // at rest
  std::vector<IndexClip> clips;
  for (const Clip& clip : resolve_clips(view.clips, subject.geometry)) {
    clips.emplace_back(clip, subject.geometry);
  }
  const double apart = *view.marks.arrows_mm;
  const std::vector<Arrow> arrows =
      arrows_on_lattice(subject.geometry, apart, arrow_of(subject, clips));
  for (Surface& surface : arrow_surfaces(arrows, apart, view.picture.offset_max_mm, arrow_colour)) {
    surfaces.push_back(std::move(surface));
  }
}

void add_labels(const PosedVolume& subject, const SceneView& view, std::vector<Surface>& surfaces) {
  if (view.marks.labels == nullptr) return;
  require_displacement(subject, view.place, "labels");
  const StoredLabels& labels = *view.marks.labels;
  const ScaleValues to_number = scale_values_of(labels.type());
  const auto label_at = [&](const Vec3i& voxel) {
    char stored[8] = {};
    labels.nearest(labels.geometry().world_from_index(Vec3d(voxel)), stored);
    double label = 0;
    to_number(stored, 1, 1, 0, &label);
    return std::int64_t(label);
  };
  for (LabelSurface& label : label_surfaces(labels.geometry(), label_at)) {
    Surface surface{std::move(label.mesh), {}, kLabelOpacity};
    const auto colour = label_colour(label.label);
    for (std::size_t c = 0; c < 3; ++c) surface.rgb[c] = colour[c] / 255.0;
    if (subject.displacement != nullptr) {
      std::vector<Vec3d>& vertices = surface.mesh.vertices_lps_mm;
      vertices = moved_along(*subject.displacement, vertices);
    }
    surfaces.push_back(std::move(surface));
  }
}

/// Tells at which pixels a surface is seen.
class SeenSurfaces {
 public:
  SeenSurfaces(const std::vector<Surface>& surfaces, const FloatImage& picture,
               const Camera& camera)
      : m_scene(surfaces),
        m_picture(picture),
        m_rays(camera, picture.width, picture.height),
        m_forward(camera_frame(camera).forward) {}

  bool are_seen(int x, int y) const {
    const float depth =
        m_picture.depth_mm[std::size_t(y) * std::size_t(m_picture.width) + std::size_t(x)];
    if (std::isnan(depth)) return false;
    const Ray ray = m_rays.at(x + 0.5, y + 0.5);
    const double t = depth / ray.direction_lps.dot(m_forward);
    std::vector<TriangleHit> hits;
    m_scene.crossings(ray, {t * (1 - kSameDepth), t * (1 + kSameDepth)}, hits);
    return !hits.empty();
  }

 private:
  SurfaceScene m_scene;
  const FloatImage& m_picture;
  CameraRays m_rays;
  Vec3d m_forward;
};

}  // namespace

RestPlaceAt rest_place_of(const PosedVolume& subject) {
  if (subject.offsets != nullptr) return rest_place_of(*subject.offsets);
  if (subject.displacement == nullptr) {
    return [](const Vec3d& index, Vec3d& at_rest) {
      at_rest = index;
      return true;
    };
  }
  const auto forward =
      std::make_shared<const ForwardOffsets>(*subject.displacement, &subject.elements);
  return [forward](const Vec3d& index, Vec3d& at_rest) {
    const std::int32_t brick = forward->bricks().find(floor_voxel(index));
    PointwiseOffsets::Sample found;
    at_rest = index;  // where nothing moves
    if (brick < 0) return true;
    if (!forward->sample(std::size_t(brick), index, found)) return false;
    at_rest = index + found.offset;
    return true;
  };
}

void add_mesh_bodies(const std::vector<DeformableMesh>& meshes, const Geometry& geometry,
                     SceneView& view) {
  if (view.slice || view.lattice || geometry.dims().z == 1) return;
  for (const DeformableMesh& mesh : meshes) {
    const MeshSetup& setup = mesh.setup();
    LineNetwork shape = mesh.shape();
    if (shape.mesh.triangles.empty() || setup.opacity == 0) continue;
    view.meshes.push_back({setup.place, setup.path,
                           std::make_shared<const TriangleMesh>(std::move(shape.mesh)), setup.rgb,
                           setup.opacity, false});
  }
}

std::vector<Surface> surfaces_of(const PosedVolume& subject, const SceneView& view) {
  for (const MeshChoice& mesh : view.meshes) {
    if (mesh.deform) require_displacement(subject, mesh.place, "deform");
  }
  std::vector<Surface> surfaces = surfaces_of(view.meshes, subject.displacement);
  add_arrows(subject, view, surfaces);
  add_labels(subject, view, surfaces);
  return surfaces;
}

void draw_grid(FloatImage& picture, const PosedVolume& subject, const SceneView& view,
               const Camera& camera) {
  if (!view.marks.grid_mm) return;
  SurfaceGrid grid;
  grid.apart_mm = *view.marks.grid_mm;
  grid.width = std::max(1.0, std::min(picture.width, picture.height) / 600.0);
  ShowsTissue shows_tissue;
  std::shared_ptr<const SeenSurfaces> meshes;
  const std::vector<Surface> surfaces = surfaces_of(subject, view);
  if (!surfaces.empty()) {
    meshes = std::make_shared<const SeenSurfaces>(surfaces, picture, camera);
    shows_tissue = [meshes](int x, int y) { return !meshes->are_seen(x, y); };
  }
  draw_surface_grid(picture, camera, subject.geometry, grid, rest_place_of(subject), shows_tissue);
}

void add_arrow_legend(Annotations& annotations, const SceneView& view, int count) {
  const double longest = view.picture.offset_max_mm;
  const auto colour = [&](double length) { return arrow_colour(length / longest); };
  annotations.legend({0, longest}, colour, "moved (mm)", 1, count);
}

}  // namespace supple::tools

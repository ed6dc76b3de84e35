// A picture as a scene's [[view]] or the options of `supple render` ask for it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "raycast/render.h"
#include "raycast/scene/camera.h"
#include "raycast/scene/clip.h"
#include "raycast/scene/transfer_function.h"
#include "tools/scene/file/offset_functions.h"
#include "tools/scene/file/slice_view.h"
#include "tools/scene/file/tissue_marks.h"
#include "tools/scene/file/view_light.h"
#include "tools/scene/pictures/decoration.h"
#include "tools/scene/pictures/picture_options.h"
#include "volumes/base/table.h"
#include "volumes/geometry/keyframes.h"

namespace supple::tools {

// Cameras of a [[view]]: where a picture is taken from, and the keys of one that moves.

/// Camera as given: a named view, which frames the volume, or a full camera.
struct CameraChoice {
  std::string view = "anterior";
  Projection projection = Projection::perspective;
  std::optional<double> fov_degrees, height_mm;  // of a named view, in place of its own
  std::optional<Camera> camera;
};

/// A key of `camera_path`; absent values are interpolated from the other keys.
struct CameraKey {
  std::string place;
  double time = 0;
  Easing easing = Easing::smooth;
  std::string view;  // empty: no side
  std::optional<Vec3d> position, target, up;
  std::optional<double> fov, height, turn_deg, zoom;
  std::optional<CameraChoice> choice;  // where there is a side or a position
};
Fields fields(CameraKey& key);

/// The key `view` of a camera and the option of that name: a side, "front" for anterior and so on.
Field side_field(std::string& side);

/// The key `camera` of a view: a table, or the path of a file with its keys.
CameraChoice read_camera_choice(Table& view);
/// The key `camera_path` of a view whose camera is `start`. Throws InputError as Table does.
std::vector<CameraKey> read_camera_keys(Table& view, const CameraChoice& start);

/// The file of a camera that a view's key `camera` names: the keys of that table.
std::string to_toml(const Camera& camera);

/// A clip as given: a box in voxels needs the volume's geometry.
struct ClipChoice {
  Clip clip;  // its region is empty for a box in voxels
  std::optional<std::pair<Vec3d, Vec3d>> voxel_corners;
};

/// Sampling of rays as given; by default as RenderSettings says.
struct Sampling {
  Quality quality = Quality::standard;
  std::optional<double> step_voxels;                    // instead of the quality's
  Interpolation interpolation = Interpolation::linear;  // a renderer's, not of its settings
  Classification classification = RenderSettings().classification;
  bool jitter = RenderSettings().jitter;

  void apply_to(RenderSettings& settings) const;
};

/// The program that casts the rays of a picture.
enum class Caster { supple, vtk };

struct SceneView {
  std::string place;
  std::string image;
  std::string preset;                        // a name; empty: chosen by the densities
  std::optional<TransferFunction> transfer;  // of a file, instead of a preset
  std::vector<ClipChoice> clips;
  std::vector<OffsetFunction> path;  // that the body is seen along
  Lighting lighting;
  std::vector<MeshChoice> meshes;
  bool clip_meshes = false;
  CameraChoice camera;
  std::vector<CameraKey> camera_keys;  // of a film, times ascend
  std::string fit;                     // box, body or visible; empty: a named view frames the box
  double zoom = 1;
  Decoration decoration;
  TissueMarks marks;
  bool outline = false;  // of the body at rest
  PixelSize size{RenderSettings().width, RenderSettings().height};
  Sampling sampling;
  Caster caster = Caster::supple;
  bool deformed = true;
  bool inverse = true;        // false: each sample solves for itself where it reads the source
  bool half_offsets = false;  // every second one along each axis
  bool lattice = false;
  PictureOptions picture;
  std::optional<SliceChoice> slice;  // slices instead of a picture in space
  std::optional<int> after_step;     // 0: before the first; absent: after the last
};

/// Keys of a table `clip`, but for its region: a plane or a box.
Fields fields(Clip& clip);
/// Keys of a [[view]], but for its tables: camera, clip, light, mesh, path, slice.
Fields fields(SceneView& view);

/// A table [[view]] of a scene with that many steps. Throws InputError as Table does.
SceneView read_view(Table& table, int steps);

/// The clips of a view of the volume.
std::vector<Clip> resolve_clips(const std::vector<ClipChoice>& choices, const Geometry& geometry);

}  // namespace supple::tools

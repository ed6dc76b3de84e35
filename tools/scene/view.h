// A picture as a scene's [[view]] or the options of `supple render` ask for it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/material/toml_table.h"
#include "raycast/render.h"
#include "raycast/scene/camera.h"
#include "raycast/scene/clip.h"
#include "raycast/scene/transfer_function.h"
#include "tools/pictures/picture_options.h"
#include "tools/scene/offset_functions.h"
#include "tools/scene/slice_view.h"
#include "tools/scene/view_light.h"

namespace supple::tools {

/// Camera as given: a named view, or a full camera.
struct CameraChoice {
  std::string view = "anterior";
  Projection projection = Projection::perspective;
  std::optional<Camera> camera;
};

/// A clip as given: a box in voxels needs the volume's geometry.
struct ClipChoice {
  Clip clip;  // its region is empty for a box in voxels
  std::optional<std::pair<Vec3d, Vec3d>> voxel_corners;
};

/// How rays are sampled, as given.
struct Sampling {
  std::string quality = "default";
  std::optional<double> step_voxels;  // instead of the quality's
  std::string classification = "post";
  bool jitter = false;

  /// Throws InputError as parse_quality, or for another classification.
  void apply_to(RenderSettings& settings) const;
};

struct SceneView {
  std::string place;
  std::string image;
  std::string preset;                        // a name; empty: chosen by the densities
  std::optional<TransferFunction> transfer;  // of a file, instead of a preset
  std::vector<ClipChoice> clips;
  std::vector<OffsetFunction> offset;  // that the body is seen along
  Lighting lighting;
  std::vector<MeshChoice> meshes;
  bool clip_meshes = false;
  CameraChoice camera;
  int width = 1024, height = 1024;
  Sampling sampling;
  bool deformed = true;
  bool inverse = true;        // false: each sample solves for itself where it reads the source
  bool half_offsets = false;  // every second one along each axis
  bool lattice = false;
  PictureOptions picture;
  std::optional<SliceChoice> slice;  // slices instead of a picture in space
  std::optional<int> after_step;     // 0: before the first; absent: after the last
};

/// A preset's name or the path of a transfer function (.toml), read at once.
void choose_transfer(SceneView& view, const std::string& preset_or_path);

/// "X,Y,Z:NX,NY,NZ", a point and a normal in LPS mm that points to what is kept.
ClipChoice parse_clip_plane(const std::string& option, const std::string& text);

/// "I,J,K:I,J,K", from the middle of one voxel to that of another.
ClipChoice parse_clip_box(const std::string& option, const std::string& text);

/// A table [[view]] of a scene with that many steps. Throws InputError as TomlTable does.
SceneView read_view(TomlTable& table, int steps);

/// A camera file: projection, view, or position/target/up with fov or height.
CameraChoice read_camera(const std::string& path);

/// The file that read_camera() reads as this camera, exactly.
std::string to_toml(const Camera& camera);

/// The clips of a view of the volume.
std::vector<Clip> resolve_clips(const std::vector<ClipChoice>& choices, const Geometry& geometry);

}  // namespace supple::tools

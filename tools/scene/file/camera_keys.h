// Cameras of a [[view]]: where a picture is taken from, and the keys of one that moves.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "raycast/scene/camera.h"
#include "volumes/base/table.h"
#include "volumes/geometry/keyframes.h"

namespace supple::tools {

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

}  // namespace supple::tools

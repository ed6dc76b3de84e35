// Files that a page asks for, within the folders that it may use.
#pragma once

#include "tools/viewer/folders.h"
#include "tools/viewer/open_scene.h"
#include "volumes/base/value.h"
#include "volumes/field/dense/warp.h"

namespace supple::tools {

struct SaveRequest {
  std::string what, path;  // the path within the folders
  bool force = false;
  int view = 0;
  PixelSize size{1024, 1024};
  WarpDirection direction = WarpDirection::resample;
  int frames = 72;
  double frames_per_second = 25, speed = 1;
};
/// Fields but for `path` and `view`.
Fields fields(SaveRequest& request);
/// Throws InputError, also for a path outside and a name of the wrong kind.
SaveRequest save_request(Table& table, const Folders& folders);

/// Writes it; the answer to `save`. Throws as its writers do, Cancelled.
Value save(OpenScene& scene, const SaveRequest& request);

}  // namespace supple::tools

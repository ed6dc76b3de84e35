// The place under the pointer, and the way there that one pixel of the pointer's way stands for.
#pragma once

#include "tools/viewer/open_scene.h"
#include "volumes/base/value.h"

namespace supple::tools {

struct PickRequest {
  int view = 0;
  std::array<double, 2> at{};
  bool ray_only = false;
  bool values = false;   // label, det F and stress, too
  bool at_rest = false;  // of the body at rest, which a curtain shows
};
/// Throws InputError.
PickRequest pick_request(Table& table);

/// The answer to `pick`; null where nothing is hit.
Value pick(OpenScene& scene, const PickRequest& request);

}  // namespace supple::tools

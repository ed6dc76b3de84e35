// The presets of transfer_function.h. Those that begin with CT- or MR- are named as 3D Slicer's
// volume rendering presets and look like them: their key points are those of its
// Modules/Loadable/VolumeRendering/Resources/presets.xml, rounded, whose opacities are per
// millimetre as well. MR-Default alone has a table of our own, with grey brain.
#pragma once

#include "raycast/scene/transfer_function.h"

namespace supple {

struct NamedPreset {
  const char* name;
  TransferFunction (*make)();
};

const std::vector<NamedPreset>& ct_presets();
const std::vector<NamedPreset>& mr_presets();
const std::vector<NamedPreset>& own_presets();

}  // namespace supple

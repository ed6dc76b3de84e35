// The presets of transfer_function.h. Names and intent follow 3D Slicer's volume rendering presets
// (Modules/Loadable/VolumeRendering/Resources/presets.xml); the tables are our own, with opacities
// per millimetre. Colours change little across the densities of a surface: where they do, samples
// at fixed steps meet the ramp at varying depths and draw rings.
#pragma once

#include "raycast/scene/transfer_function.h"

namespace supple {

struct NamedPreset {
  const char* name;
  TransferFunction (*make)();
};

/// In the order of their names.
const std::vector<NamedPreset>& ct_presets();
const std::vector<NamedPreset>& mr_presets();

}  // namespace supple

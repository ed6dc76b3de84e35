// The presets of transfer_function.h. Those that begin with CT- or MR- are named as 3D Slicer's
// volume rendering presets and look like them: their key points are those of its
// Modules/Loadable/VolumeRendering/Resources/presets.xml, rounded, whose opacities are per
// millimetre as well. Four have tables of our own: CT-Air and CT-X-ray; MR-Default, which has grey
// brain; and MR-MIP, which is scaled to 8-bit MRI as MR-Default is.
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

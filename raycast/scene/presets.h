// The presets of transfer_function.h. Names, and but for CT-Air, CT-Bone, CT-Muscle,
// CT-Soft-Tissue, CT-X-ray, MR-Default and MR-MIP the looks, follow 3D Slicer's volume rendering
// presets (Modules/Loadable/VolumeRendering/Resources/presets.xml; key points rounded), whose
// opacities are per millimetre as well. Of those seven the tables are our own: their colours change
// little across the densities of a surface, since where they do, samples at fixed steps meet the
// ramp at varying depths and draw rings.
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

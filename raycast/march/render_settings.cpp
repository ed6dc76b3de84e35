#include "raycast/march/render_settings.h"

#include <algorithm>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr int kMaxStride = 16;

}  // namespace

Quality parse_quality(const std::string& name) {
  if (name == "draft") return Quality::draft;
  if (name == "default") return Quality::standard;
  if (name == "accurate") return Quality::accurate;
  throw InputError({"", "quality", "'" + name + "'", "draft, default or accurate"});
}

void RenderSettings::set_quality(Quality quality) {
  set_step(1.0 / samples_per_voxel(quality));
}

void RenderSettings::set_step(double voxels) {
  step_voxels = voxels;
  // Blocks of a voxel: longer ones leap over thin bone.
  stride = voxels > 0 ? int(std::clamp(1.0 / voxels + 1e-9, 1.0, double(kMaxStride))) : 1;
}

void RenderSettings::validate() const {
  require(width >= 1 && width <= 16384, "width", width, "1 to 16384 pixels");
  require(height >= 1 && height <= 16384, "height", height, "1 to 16384 pixels");
  require(step_voxels >= 0.01 && step_voxels <= 16, "step", step_voxels, "0.01 to 16 voxels");
  require(stride >= 1 && stride <= kMaxStride, "stride", stride, "1 to 16");
  require(early_termination > 0 && early_termination <= 1, "early_termination", early_termination,
          "more than 0, at most 1");
  for (const Clip& clip : clips) clip.validate("");
  lighting.validate("");
}

void RenderSettings::validate_with(const TransferFunction& function) const {
  if (classification == Classification::post || function.gradient_opacity.empty()) return;
  throw InputError({"", "classification", "pre-integrated with gradient opacity",
                    "post, or a transfer function without gradient opacity"});
}

}  // namespace supple

// Pixels of a picture that changed offsets may have altered.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/march/render_context.h"
#include "raycast/scene/camera.h"

namespace supple {

/// Per pixel 1 where the ray reads none of these bricks of the context's output before it is opaque
/// (`opaque_from_mm`, Marcher::opaque_from); 0 for all pixels whose rays do, and for some beside
/// them.
std::vector<std::uint8_t> unchanged_pixels(const RenderContext& context, const Camera& camera,
                                           const std::vector<std::size_t>& bricks,
                                           const std::vector<float>& opaque_from_mm);

}  // namespace supple

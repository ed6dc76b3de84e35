// JPEG in memory: pictures on their way to a page, and small ones inside of it.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/pictures/image.h"

namespace supple::tools {

/// Encodes an image as opaque, on black. Throws Error.
std::vector<std::uint8_t> jpeg_of(const Image& image);

}  // namespace supple::tools

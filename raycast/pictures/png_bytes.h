// A PNG in memory, for who sends it on.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/pictures/image.h"

namespace supple {

/// The bytes that write_png() writes, at a level of compression from 0 to 9. Throws SystemError.
std::vector<std::uint8_t> png_bytes(const Image& image, int level);

}  // namespace supple

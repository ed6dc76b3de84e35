// Small pictures of pictures, for pages.
#pragma once

#include <optional>
#include <string>

#include "raycast/pictures/image.h"

namespace supple::tools {

/// Pixels on the longer side.
constexpr int kThumbnailPixels = 160;

/// Opaque, on white, at most so many pixels wide and high: each pixel is the mean of the area that
/// it covers. Smaller pictures keep their size.
Image shrunk(const Image& image, int most);

/// The small picture of a file; none where there is no file, or one that is no PNG.
std::optional<Image> thumbnail_of(const std::string& picture);

}  // namespace supple::tools

// Small pictures of what rows drew, inside the page.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raycast/pictures/image.h"
#include "tools/lab/tradeoff/trade_runs.h"

namespace supple::tools {

/// Pixels on the longer side.
constexpr int kThumbnailPixels = 160;

/// Opaque, on white, at most so many pixels wide and high: each pixel is the mean of the area that
/// it covers. Smaller pictures keep their size.
Image shrunk(const Image& image, int most);

/// RFC 4648, with padding.
std::string base64_of(const std::vector<std::uint8_t>& bytes);

/// Figures of all rows that left a picture: the reference and the front, then the others, folded.
/// Each leads to its row. Empty where there is none; pictures other than PNG count as none.
std::string gallery_of(const TradeResults& results, const SceneCurves& curves);

}  // namespace supple::tools

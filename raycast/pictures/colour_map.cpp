#include "raycast/pictures/colour_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {

ScalarRange range_of(const std::vector<float>& values) {
  ScalarRange range{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const float value : values) {
    if (std::isnan(value)) continue;
    range.lo = std::min(range.lo, double(value));
    range.hi = std::max(range.hi, double(value));
  }
  return range.lo <= range.hi ? range : ScalarRange{};
}

std::vector<double> legend_ticks(const ScalarRange& range) {
  const double rough = (range.hi - range.lo) / 7;
  if (!(rough > 0)) return {};
  const double power = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= rough * 0.999) step = factor * power;
  }
  std::vector<double> ticks;
  const auto first = std::int64_t(std::ceil(range.lo / step - 0.01));
  const auto last = std::int64_t(std::floor(range.hi / step + 0.01));
  for (std::int64_t n = first; n <= last; ++n) ticks.push_back(double(n) * step);
  return ticks;
}

Image normal_image(const FloatImage& picture) {
  Image image(picture.width, picture.height);
  for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
    if (std::isnan(picture.depth_mm[n])) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const float share = 0.5f + 0.5f * picture.normal_lps[3 * n + c];
      image.rgba[4 * n + c] = std::uint8_t(std::lround(std::clamp(share, 0.0f, 1.0f) * 255));
    }
    image.rgba[4 * n + 3] = 255;
  }
  return image;
}

}  // namespace supple

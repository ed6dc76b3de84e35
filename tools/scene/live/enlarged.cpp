#include "tools/scene/live/enlarged.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

/// Two pixels in a row and the part of the later one, in 256ths.
struct Between {
  int low, high, part;
};

std::vector<Between> places_between(int to, int from) {
  std::vector<Between> places;
  for (int n = 0; n < to; ++n) {
    const double place = std::clamp((n + 0.5) * from / to - 0.5, 0.0, double(from - 1));
    places.push_back({int(place), std::min(int(place) + 1, from - 1),
                      int(std::lround(256 * (place - std::floor(place))))});
  }
  return places;
}

}  // namespace

Image enlarged(const Image& image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  Image large(width, height);
  large.has_alpha = image.has_alpha;
  const std::vector<Between> across = places_between(width, image.width);
  const std::vector<Between> down = places_between(height, image.height);
  parallel_for(height, [&](int y) {
    const std::uint8_t* upper = &image.rgba[std::size_t(down[y].low) * image.width * 4];
    const std::uint8_t* lower = &image.rgba[std::size_t(down[y].high) * image.width * 4];
    std::uint8_t* out = &large.rgba[std::size_t(y) * width * 4];
    const int v = down[y].part;
    for (const Between& x : across) {
      const int u = x.part;
      for (int c = 0; c < 4; ++c) {
        const int top = upper[4 * x.low + c] * (256 - u) + upper[4 * x.high + c] * u;
        const int bottom = lower[4 * x.low + c] * (256 - u) + lower[4 * x.high + c] * u;
        *out++ = std::uint8_t((top * (256 - v) + bottom * v + (1 << 15)) >> 16);
      }
    }
  });
  return large;
}

}  // namespace supple::tools

#include "tools/scene/pictures/thumbnail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "volumes/base/error.h"

namespace supple::tools {

namespace {

/// The pixels of one direction that a pixel of the smaller picture covers.
struct PixelSpan {
  int first, last;  // both are covered, at least in part
  double begin, end;

  PixelSpan(int pixel, double scale, int count)
      : first(int(pixel * scale)),
        last(std::min(int(std::ceil((pixel + 1) * scale)), count) - 1),
        begin(pixel * scale),
        end((pixel + 1) * scale) {}
  double part_of(int pixel) const {
    return std::min(end, pixel + 1.0) - std::max(begin, double(pixel));
  }
};

/// Mean red, green and blue of an area on white.
std::array<double, 3> mean_of(const Image& image, const PixelSpan& columns, const PixelSpan& rows) {
  std::array<double, 3> sum{};
  double area = 0;
  for (int y = rows.first; y <= rows.last; ++y) {
    for (int x = columns.first; x <= columns.last; ++x) {
      const std::uint8_t* rgba = &image.rgba[4 * (std::size_t(y) * image.width + x)];
      const double weight = rows.part_of(y) * columns.part_of(x);
      const double alpha = image.has_alpha ? rgba[3] / 255.0 : 1;
      for (std::size_t c = 0; c < 3; ++c) {
        sum[c] += weight * (alpha * rgba[c] + (1 - alpha) * 255);
      }
      area += weight;
    }
  }
  for (double& value : sum) value /= area;
  return sum;
}

}  // namespace

Image shrunk(const Image& image, int most) {
  const double scale = std::max(1.0, double(std::max(image.width, image.height)) / most);
  Image small(std::max(1, int(std::lround(image.width / scale))),
              std::max(1, int(std::lround(image.height / scale))));
  small.has_alpha = false;
  const double scale_x = double(image.width) / small.width;
  const double scale_y = double(image.height) / small.height;
  for (int y = 0; y < small.height; ++y) {
    const PixelSpan rows(y, scale_y, image.height);
    for (int x = 0; x < small.width; ++x) {
      const auto mean = mean_of(image, PixelSpan(x, scale_x, image.width), rows);
      std::uint8_t* rgba = &small.rgba[4 * (std::size_t(y) * small.width + x)];
      for (std::size_t c = 0; c < 3; ++c) rgba[c] = std::uint8_t(std::lround(mean[c]));
      rgba[3] = 255;
    }
  }
  return small;
}

std::optional<Image> thumbnail_of(const std::string& picture) {
  if (picture.empty() || !std::filesystem::exists(picture)) return std::nullopt;
  try {
    return shrunk(read_png(picture), kThumbnailPixels);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace supple::tools

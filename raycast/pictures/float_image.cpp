#include <algorithm>
#include <cmath>
#include <limits>

#include "raycast/pictures/image.h"

namespace supple {

namespace {

/// Premultiplied 0…1 to straight whole numbers up to `white`.
template <class Whole>
void quantise(const std::vector<float>& premultiplied, float white, std::vector<Whole>& straight) {
  straight.assign(premultiplied.size(), 0);
  for (std::size_t n = 0; n < straight.size(); n += 4) {
    const float* sum = &premultiplied[n];
    const long alpha = std::lround(std::min(sum[3], 1.0f) * white);
    for (std::size_t c = 0; c < 3 && alpha > 0; ++c) {
      straight[n + c] = Whole(std::lround(std::clamp(sum[c] / sum[3], 0.0f, 1.0f) * white));
    }
    straight[n + 3] = Whole(alpha);
  }
}

/// `count` values per pixel of both pictures' rows, one after the other.
void append_rows(const std::vector<float>& left, const std::vector<float>& right,
                 std::size_t left_row, std::size_t right_row, std::vector<float>& out) {
  out.clear();
  if (left.empty() || right.empty()) return;
  for (std::size_t y = 0; y * left_row < left.size(); ++y) {
    const auto l = left.begin() + std::ptrdiff_t(y * left_row);
    const auto r = right.begin() + std::ptrdiff_t(y * right_row);
    out.insert(out.end(), l, l + std::ptrdiff_t(left_row));
    out.insert(out.end(), r, r + std::ptrdiff_t(right_row));
  }
}

}  // namespace

FloatImage::FloatImage(int width_, int height_, bool has_auxiliary)
    : width(width_), height(height_), rgba(4 * pixel_count()) {
  if (!has_auxiliary) return;
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  depth_mm.assign(pixel_count(), kNone);
  normal_lps.assign(3 * pixel_count(), kNone);
  offset_mm.assign(pixel_count(), kNone);
}

float linear_from_srgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float srgb_from_linear(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

Image to_image(const FloatImage& picture) {
  Image image(picture.width, picture.height);
  image.has_alpha = picture.has_alpha;
  quantise(picture.rgba, 255, image.rgba);
  return image;
}

std::vector<std::uint16_t> to_16_bit(const FloatImage& picture) {
  std::vector<std::uint16_t> rgba;
  quantise(picture.rgba, 65535, rgba);
  return rgba;
}

FloatImage to_float(const Image& image) {
  FloatImage picture(image.width, image.height);
  picture.has_alpha = image.has_alpha;
  for (std::size_t n = 0; n < image.rgba.size(); n += 4) {
    const float alpha = float(image.rgba[n + 3]) / 255.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      picture.rgba[n + c] = float(image.rgba[n + c]) / 255.0f * alpha;
    }
    picture.rgba[n + 3] = alpha;
  }
  return picture;
}

FloatImage side_by_side(const FloatImage& left, const FloatImage& right) {
  FloatImage both;
  both.width = left.width + right.width;
  both.height = left.height;
  both.has_alpha = left.has_alpha || right.has_alpha;
  const auto append = [&](const std::vector<float> FloatImage::*channel, std::size_t count) {
    std::vector<float> rows;
    append_rows(left.*channel, right.*channel, count * left.width, count * right.width, rows);
    return rows;
  };
  both.rgba = append(&FloatImage::rgba, 4);
  both.depth_mm = append(&FloatImage::depth_mm, 1);
  both.normal_lps = append(&FloatImage::normal_lps, 3);
  both.offset_mm = append(&FloatImage::offset_mm, 1);
  return both;
}

}  // namespace supple

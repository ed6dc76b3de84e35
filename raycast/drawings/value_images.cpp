#include "raycast/drawings/value_images.h"

#include <algorithm>
#include <cmath>

#include "raycast/drawings/annotations.h"

namespace supple {

namespace {

/// Surfaces that turn away from the camera keep this share of their colour: dark enough to be seen
/// as turned away, light enough for the colour to be read.
constexpr double kAmbient = 0.55;

constexpr double kNearGrey = 1, kFarGrey = 30.0 / 255;

double share_of(double value, const ScalarRange& range) {
  const double span = range.hi - range.lo;
  return span > 0 ? std::clamp((value - range.lo) / span, 0.0, 1.0) : 0;
}

/// One colour per value; `light(n)` darkens that of a pixel.
template <class Colour, class Light>
Image value_image(const FloatImage& picture, const std::vector<float>& values,
                  const ScalarRange& range, Ground ground, const std::string& title,
                  const Colour& colour, const Light& light) {
  const PictureArea seen{0, 0, double(picture.width), double(picture.height)};
  const double letter_height = Annotations::letter_height_for(seen);
  const bool has_legend = picture.height >= kLowestWithLegend && !legend_ticks(range).empty();
  const int strip = has_legend ? int(std::ceil(Annotations::kLegendReach * letter_height)) : 0;

  FloatImage image(picture.width + strip, picture.height);
  image.has_alpha = false;
  std::fill(image.rgba.begin(), image.rgba.end(), ground == Ground::light ? 1.0f : 0.0f);
  for (std::size_t n = 3; n < image.rgba.size(); n += 4) image.rgba[n] = 1;
  const auto width = std::size_t(picture.width);
  for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
    if (std::isnan(values[n])) continue;
    const Rgb rgb = colour(values[n]);
    float* pixel = &image.rgba[4 * (n / width * std::size_t(image.width) + n % width)];
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = float(light(n) * rgb[c]);
  }
  if (has_legend) {
    Overlay overlay;
    const PictureArea all{0, 0, double(image.width), double(image.height)};
    Annotations(overlay, all, letter_height, ground).legend(range, colour, title);
    draw_overlay(image, overlay);
  }
  return to_image(image);
}

}  // namespace

Image offset_image(const FloatImage& picture, const ScalarRange& range_mm,
                   const std::array<float, 3>& towards_camera) {
  const auto light = [&](std::size_t n) {
    double facing = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      facing += double(picture.normal_lps[3 * n + c]) * double(towards_camera[c]);
    }
    return kAmbient + (1 - kAmbient) * std::max(facing, 0.0);
  };
  const auto colour = [&](double value) { return offset_colour(share_of(value, range_mm)); };
  return value_image(picture, picture.offset_mm, range_mm, Ground::light, "offset (mm)", colour,
                     light);
}

Image depth_image(const FloatImage& picture, const ScalarRange& range_mm) {
  const auto colour = [&](double value) {
    const double grey = kNearGrey + (kFarGrey - kNearGrey) * share_of(value, range_mm);
    return Rgb{grey, grey, grey};
  };
  return value_image(picture, picture.depth_mm, range_mm, Ground::dark, "depth (mm)", colour,
                     [](std::size_t) { return 1.0; });
}

}  // namespace supple

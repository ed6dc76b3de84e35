// Loads the plugin of what needs OpenCV or OpenEXR: comparisons, legends, words over pictures, EXR
// files. Cost: about 6 ms and 9 MB, once, when one of them is first asked for.
#include "raycast/pictures/pictures_plugin.h"

#include <algorithm>
#include <cmath>

#include "raycast/pictures/colour_map.h"

namespace supple {

namespace {

const PicturesPlugin& pictures_plugin() {
  static const PicturesPlugin& entry = plugin_entry<PicturesPlugin>();
  return entry;
}

}  // namespace

Comparison compare(const Image& a, const Image& b, bool foreground_only) {
  return pictures_plugin().compare(a, b, foreground_only);
}

Image difference_image(const Image& a, const Image& b) {
  return pictures_plugin().difference_image(a, b);
}

Rgb offset_colour(double share) {
  static const ColourTable table = pictures_plugin().offset_colours();
  const auto& entry = table[std::size_t(std::lround(std::clamp(share, 0.0, 1.0) * 255))];
  return {entry[0] / 255.0, entry[1] / 255.0, entry[2] / 255.0};
}

void draw_overlay(FloatImage& picture, const Overlay& overlay) {
  pictures_plugin().draw_overlay(picture, overlay);
}

void write_exr(const AtomicFile& target, const FloatImage& picture, const ExrFacts& facts) {
  pictures_plugin().write_exr(target, picture, facts);
}

}  // namespace supple

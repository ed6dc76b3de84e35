// Loads the plugin of what needs OpenCV or OpenEXR: comparisons, legends, words over pictures, EXR
// files. Cost: about 6 ms and 9 MB, once, when one of them is first asked for.
#include "raycast/pictures/pictures_plugin.h"

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

Image offset_image(const FloatImage& picture, const ScalarRange& range_mm,
                   const std::array<float, 3>& towards_camera) {
  return pictures_plugin().offset_image(picture, range_mm, towards_camera);
}

Image depth_image(const FloatImage& picture, const ScalarRange& range_mm) {
  return pictures_plugin().depth_image(picture, range_mm);
}

void draw_overlay(FloatImage& picture, const Overlay& overlay) {
  pictures_plugin().draw_overlay(picture, overlay);
}

void write_exr(const AtomicFile& target, const FloatImage& picture, const std::string& comment) {
  pictures_plugin().write_exr(target, picture, comment);
}

}  // namespace supple

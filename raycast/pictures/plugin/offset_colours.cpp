// The colours of offsets, from OpenCV's tables (raycast/pictures/colour_map.h).
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "raycast/pictures/pictures_plugin.h"

namespace supple {

namespace {

/// The range of magma that leaves some light in its dark end, and is not white at the other.
constexpr int kLightest = 245, kDarkest = 50;

}  // namespace

ColourTable offset_colours() {
  cv::Mat grey(1, 256, CV_8UC1), bgr;
  for (int n = 0; n < 256; ++n) {
    const double along = kLightest + (kDarkest - kLightest) * n / 255.0;
    grey.at<std::uint8_t>(0, n) = std::uint8_t(std::lround(along));
  }
  cv::applyColorMap(grey, bgr, cv::COLORMAP_MAGMA);
  ColourTable table{};
  for (int n = 0; n < 256; ++n) {
    const auto& pixel = bgr.at<cv::Vec3b>(0, n);
    table[std::size_t(n)] = {pixel[2], pixel[1], pixel[0]};
  }
  return table;
}

}  // namespace supple

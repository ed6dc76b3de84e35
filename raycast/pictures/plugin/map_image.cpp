// Pictures of offsets and depths with their legends, drawn by OpenCV
// (raycast/pictures/colour_map.h).
#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "raycast/pictures/colour_map.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

using ColourTable = std::array<std::array<std::uint8_t, 3>, 256>;

/// Surfaces that turn away from the camera keep this share of their colour: dark enough to be seen
/// as turned away, light enough for the colour to be read.
constexpr float kAmbient = 0.55f;

/// The range of magma that leaves some light in its dark end, and is not white at the other.
constexpr int kLightest = 245, kDarkest = 50;

ColourTable light_to_dark_magma() {
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

/// Bright is near.
ColourTable descending_greys() {
  ColourTable table{};
  for (std::size_t n = 0; n < 256; ++n) table[n].fill(std::uint8_t(255 - n * 225 / 255));
  return table;
}

std::size_t entry(double value, const ScalarRange& range) {
  const double span = range.hi - range.lo;
  const double share = span > 0 ? (value - range.lo) / span : 0;
  return std::size_t(std::lround(std::clamp(share, 0.0, 1.0) * 255));
}

struct Paper {
  std::uint8_t background, ink;
};

/// The colours as a bar, from lo at its foot, with ticks to its right and a title above.
class Legend {
 public:
  Legend(int height, const ScalarRange& range, std::string title)
      : m_range(range),
        m_title(std::move(title)),
        m_ticks(legend_ticks(range)),
        m_unit(std::max(height, 240) / 40.0),
        m_scale(cv::getFontScaleFromHeight(cv::FONT_HERSHEY_SIMPLEX, int(m_unit), 1)),
        m_thickness(std::max(1, int(std::lround(m_unit / 9)))) {
    double widest = width_of(m_title);
    for (const double tick : m_ticks) {
      widest = std::max(widest, m_unit + gap() + width_of(number_text(tick)));
    }
    if (height >= kLowestWithLegend && !m_ticks.empty()) m_width = int(widest + 2 * m_unit);
  }

  /// Of the strip that it stands in; 0: there is none.
  int width() const { return m_width; }

  void draw(cv::Mat strip, const ColourTable& table, const Paper& paper) const {
    const int left = int(m_unit), right = int(2 * m_unit);
    const int top = strip.rows / 5, bottom = strip.rows * 4 / 5;
    for (int y = top; y < bottom; ++y) {
      const double share = double(bottom - 1 - y) / (bottom - 1 - top);
      const auto& rgb = table[std::size_t(std::lround(share * 255))];
      cv::line(strip, {left, y}, {right, y}, cv::Scalar(rgb[0], rgb[1], rgb[2], 255));
    }
    const cv::Scalar ink(paper.ink, paper.ink, paper.ink, 255);
    const auto write = [&](const std::string& text, int x, int y) {
      cv::putText(strip, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, m_scale, ink, m_thickness,
                  cv::LINE_AA);
    };
    for (const double tick : m_ticks) {
      const double share = (tick - m_range.lo) / (m_range.hi - m_range.lo);
      const int y = int(std::lround(bottom - 1 - share * (bottom - 1 - top)));
      cv::line(strip, {right, y}, {int(right + gap() / 2), y}, ink, m_thickness);
      write(number_text(tick), int(right + gap()), int(y + m_unit / 2));
    }
    write(m_title, left, int(top - m_unit));
  }

 private:
  double gap() const { return 0.6 * m_unit; }
  double width_of(const std::string& text) const {
    return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, m_scale, m_thickness, nullptr).width;
  }

  ScalarRange m_range;
  std::string m_title;
  std::vector<double> m_ticks;
  double m_unit;  // height of the text, pixels
  double m_scale;
  int m_thickness;
  int m_width = 0;
};

/// One grey or colour per pixel; `light(n)` darkens it.
template <class Light>
Image map_image(const FloatImage& picture, const std::vector<float>& values,
                const ColourTable& table, const ScalarRange& range, const Paper& paper,
                const std::string& title, Light&& light) {
  const Legend legend(picture.height, range, title);
  Image image(picture.width + legend.width(), picture.height);
  image.has_alpha = false;
  cv::Mat canvas(image.height, image.width, CV_8UC4, image.rgba.data());
  canvas.setTo(cv::Scalar(paper.background, paper.background, paper.background, 255));
  for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
    if (std::isnan(values[n])) continue;
    const int x = int(n % std::size_t(picture.width)), y = int(n / std::size_t(picture.width));
    auto& pixel = canvas.at<cv::Vec4b>(y, x);
    const auto& colour = table[entry(values[n], range)];
    const float share = light(n);
    for (int c = 0; c < 3; ++c) {
      pixel[c] = std::uint8_t(std::lround(share * float(colour[std::size_t(c)])));
    }
  }
  if (legend.width() > 0) legend.draw(canvas.colRange(picture.width, image.width), table, paper);
  return image;
}

}  // namespace

Image offset_image(const FloatImage& picture, const ScalarRange& range_mm,
                   const std::array<float, 3>& towards_camera) {
  const auto light = [&](std::size_t n) {
    float facing = 0;
    for (std::size_t c = 0; c < 3; ++c) facing += picture.normal_lps[3 * n + c] * towards_camera[c];
    return kAmbient + (1 - kAmbient) * std::max(facing, 0.0f);
  };
  return map_image(picture, picture.offset_mm, light_to_dark_magma(), range_mm, {255, 0},
                   "offset (mm)", light);
}

Image depth_image(const FloatImage& picture, const ScalarRange& range_mm) {
  return map_image(picture, picture.depth_mm, descending_greys(), range_mm, {0, 255}, "depth (mm)",
                   [](std::size_t) { return 1.0f; });
}

}  // namespace supple

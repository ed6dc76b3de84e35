#include "raycast/colour_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "volumes/base/error.h"

namespace supple {

namespace {

using Table = std::array<std::array<std::uint8_t, 3>, 256>;

/// Surfaces that turn away from the camera keep this share of their colour: dark enough to be seen
/// as turned away, light enough for the colour to be read.
constexpr float kAmbient = 0.55f;

Table viridis() {
  cv::Mat grey(1, 256, CV_8UC1), bgr;
  for (int n = 0; n < 256; ++n) grey.at<std::uint8_t>(0, n) = std::uint8_t(n);
  cv::applyColorMap(grey, bgr, cv::COLORMAP_VIRIDIS);
  Table table{};
  for (int n = 0; n < 256; ++n) {
    const auto& pixel = bgr.at<cv::Vec3b>(0, n);
    table[std::size_t(n)] = {pixel[2], pixel[1], pixel[0]};
  }
  return table;
}

/// Bright is near.
Table descending_greys() {
  Table table{};
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

/// The colours as a bar at the right edge, from lo at its foot, with ticks and a title above.
class Legend {
 public:
  Legend(Image& image, const Table& table, const ScalarRange& range, const Paper& paper)
      : m_canvas(image.height, image.width, CV_8UC4, image.rgba.data()),
        m_table(table),
        m_range(range),
        m_paper(paper),
        m_unit(std::max(image.height, 240) / 40.0),
        m_scale(cv::getFontScaleFromHeight(cv::FONT_HERSHEY_SIMPLEX, int(m_unit), 1)),
        m_thickness(std::max(1, int(std::lround(m_unit / 9)))) {}

  void draw(const std::string& title) {
    const std::vector<double> ticks = legend_ticks(m_range);
    double text_width = 0;
    for (const double tick : ticks) text_width = std::max(text_width, width_of(number_text(tick)));
    const double bar = m_unit, gap = 0.6 * m_unit;
    text_width = std::max(text_width, width_of(title) - bar - gap);
    const int left = int(m_canvas.cols - m_unit - text_width - gap - bar);
    const int right = int(left + bar);
    const int top = m_canvas.rows / 5, bottom = m_canvas.rows * 4 / 5;
    for (int y = top; y < bottom; ++y) {
      const double share = double(bottom - 1 - y) / (bottom - 1 - top);
      const auto& rgb = m_table[std::size_t(std::lround(share * 255))];
      cv::line(m_canvas, {left, y}, {right, y}, cv::Scalar(rgb[0], rgb[1], rgb[2], 255));
    }
    for (const double tick : ticks) {
      const double share = (tick - m_range.lo) / (m_range.hi - m_range.lo);
      const int y = int(std::lround(bottom - 1 - share * (bottom - 1 - top)));
      cv::line(m_canvas, {right, y}, {int(right + gap / 2), y}, ink(), m_thickness);
      write(number_text(tick), int(right + gap), int(y + m_unit / 2));
    }
    write(title, left, int(top - m_unit));
  }

 private:
  cv::Scalar ink() const {
    return {double(m_paper.ink), double(m_paper.ink), double(m_paper.ink), 255};
  }
  double width_of(const std::string& text) const {
    return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, m_scale, m_thickness, nullptr).width;
  }
  void write(const std::string& text, int x, int y) {
    cv::putText(m_canvas, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, m_scale, ink(), m_thickness,
                cv::LINE_AA);
  }

  cv::Mat m_canvas;
  const Table& m_table;
  ScalarRange m_range;
  Paper m_paper;
  double m_unit;  // height of the text, pixels
  double m_scale;
  int m_thickness;
};

/// One grey or colour per pixel; `light(n)` darkens it.
template <class Light>
Image map_image(const FloatImage& picture, const std::vector<float>& values, const Table& table,
                const ScalarRange& range, const Paper& paper, const std::string& title,
                Light&& light) {
  Image image(picture.width, picture.height);
  image.has_alpha = false;
  for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
    const bool is_there = !std::isnan(values[n]);
    const float share = is_there ? light(n) : 1;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint8_t colour = is_there ? table[entry(values[n], range)][c] : paper.background;
      image.rgba[4 * n + c] = std::uint8_t(std::lround(share * float(colour)));
    }
    image.rgba[4 * n + 3] = 255;
  }
  if (std::min(image.width, image.height) >= kSmallestWithLegend && range.hi > range.lo) {
    Legend(image, table, range, paper).draw(title);
  }
  return image;
}

}  // namespace

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
  const auto first = std::int64_t(std::ceil(range.lo / step - 1e-9));
  const auto last = std::int64_t(std::floor(range.hi / step + 1e-9));
  for (std::int64_t n = first; n <= last; ++n) ticks.push_back(double(n) * step);
  return ticks;
}

Image offset_image(const FloatImage& picture, const ScalarRange& range_mm,
                   const std::array<float, 3>& towards_camera) {
  const auto light = [&](std::size_t n) {
    float facing = 0;
    for (std::size_t c = 0; c < 3; ++c) facing += picture.normal_lps[3 * n + c] * towards_camera[c];
    return kAmbient + (1 - kAmbient) * std::max(facing, 0.0f);
  };
  return map_image(picture, picture.offset_mm, viridis(), range_mm, {255, 0}, "offset (mm)", light);
}

Image depth_image(const FloatImage& picture, const ScalarRange& range_mm) {
  return map_image(picture, picture.depth_mm, descending_greys(), range_mm, {0, 255}, "depth (mm)",
                   [](std::size_t) { return 1.0f; });
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

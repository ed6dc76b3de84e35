// Shapes and words over pictures, drawn by OpenCV (raycast/pictures/overlay.h): each is a mask of
// coverage, and the picture takes the ink where the mask is.
#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "raycast/pictures/overlay.h"

namespace supple {

namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr int kFractionBits = 4;  // of coordinates handed to OpenCV
constexpr double kHaloOpacity = 0.7;

/// OpenCV's pixel centres are whole numbers.
cv::Point fixed_point(const PixelPoint& p) {
  const double one = 1 << kFractionBits;
  return {int(std::lround((p[0] - 0.5) * one)), int(std::lround((p[1] - 0.5) * one))};
}

int stroke_of(double height) {
  return std::max(1, int(std::lround(height / 9)));
}

/// The coverage of one shape in a part of the picture.
class CoverageMask {
 public:
  CoverageMask(const FloatImage& picture, const cv::Rect& wanted)
      : m_area(wanted & cv::Rect(0, 0, picture.width, picture.height)) {
    if (!empty()) m_mask = cv::Mat::zeros(m_area.size(), CV_8UC1);
  }
  bool empty() const { return m_area.empty(); }
  cv::Mat& pixels() { return m_mask; }
  /// A point of the picture as one of the mask.
  PixelPoint local(const PixelPoint& p) const { return {p[0] - m_area.x, p[1] - m_area.y}; }
  void clear() { m_mask.setTo(0); }

  void paint(FloatImage& picture, const Rgb& ink, double opacity) const {
    for (int y = 0; y < m_area.height; ++y) {
      for (int x = 0; x < m_area.width; ++x) {
        const float share = float(m_mask.at<std::uint8_t>(y, x) / 255.0 * opacity);
        if (share == 0) continue;
        const std::size_t n = std::size_t(y + m_area.y) * picture.width + x + m_area.x;
        float* rgba = &picture.rgba[4 * n];
        for (std::size_t c = 0; c < 3; ++c) rgba[c] += share * (float(ink[c]) - rgba[c]);
        rgba[3] += share * (1 - rgba[3]);
      }
    }
  }

 private:
  cv::Rect m_area;
  cv::Mat m_mask;
};

cv::Rect bounds_of(const std::vector<PixelPoint>& points, double margin) {
  double lo[2] = {1e9, 1e9}, hi[2] = {-1e9, -1e9};
  for (const PixelPoint& p : points) {
    for (int a = 0; a < 2; ++a) {
      lo[a] = std::min(lo[a], std::clamp(p[a], -1e6, 1e6));
      hi[a] = std::max(hi[a], std::clamp(p[a], -1e6, 1e6));
    }
  }
  const cv::Point first(int(std::floor(lo[0] - margin)), int(std::floor(lo[1] - margin)));
  const cv::Point last(int(std::ceil(hi[0] + margin)) + 1, int(std::ceil(hi[1] + margin)) + 1);
  return {first, last};
}

class OverlayPainter {
 public:
  explicit OverlayPainter(FloatImage& picture) : m_picture(picture) {}

  void operator()(const OverlayFace& face) const {
    if (face.corners.size() < 3) return;
    CoverageMask mask(m_picture, bounds_of(face.corners, 1));
    if (mask.empty()) return;
    std::vector<cv::Point> corners;
    for (const PixelPoint& p : face.corners) corners.push_back(fixed_point(mask.local(p)));
    cv::fillConvexPoly(mask.pixels(), corners, 255, cv::LINE_AA, kFractionBits);
    mask.paint(m_picture, face.fill, 1);
  }

  void operator()(const OverlayLine& line) const {
    if (line.points.size() < 2) return;
    const int width = std::max(1, int(std::lround(line.width)));
    const int rim = width + 2 * std::max(1, int(std::lround(line.width / 2)));
    CoverageMask mask(m_picture, bounds_of(line.points, rim + 1));
    if (mask.empty()) return;
    std::vector<cv::Point> points;
    for (const PixelPoint& p : line.points) points.push_back(fixed_point(mask.local(p)));
    const auto stroke = [&](int thickness, const Rgb& ink, double opacity) {
      mask.clear();
      cv::polylines(mask.pixels(), points, false, 255, thickness, cv::LINE_AA, kFractionBits);
      mask.paint(m_picture, ink, opacity);
    };
    if (line.halo) stroke(rim, *line.halo, kHaloOpacity);
    stroke(width, line.ink, 1);
  }

  void operator()(const OverlayText& text) const {
    const int thickness = stroke_of(text.height);
    const int rim = thickness + 2 * std::max(1, thickness);
    const double scale =
        cv::getFontScaleFromHeight(kFont, std::max(1, int(std::lround(text.height))), thickness);
    int below = 0;
    const cv::Size size = cv::getTextSize(text.text, kFont, scale, thickness, &below);
    const int margin = rim + below;

    // Plain text in a mask of its own, and where its top left corner comes to lie.
    const cv::Size whole(size.width + 2 * margin, size.height + 2 * margin);
    const double to_left = margin + text.hold[0] * size.width;
    const double to_top = margin + text.hold[1] * size.height;
    const cv::Matx23d place(
        text.along[0], text.down[0], text.at[0] - text.along[0] * to_left - text.down[0] * to_top,
        text.along[1], text.down[1], text.at[1] - text.along[1] * to_left - text.down[1] * to_top);
    std::vector<PixelPoint> corners;
    for (const auto& [x, y] :
         {std::pair(0, 0), {whole.width, 0}, {0, whole.height}, {whole.width, whole.height}}) {
      corners.push_back({place(0, 0) * x + place(0, 1) * y + place(0, 2),
                         place(1, 0) * x + place(1, 1) * y + place(1, 2)});
    }
    CoverageMask mask(m_picture, bounds_of(corners, 1));
    if (mask.empty()) return;
    const PixelPoint origin = mask.local({0, 0});
    cv::Matx23d into_mask = place;
    const bool is_plain = text.along == PixelPoint{1, 0} && text.down == PixelPoint{0, 1};
    for (int a = 0; a < 2; ++a) {
      into_mask(a, 2) += origin[std::size_t(a)];
      // Plain text stays sharp on whole pixels.
      if (is_plain) into_mask(a, 2) = std::round(into_mask(a, 2));
    }
    const auto stroke = [&](int pen, const Rgb& ink, double opacity) {
      cv::Mat plain = cv::Mat::zeros(whole, CV_8UC1);
      cv::putText(plain, text.text, {margin, margin + size.height}, kFont, scale, 255, pen,
                  cv::LINE_AA);
      cv::warpAffine(plain, mask.pixels(), into_mask, mask.pixels().size(), cv::INTER_LINEAR);
      mask.paint(m_picture, ink, opacity);
    };
    if (text.halo) stroke(rim, *text.halo, kHaloOpacity);
    stroke(thickness, text.ink, 1);
  }

 private:
  FloatImage& m_picture;
};

}  // namespace

void draw_overlay(FloatImage& picture, const Overlay& overlay) {
  const OverlayPainter painter(picture);
  for (const OverlayShape& shape : overlay) std::visit(painter, shape);
}

}  // namespace supple

#include "tools/lab/tradeoff/page/thumbnails.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>

#include "tools/lab/tradeoff/page/page_text.h"
#include "tools/scene/pictures/jpeg.h"
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

std::optional<Image> thumbnail_of(const std::string& picture) {
  if (picture.empty() || !std::filesystem::exists(picture)) return std::nullopt;
  try {
    return shrunk(read_png(picture), kThumbnailPixels);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::string caption_of(const TradeRow& row) {
  const std::string time = time_text(row.time_s().median);
  if (row.is_drawing()) return time + ", SSIM " + short_number(row.ssim);
  return time + ", " + short_number(row.p95_mm) + " mm";
}

std::string figure_of(const TradeRow& row, std::size_t r, bool is_reference) {
  if (!row.is_ok()) return "";
  const std::optional<Image> image = thumbnail_of(row.picture);
  if (!image) return "";
  return "<figure><a href=\"#" + row_id(r) + "\"><img width=\"" + std::to_string(image->width) +
         "\" height=\"" + std::to_string(image->height) + "\" alt=\"Picture of " +
         html_text(row.command) + "\" src=\"data:image/jpeg;base64," + base64_of(jpeg_of(*image)) +
         "\"></a><figcaption><code>" + html_text(row.name()) + "</code><br>" +
         (is_reference ? "the reference" : caption_of(row)) + "</figcaption></figure>\n";
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

std::string base64_of(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t n = 0; n < 3; ++n)
      bits = bits << 8 | (i + n < bytes.size() ? bytes[i + n] : 0);
    for (std::size_t n = 0; n < 4; ++n) {
      const bool is_there = n == 0 || i + n - 1 < bytes.size();
      text += is_there ? kDigits[bits >> (18 - 6 * n) & 63] : '=';
    }
  }
  return text;
}

std::string gallery_of(const TradeResults& results, const SceneCurves& curves) {
  const auto figure = [&](std::size_t r) {
    return figure_of(results.rows[r], r, r == curves.reference);
  };
  std::string first = figure(curves.reference), rest;
  for (const TradePoint& point : curves.front) first += figure(point.row);
  for (const std::size_t r : curves.rows) {
    const bool is_of_front = std::any_of(curves.front.begin(), curves.front.end(),
                                         [&](const TradePoint& point) { return point.row == r; });
    if (r != curves.reference && !is_of_front) rest += figure(r);
  }
  if (first.empty() && rest.empty()) return "";
  std::string html =
      "<h3>Pictures</h3>\n<p>The first view in space, as the reference and each row of the front "
      "drew it.</p>\n<div class=\"pictures\">\n" +
      first + "</div>\n";
  if (rest.empty()) return html;
  return html + "<details><summary>All other rows</summary><div class=\"pictures\">\n" + rest +
         "</div></details>\n";
}

}  // namespace supple::tools

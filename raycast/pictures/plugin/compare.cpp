#include "raycast/pictures/compare.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kC1 = 0.01 * 0.01;  // Wang et al. 2004, eq. 13, for luminance 0…1
constexpr double kC2 = 0.03 * 0.03;

/// Rec. 709 weights on the stored (sRGB) values.
constexpr double kRed = 0.2126, kGreen = 0.7152, kBlue = 0.0722;

constexpr int kColours = 3;

/// Colours composited on black, and alpha, 0…1.
cv::Mat4d on_black(const Image& image) {
  cv::Mat4d out(image.height, image.width);
  for (int n = 0; n < image.width * image.height; ++n) {
    const std::uint8_t* p = &image.rgba[4 * std::size_t(n)];
    const double alpha = image.has_alpha ? p[3] / 255.0 : 1.0;
    out(n / image.width, n % image.width) =
        cv::Vec4d(p[0] * alpha, p[1] * alpha, p[2] * alpha, 255 * alpha) / 255.0;
  }
  return out;
}

cv::Mat1d luminance(const cv::Mat4d& rgba) {
  cv::Mat1d out(rgba.size());
  std::transform(rgba.begin(), rgba.end(), out.begin(),
                 [](const cv::Vec4d& c) { return kRed * c[0] + kGreen * c[1] + kBlue * c[2]; });
  return out;
}

cv::Mat1d blurred(const cv::Mat1d& x) {
  cv::Mat1d out;
  cv::GaussianBlur(x, out, cv::Size(11, 11), 1.5, 1.5, cv::BORDER_REFLECT_101);
  return out;
}

cv::Mat1d product(const cv::Mat1d& a, const cv::Mat1d& b) {
  cv::Mat1d out;
  cv::multiply(a, b, out);
  return out;
}

/// Map of the structural similarity, Wang et al. 2004, eq. 13.
cv::Mat1d ssim_map(const cv::Mat1d& a, const cv::Mat1d& b) {
  const cv::Mat1d mean_a = blurred(a), mean_b = blurred(b);
  const cv::Mat1d aa = blurred(product(a, a)), bb = blurred(product(b, b)),
                  ab = blurred(product(a, b));
  cv::Mat1d map(a.size());
  for (int y = 0; y < a.rows; ++y) {
    for (int x = 0; x < a.cols; ++x) {
      const double ma = mean_a(y, x), mb = mean_b(y, x);
      const double variances = aa(y, x) - ma * ma + bb(y, x) - mb * mb;
      const double covariance = ab(y, x) - ma * mb;
      map(y, x) = (2 * ma * mb + kC1) * (2 * covariance + kC2) /
                  ((ma * ma + mb * mb + kC1) * (variances + kC2));
    }
  }
  return map;
}

bool is_foreground(const Image& image, std::size_t pixel) {
  return !image.has_alpha || image.rgba[4 * pixel + 3] > 0;
}

void require_equal_sizes(const Image& a, const Image& b) {
  if (a.width == b.width && a.height == b.height) return;
  const auto text = [](const Image& i) {
    return std::to_string(i.width) + "x" + std::to_string(i.height) + " pixels";
  };
  throw InputError({"", "image size", text(b), text(a) + " as in the first image"});
}

}  // namespace

Comparison compare(const Image& a, const Image& b, bool foreground_only) {
  require_equal_sizes(a, b);
  const cv::Mat4d rgba_a = on_black(a), rgba_b = on_black(b);
  const cv::Mat1d map = ssim_map(luminance(rgba_a), luminance(rgba_b));
  Comparison result;
  double squares = 0, squares_of_alpha = 0, similarity = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const std::size_t pixel = std::size_t(y) * a.width + x;
      if (foreground_only && !is_foreground(a, pixel) && !is_foreground(b, pixel)) continue;
      const cv::Vec4d difference = rgba_a(y, x) - rgba_b(y, x);
      for (int c = 0; c <= kColours; ++c) {
        (c < kColours ? squares : squares_of_alpha) += difference[c] * difference[c];
        result.max_diff = std::max(result.max_diff, std::abs(difference[c]));
      }
      similarity += map(y, x);
      ++result.compared_pixels;
    }
  }
  if (result.compared_pixels > 0) {
    const double pixels = double(result.compared_pixels);
    result.rmse = std::sqrt(squares / (kColours * pixels));
    result.rmse_alpha = std::sqrt(squares_of_alpha / pixels);
    result.ssim = similarity / pixels;
  }
  return result;
}

Image difference_image(const Image& a, const Image& b) {
  require_equal_sizes(a, b);
  cv::Mat4d difference;
  cv::absdiff(on_black(a), on_black(b), difference);
  double largest = 0;
  for (const cv::Vec4d& d : difference) largest = std::max({largest, d[0], d[1], d[2], d[3]});
  const double gain = largest > 0 ? 255 / largest : 0;
  Image out(a.width, a.height);
  out.has_alpha = false;
  std::size_t n = 0;
  for (const cv::Vec4d& d : difference) {
    for (int c = 0; c < 3; ++c) {
      out.rgba[n++] = std::uint8_t(std::lround(std::max(d[c], d[3]) * gain));
    }
    out.rgba[n++] = 255;
  }
  return out;
}

}  // namespace supple

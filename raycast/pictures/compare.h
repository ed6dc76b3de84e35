// How different two images are (design.md section 5): the judge of golden-image tests.
#pragma once

#include "raycast/pictures/image.h"

namespace supple {

struct Comparison {
  double rmse = 0;      // over R, G, B of the images composited on black, 0…1
  double max_diff = 0;  // largest channel difference, 0…1
  double ssim = 1;      // luminance, Gaussian window 11x11, sigma 1.5
  std::int64_t compared_pixels = 0;
};

/// `foreground_only`: average where either image's alpha > 0. Throws InputError when the sizes
/// differ.
Comparison compare(const Image& a, const Image& b, bool foreground_only);

/// |a - b|, amplified so that the largest difference is white; opaque.
Image difference_image(const Image& a, const Image& b);

}  // namespace supple

// How different two images are (design.md section 5): the judge of golden-image tests.
#pragma once

#include "raycast/pictures/image.h"

namespace supple {

struct Comparison {
  double rmse = 0;        // over R, G, B composited on black, 0…1
  double rmse_alpha = 0;  // over alpha alone, 0…1
  double max_diff = 0;    // largest difference of one of these four channels, 0…1
  double ssim = 1;        // luminance on black, Gaussian window 11x11, sigma 1.5
  std::int64_t compared_pixels = 0;
};

/// An image without alpha is opaque. `foreground_only`: average where either image's alpha > 0.
/// Throws InputError when the sizes differ.
Comparison compare(const Image& a, const Image& b, bool foreground_only);

/// |a - b| on black, amplified so that the largest difference is white; opaque. A difference of
/// alpha is grey.
Image difference_image(const Image& a, const Image& b);

}  // namespace supple

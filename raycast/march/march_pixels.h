// The pixels of a picture, marched in tiles by all threads.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/march/marcher.h"
#include "raycast/pictures/image.h"
#include "volumes/base/progress.h"

namespace supple {

/// Pixels whose column and row are multiples of `spacing`, without those that are there already:
/// multiples of `coarser`, or none where it is 0. 1 is the whole picture.
struct PixelLattice {
  int spacing = 1;
  int coarser = 0;

  bool has(int x, int y) const { return coarser > 0 && x % coarser == 0 && y % coarser == 0; }
};

/// Per pixel of a picture that another one may begin with: if it is there, and where it is opaque.
struct PixelMarks {
  std::vector<std::uint8_t> is_there;  // not to be marched; empty: all are
  std::vector<float> opaque_from_mm;   // Marcher::opaque_from
};

/// Writes these pixels of `picture`, auxiliary channels included where it has them, and where
/// their rays became opaque. Returns the samples read. Throws Cancelled after at most one row of 16
/// pixels per thread.
std::int64_t march_pixels(const RenderContext& context, const Camera& camera,
                          const PixelLattice& lattice, FloatImage& picture, Progress* progress,
                          PixelMarks* marks = nullptr);

}  // namespace supple

// The pixels of a picture, marched in tiles by all threads.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/march/marcher.h"
#include "raycast/pictures/image.h"
#include "volumes/base/progress.h"

namespace supple {

// Blue noise: thresholds without low frequencies, so that neighbouring pixels differ and no pattern
// shows. R. Ulichney, The void-and-cluster method for dither array generation, Proc. SPIE 1913,
// 1993.

/// A threshold, 0 … 1, from a tile of 64×64 pixels that repeats; every multiple of 1/4096 stands
/// once in a tile. The first call makes the tile, some 20 ms.
float blue_noise(int x, int y);

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

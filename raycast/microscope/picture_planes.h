// A picture under way: linear colours and depths of all its pixels, first by one ray each, then by
// four where neighbours differ.
#pragma once

#include <cstdint>
#include <vector>

#include "raycast/microscope/packet_shader.h"

namespace supple {

/// Rows from above, `stride` numbers apart; `stride` and the number of rows are multiples of 4.
struct PicturePlanes {
  int width = 0, height = 0, stride = 0;
  std::vector<float> red, green, blue, depth_mm;
  // Balls before the first surface, where they are kept apart: premultiplied, and their distance.
  bool has_front = false;
  std::vector<float> front_red, front_green, front_blue, front_opacity, front_mm;
  std::vector<std::uint32_t> key;
  TriangleBins seen;

  void resize(int width_, int height_, bool has_front_);
};

struct PassTimes {
  double rays_ms = 0, shadow_ms = 0;
};

/// Shades one ray through the middle of each pixel; times on demand.
void draw_pixels(const EyeScene& scene, PicturePlanes& planes, PassTimes* times);

/// Shades four rays for each pixel that differs from a neighbour in its surface, its shadow or by a
/// step in depth, and takes their mean.
void smooth_edges(const EyeScene& scene, PicturePlanes& planes);

}  // namespace supple

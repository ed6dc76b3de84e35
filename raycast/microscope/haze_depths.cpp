#include "raycast/microscope/haze_depths.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// Depths of the pixels that are next to the middles of those of a small picture: no means, since
/// between surfaces there is nothing.
RayDepths small_depths(const PicturePlanes& planes, int part, bool to_balls) {
  RayDepths depths;
  depths.height = std::max((planes.height + part - 1) / part, 1);
  const double scale = double(depths.height) / planes.height;
  depths.width = std::max(int(std::ceil(planes.width * scale - 1e-9)), 1);
  depths.mm.reserve(std::size_t(depths.width) * depths.height);
  const auto full = [&](int n, int small_size, int size) {
    const double place = (n + 0.5 - small_size / 2.0) / scale + size / 2.0;
    return std::clamp(int(std::floor(place)), 0, size - 1);
  };
  for (int y = 0; y < depths.height; ++y) {
    const std::size_t row = std::size_t(full(y, depths.height, planes.height)) * planes.stride;
    for (int x = 0; x < depths.width; ++x) {
      const std::size_t at = row + full(x, depths.width, planes.width);
      const float surface = planes.depth_mm[at];
      depths.mm.push_back(to_balls ? std::min(surface, planes.front_mm[at]) : surface);
    }
  }
  return depths;
}

FloatImage drawn(HazeLayer& layer, const Camera& camera, const RayDepths& depths) {
  FloatImage picture = layer.draw(camera, depths);
  if (picture.width != depths.width || picture.height != depths.height) {
    throw InputError({"", "picture of a haze layer",
                      std::to_string(picture.width) + " x " + std::to_string(picture.height),
                      std::to_string(depths.width) + " x " + std::to_string(depths.height)});
  }
  return picture;
}

}  // namespace

void draw_haze(HazeLayer& layer, const Camera& camera, const PicturePlanes& planes, int part,
               HazeGrids& grids) {
  const auto draw = [&](bool to_balls, HazeGrid& grid) {
    const RayDepths depths = small_depths(planes, part, to_balls);
    grid.assign(depths, drawn(layer, camera, depths));
  };
  draw(false, grids.to_surface);
  if (planes.has_front) draw(true, grids.to_ball);
}

}  // namespace supple

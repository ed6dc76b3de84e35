// The last step of a picture, sixteen pixels at once: haze that was drawn small is brought to the
// size of the picture and laid over surfaces and balls, then light becomes sRGB bytes by
// 1 - exp(-light), as film takes it. The instruction set is chosen when the program runs.
#pragma once

#include <cstdint>

#include "raycast/microscope/microscope.h"
#include "raycast/microscope/picture_planes.h"

namespace supple {

/// A haze that was drawn small, up to its own depths: planes of a width and height, with a vector's
/// length of numbers behind the last row.
struct HazeGrid {
  int width = 0, height = 0;  // 0: none
  std::vector<float> depth_mm, red, green, blue, opacity;

  void assign(const RayDepths& depths, const FloatImage& picture);
};

struct HazeGrids {
  HazeGrid to_surface;  // up to surfaces
  HazeGrid to_ball;     // up to balls or, where there is none, surfaces
  float start_mm = 0;   // from the camera to the first place that can have haze
};

/// Writes 4 bytes for each pixel of row y. `eyepiece`: dark outside of the largest circle.
void tone_row(const PicturePlanes& planes, const HazeGrids& haze, bool eyepiece, int y,
              std::uint8_t* rgba);

}  // namespace supple

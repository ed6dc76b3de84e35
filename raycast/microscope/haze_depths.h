// Haze that is marched at a part of a picture's width, with the depths of its surfaces.
#pragma once

#include "raycast/microscope/microscope.h"
#include "raycast/microscope/tone_lanes.h"

namespace supple {

/// Small pictures of the haze, and the depths up to which they are drawn.
class DrawnHaze {
 public:
  /// Draws the layer at 1/part of the size; twice where balls are kept apart.
  void draw(HazeLayer& layer, const Camera& camera, const PicturePlanes& planes, int part,
            float start_mm);
  HazeGrids grids() const;

 private:
  RayDepths m_surface_depths, m_ball_depths;
  FloatImage m_to_surface, m_to_ball;
  bool m_has_balls = false;
  float m_start_mm = 0;
};

}  // namespace supple

// Haze that is marched at a part of a picture's width, with the depths of its surfaces.
#pragma once

#include "raycast/microscope/microscope.h"
#include "raycast/microscope/tone_lanes.h"

namespace supple {

/// Draws the layer at 1/part of the size, up to surfaces, and to balls where these are kept apart.
void draw_haze(HazeLayer& layer, const Camera& camera, const PicturePlanes& planes, int part,
               HazeGrids& grids);

}  // namespace supple

// Stereo pairs by off-axis cameras: both eyes look the same way and share one window, which lies in
// the plane through the target. Turning the eyes inwards instead would bring vertical disparity.
// Source: P. Bourke, "Calculating stereo pairs", 1999.
#pragma once

#include "raycast/pictures/image.h"
#include "raycast/scene/camera.h"

namespace supple {

struct StereoCameras {
  Camera left, right;
};

/// The eyes at equal distances from the camera; 0 mm: one thirtieth of the distance to the target.
/// Throws InputError: an orthographic camera, a separation that is negative or not finite.
StereoCameras stereo_cameras(const Camera& camera, double eye_separation_mm = 0);

/// Red and cyan, opaque, on black: the least-squares projection for CRT primaries and red-cyan
/// glasses of E. Dubois, "A projection method to generate anaglyph stereo images", ICASSP 2001, on
/// linear colours; colours outside of the gamut are clipped. Without auxiliary channels.
FloatImage anaglyph(const FloatImage& left, const FloatImage& right);

}  // namespace supple

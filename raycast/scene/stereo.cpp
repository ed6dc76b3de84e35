#include "raycast/scene/stereo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// Eye separation in distances to the target; 1 to 2 degrees of disparity are comfortable.
constexpr double kSeparationShare = 1.0 / 30;

using Matrix = std::array<std::array<float, 3>, 3>;
constexpr Matrix kLeftEye = {{{0.4561f, 0.500484f, 0.176381f},
                              {-0.0400822f, -0.0378246f, -0.0157589f},
                              {-0.0152161f, -0.0205971f, -0.00546856f}}};
constexpr Matrix kRightEye = {{{-0.0434706f, -0.0879388f, -0.00155529f},
                               {0.378476f, 0.73364f, -0.0184503f},
                               {-0.0721527f, -0.112961f, 1.2264f}}};

Camera eye(const Camera& camera, double to_the_right_mm) {
  const Vec3d aside = camera_frame(camera).right * to_the_right_mm;
  const double distance = (camera.target_lps_mm - camera.position_lps_mm).length();
  const double half_height = distance * std::tan(camera.vertical_fov_degrees * kPi / 360);
  Camera moved = camera;
  moved.position_lps_mm += aside;
  moved.target_lps_mm += aside;
  moved.window_shift -= to_the_right_mm / half_height;
  return moved;
}

}  // namespace

StereoCameras stereo_cameras(const Camera& camera, double eye_separation_mm) {
  if (camera.projection == Projection::orthographic) {
    throw InputError({"", "stereo", "an orthographic camera", "a perspective one"});
  }
  if (!(eye_separation_mm >= 0 && std::isfinite(eye_separation_mm))) {
    throw InputError({"", "eye separation", number_text(eye_separation_mm), "0 mm or more"});
  }
  if (eye_separation_mm == 0) {
    eye_separation_mm = kSeparationShare * (camera.target_lps_mm - camera.position_lps_mm).length();
  }
  return {eye(camera, -eye_separation_mm / 2), eye(camera, eye_separation_mm / 2)};
}

FloatImage anaglyph(const FloatImage& left, const FloatImage& right) {
  FloatImage both(left.width, left.height);
  both.has_alpha = false;
  for (std::size_t n = 0; n < both.rgba.size(); n += 4) {
    std::array<float, 3> l{}, r{};
    for (std::size_t c = 0; c < 3; ++c) {
      l[c] = linear_from_srgb(std::clamp(left.rgba[n + c], 0.0f, 1.0f));
      r[c] = linear_from_srgb(std::clamp(right.rgba[n + c], 0.0f, 1.0f));
    }
    for (std::size_t c = 0; c < 3; ++c) {
      float sum = 0;
      for (std::size_t k = 0; k < 3; ++k) sum += kLeftEye[c][k] * l[k] + kRightEye[c][k] * r[k];
      both.rgba[n + c] = srgb_from_linear(std::clamp(sum, 0.0f, 1.0f));
    }
    both.rgba[n + 3] = 1;
  }
  return both;
}

}  // namespace supple

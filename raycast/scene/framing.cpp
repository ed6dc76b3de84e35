#include "raycast/scene/framing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {

namespace {

constexpr int kAroundAxis = 24;  // places of a point on its circle
constexpr double kLeastHeight_mm = 1;
constexpr double kFullTurn = 6.283185307179586;

struct Extent {
  double lo = std::numeric_limits<double>::infinity();
  double hi = -std::numeric_limits<double>::infinity();

  void add(double value) {
    lo = std::min(lo, value);
    hi = std::max(hi, value);
  }
  double middle() const { return (lo + hi) / 2; }
  double length() const { return hi - lo; }
};

/// Place that points need of a camera of one direction. With r, u, f along right, up and forward a
/// perspective camera at (cr, cu, cf) sees a point between its sides, of tangents t to the left and
/// s to the right, where -t (f - cf) <= r - cr <= s (f - cf), that is r - s f <= cr - s cf and
/// cr + t cf <= r + t f; so with A the largest r - s f and B the least r + t f it may go as far as
/// cf = (B - A) / (t + s), at cr = (A + B + (s - t) cf) / 2.
class PointsInView {
 public:
  PointsInView(const Camera& camera, double aspect, const FramingMargins& margins)
      : m_camera(camera), m_frame(camera_frame(camera)), m_aspect(aspect) {
    const double half = half_height_at_unit_distance(camera);
    m_margin = {{{margins.left, margins.right}, {margins.bottom, margins.top}}};
    for (std::size_t a = 0; a < 2; ++a) {
      for (std::size_t side = 0; side < 2; ++side) {
        m_tan[a][side] = (1 - 2 * m_margin[a][side]) * half * (a == 0 ? aspect : 1);
      }
    }
  }

  void add(const Vec3d& point) {
    const double across[2] = {point.dot(m_frame.right), point.dot(m_frame.up)};
    const double f = point.dot(m_frame.forward);
    for (std::size_t a = 0; a < 2; ++a) {
      m_across[a].add(across[a]);
      m_low_side[a] = std::max(m_low_side[a], across[a] - m_tan[a][1] * f);
      m_high_side[a] = std::min(m_high_side[a], across[a] + m_tan[a][0] * f);
    }
    m_depth.add(f);
  }

  Camera camera() const {
    Camera framing = m_camera;
    framing.window_shift = 0;
    double place[2] = {m_across[0].middle(), m_across[1].middle()};
    double back = 0;
    if (m_camera.projection == Projection::perspective) {
      back = m_depth.lo - kLeastHeight_mm;
      for (std::size_t a = 0; a < 2; ++a) {
        back = std::min(back, (m_high_side[a] - m_low_side[a]) / (m_tan[a][0] + m_tan[a][1]));
      }
      for (std::size_t a = 0; a < 2; ++a) {
        place[a] = (m_low_side[a] + m_high_side[a] + (m_tan[a][1] - m_tan[a][0]) * back) / 2;
      }
    } else {
      framing.height_mm = std::max({m_across[1].length() / used(1),
                                    m_across[0].length() / m_aspect / used(0), kLeastHeight_mm});
      for (std::size_t a = 0; a < 2; ++a) {
        const double size = framing.height_mm * (a == 0 ? m_aspect : 1);
        place[a] += (m_margin[a][1] - m_margin[a][0]) / 2 * size;
      }
      back = m_depth.middle() - m_depth.length() - framing.height_mm / 2;
    }
    const Vec3d aside = m_frame.right * place[0] + m_frame.up * place[1];
    framing.position_lps_mm = aside + m_frame.forward * back;
    framing.target_lps_mm = aside + m_frame.forward * m_depth.middle();
    return framing;
  }

 private:
  static constexpr double kEndless = std::numeric_limits<double>::infinity();

  double used(std::size_t a) const { return 1 - (m_margin[a][0] + m_margin[a][1]); }

  Camera m_camera;
  CameraFrame m_frame;
  double m_aspect;
  // By axis, then its low and high side.
  std::array<std::array<double, 2>, 2> m_margin, m_tan;
  std::array<Extent, 2> m_across;
  Extent m_depth;
  std::array<double, 2> m_low_side = {-kEndless, -kEndless}, m_high_side = {kEndless, kEndless};
};

/// Frames every point on its circle about the axis. A circle's places lie mirrored to the view, so
/// that the camera's central ray meets the axis.
Camera framed_turntable(const Camera& camera, double aspect, const std::vector<Vec3d>& points,
                        const FramingMargins& margins) {
  Extent x, y;
  for (const Vec3d& point : points) {
    x.add(point.x);
    y.add(point.y);
  }
  const Vec3d axis(x.middle(), y.middle(), 0), superior(0, 0, 1);
  const CameraFrame frame = camera_frame(camera);
  const Vec3d level = Vec3d(frame.right.x, frame.right.y, 0);
  const Vec3d first = level.length() > 1e-9 ? level.normalized() : Vec3d(1, 0, 0);
  const Vec3d second = superior.cross(first);
  const double sides = std::max(margins.left, margins.right);
  const double ends = std::max(margins.top, margins.bottom);
  PointsInView view(camera, aspect, {sides, sides, ends, ends});
  for (const Vec3d& point : points) {
    // The corners of a polygon about the circle.
    const double radius =
        std::hypot(point.x - axis.x, point.y - axis.y) / std::cos(kFullTurn / 2 / kAroundAxis);
    for (int n = 0; n < kAroundAxis; ++n) {
      const double angle = kFullTurn * n / kAroundAxis;
      view.add(axis + first * (radius * std::cos(angle)) + second * (radius * std::sin(angle)) +
               superior * point.z);
    }
  }
  Camera turning = view.camera();
  // The point of the central ray on the axis, but for views along it.
  const Vec3d from_axis = axis - turning.position_lps_mm;
  const Vec3d forward(frame.forward.x, frame.forward.y, 0);
  if (forward.length() > 1e-6) {
    const double along = (from_axis.x * forward.x + from_axis.y * forward.y) / forward.dot(forward);
    turning.target_lps_mm = turning.position_lps_mm + frame.forward * along;
  }
  return turning;
}

}  // namespace

Camera framed(const Camera& camera, double aspect, const std::vector<Vec3d>& points_lps_mm,
              CameraMotion motion, const FramingMargins& margins) {
  if (points_lps_mm.empty()) return camera;
  if (motion == CameraMotion::turntable) {
    return framed_turntable(camera, aspect, points_lps_mm, margins);
  }
  PointsInView view(camera, aspect, margins);
  for (const Vec3d& point : points_lps_mm) view.add(point);
  return view.camera();
}

Camera turned_about_target(const Camera& camera, double share) {
  const double c = std::cos(kFullTurn * share), s = std::sin(kFullTurn * share);
  const auto turned = [&](const Vec3d& v) {
    return Vec3d(c * v.x - s * v.y, s * v.x + c * v.y, v.z);
  };
  Camera around = camera;
  around.position_lps_mm =
      camera.target_lps_mm + turned(camera.position_lps_mm - camera.target_lps_mm);
  around.up_lps = turned(camera.up_lps);
  return around;
}

}  // namespace supple

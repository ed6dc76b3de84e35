// Bend, twist and taper: Barr's deformations along an axis, with their inverses in closed form.
#include <algorithm>

#include "volumes/base/error.h"
#include "volumes/field/paths/path_checks.h"
#include "volumes/field/paths/path_functions.h"

namespace supple {

namespace {

AxisRange checked(AxisRange range) {
  require_finite("point", range.point);
  range.axis = unit_of("axis", range.axis);
  require_path(range.begin_mm < range.end_mm && std::isfinite(range.end_mm - range.begin_mm),
               "range", number_text(range.begin_mm) + "," + number_text(range.end_mm),
               "two numbers in mm, the lower one first");
  return range;
}

double along(const AxisRange& range, const Vec3d& p) {
  return (p - range.point).dot(range.axis);
}

/// Share of the range that lies before p: 0 before the range, 1 beyond.
double share(const AxisRange& range, const Vec3d& p) {
  const double t = (along(range, p) - range.begin_mm) / (range.end_mm - range.begin_mm);
  return std::clamp(t, 0.0, 1.0);
}

class Twist : public PathFunction {
 public:
  explicit Twist(const TwistParams& params)
      : m_range(checked(params.range)), m_angle(params.angle_degrees * kRadiansPerDegree) {}
  Vec3d forward(const Vec3d& from, int) const override { return turned(from, m_angle); }
  Vec3d backward(const Vec3d& at, int) const override { return turned(at, -m_angle); }

 private:
  /// Places along the axis stay, so that the inverse is the turn back (eq. 3.21).
  Vec3d turned(const Vec3d& p, double angle) const {
    const double t = share(m_range, p);
    return t > 0 ? m_range.point + rotated(p - m_range.point, m_range.axis, angle * t) : p;
  }

  AxisRange m_range;
  double m_angle;
};

class Taper : public PathFunction {
 public:
  explicit Taper(const TaperParams& params)
      : m_range(checked(params.range)), m_factor(params.factor) {}
  Vec3d forward(const Vec3d& from, int) const override { return scaled(from, scale_at(from)); }
  Vec3d backward(const Vec3d& at, int) const override { return scaled(at, 1 / scale_at(at)); }

 private:
  double scale_at(const Vec3d& p) const { return 1 + (m_factor - 1) * share(m_range, p); }
  Vec3d scaled(const Vec3d& p, double scale) const {
    const Vec3d across = p - m_range.point - m_range.axis * along(m_range, p);
    return p + across * (scale - 1);
  }

  AxisRange m_range;
  double m_factor;
};

/// Bends in the plane of axis (s) and direction (r): the arc's centre is at s = begin, r = R.
class Bend : public PathFunction {
 public:
  explicit Bend(const BendParams& params)
      : m_range(checked(params.range)),
        m_towards(unit_across("towards", params.towards, m_range.axis,
                              "a direction that is not that of the axis")),
        m_angle(std::abs(params.angle_degrees) * kRadiansPerDegree),
        m_radius((m_range.end_mm - m_range.begin_mm) / m_angle) {
    if (params.angle_degrees < 0) m_towards = -m_towards;
  }

  Vec3d forward(const Vec3d& from, int) const override {
    const Vec3d d = from - m_range.point;
    const double s = d.dot(m_range.axis) - m_range.begin_mm, inner = m_radius - d.dot(m_towards);
    if (s <= 0 && !(curls_back() && inner <= 0)) return from;
    if (inner <= 0) {
      throw InputError({"", "bend",
                        "material " + number_text(m_radius - inner) +
                            " mm towards the inside of a curve of radius " + number_text(m_radius) +
                            " mm",
                        "a longer range, a smaller angle or a point further inside"});
    }
    // Along the arc, then along its end.
    const double theta = std::clamp(s / m_radius, 0.0, m_angle);
    const double beyond = s - theta * m_radius;
    return placed(from, inner * std::sin(theta) + beyond * std::cos(theta),
                  inner * std::cos(theta) - beyond * std::sin(theta));
  }

  Vec3d backward(const Vec3d& at, int) const override {
    const Vec3d d = at - m_range.point;
    const double s = d.dot(m_range.axis) - m_range.begin_mm, inner = m_radius - d.dot(m_towards);
    if (s <= 0 && !(curls_back() && inner < 0)) return at;
    double phi = std::atan2(s, inner);
    if (phi < 0) phi += 2 * kHalfTurn;
    if (phi <= m_angle) return placed(at, phi * m_radius, std::hypot(s, inner));
    const double c = std::cos(m_angle), sine = std::sin(m_angle);
    return placed(at, m_angle * m_radius + s * c - inner * sine, s * sine + inner * c);
  }

 private:
  static constexpr double kHalfTurn = 180 * kRadiansPerDegree;

  /// Beyond a quarter of a turn the far end can come back beside what stays.
  bool curls_back() const { return m_angle > kHalfTurn / 2; }
  /// Moved in the plane of the arc to a place along the axis and a distance from the centre.
  Vec3d placed(const Vec3d& p, double s, double inner) const {
    const Vec3d d = p - m_range.point;
    const Vec3d aside = d - m_range.axis * d.dot(m_range.axis) - m_towards * d.dot(m_towards);
    return m_range.point + aside + m_range.axis * (m_range.begin_mm + s) +
           m_towards * (m_radius - inner);
  }

  AxisRange m_range;
  Vec3d m_towards;
  double m_angle, m_radius;
};

}  // namespace

std::shared_ptr<const PathFunction> make_bend(const BendParams& params) {
  checked(params.range);
  require_between("angle", params.angle_degrees, -180, 180, "degrees");
  if (params.angle_degrees == 0) return nullptr;
  return std::make_shared<Bend>(params);
}

std::shared_ptr<const PathFunction> make_twist(const TwistParams& params) {
  checked(params.range);
  require_between("angle", params.angle_degrees, -36000, 36000, "degrees");
  if (params.angle_degrees == 0) return nullptr;
  return std::make_shared<Twist>(params);
}

std::shared_ptr<const PathFunction> make_taper(const TaperParams& params) {
  checked(params.range);
  require_between("factor", params.factor, 0.01, 100, "");
  if (params.factor == 1) return nullptr;
  return std::make_shared<Taper>(params);
}

void span_box(const Geometry& geometry, AxisRange& range) {
  range.begin_mm = HUGE_VAL;
  range.end_mm = -HUGE_VAL;
  const Vec3d axis = unit_of("axis", range.axis);
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d index(-0.5);
    for (int a = 0; a < 3; ++a) index[a] += (corner >> a & 1) * geometry.dims()[a];
    const double s = (geometry.world_from_index(index) - range.point).dot(axis);
    range.begin_mm = std::min(range.begin_mm, s);
    range.end_mm = std::max(range.end_mm, s);
  }
}

}  // namespace supple

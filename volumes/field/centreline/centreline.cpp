#include "volumes/field/centreline/centreline.h"

#include <array>
#include <string>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

constexpr int kSamplesPerSegment = 32;
constexpr double kSamePlace = 1e-9;  // of the distance between the farthest neighbours

Vec3d reflected(const Vec3d& v, const Vec3d& normal) {
  const double square = normal.dot(normal);
  return square > 0 ? v - normal * (2 * v.dot(normal) / square) : v;
}

/// The part of v across a unit vector, at length 1; 0 where there is none.
Vec3d part_across(const Vec3d& v, const Vec3d& unit) {
  const Vec3d across = v - unit * v.dot(unit);
  return across.length() > 1e-6 * v.length() ? across.normalized() : Vec3d(0);
}

CurveFrame frame_of(const Vec3d& at, const Vec3d& along, const Vec3d& up) {
  const Vec3d across = part_across(up, along);
  return {at, along, across.cross(along), across};
}

}  // namespace

Centreline::Centreline(const std::vector<Vec3d>& points, const std::optional<Vec3d>& up)
    : m_points(points) {
  if (points.size() < 2) {
    throw InputError({"", "points", with_count(std::int64_t(points.size()), "point"),
                      "two or more, in their order along the curve"});
  }
  if (!std::all_of(points.begin(), points.end(), is_finite)) {
    throw InputError({"", "points", "one that is not finite", "places in LPS mm"});
  }
  double longest = 0;
  for (std::size_t n = 1; n < points.size(); ++n) {
    longest = std::max(longest, (points[n] - points[n - 1]).length());
  }
  m_knots.push_back(0);
  for (std::size_t n = 1; n < points.size(); ++n) {
    const double chord = (points[n] - points[n - 1]).length();
    if (!(chord > kSamePlace * longest)) {
      throw InputError(
          {"", "points",
           "numbers " + std::to_string(n) + " and " + std::to_string(n + 1) + " at one place",
           "neighbours apart from each other"});
    }
    m_knots.push_back(m_knots.back() + chord);
  }
  find_slopes();
  sample_lengths();
  set_frames(up);
}

/// Slopes at the points so that second derivatives have no jump, and third derivatives none at the
/// second and the last but one: a tridiagonal system.
void Centreline::find_slopes() {
  const std::size_t count = m_points.size();
  const auto step = [&](std::size_t n) { return m_knots[n + 1] - m_knots[n]; };
  const auto secant = [&](std::size_t n) { return (m_points[n + 1] - m_points[n]) / step(n); };
  if (count == 2) {
    m_slopes.assign(2, secant(0));
    return;
  }
  if (count == 3) {  // one parabola
    const Vec3d bend = (secant(1) - secant(0)) / (m_knots[2] - m_knots[0]);
    m_slopes = {secant(0) - bend * step(0), secant(0) + bend * step(0), secant(1) + bend * step(1)};
    return;
  }
  std::vector<double> below(count, 0), middle(count), above(count, 0);
  std::vector<Vec3d> right(count);
  const auto end_row = [&](std::size_t row, double& beside, double near, double far,
                           const Vec3d& near_secant, const Vec3d& far_secant) {
    const double both = near + far;
    middle[row] = far;
    beside = both;
    right[row] = (near_secant * ((near + 2 * both) * far) + far_secant * (near * near)) / both;
  };
  end_row(0, above[0], step(0), step(1), secant(0), secant(1));
  end_row(count - 1, below[count - 1], step(count - 2), step(count - 3), secant(count - 2),
          secant(count - 3));
  for (std::size_t n = 1; n + 1 < count; ++n) {
    below[n] = step(n);
    middle[n] = 2 * (step(n - 1) + step(n));
    above[n] = step(n - 1);
    right[n] = (secant(n - 1) * step(n) + secant(n) * step(n - 1)) * 3.0;
  }
  for (std::size_t n = 1; n < count; ++n) {
    const double part = below[n] / middle[n - 1];
    middle[n] -= part * above[n - 1];
    right[n] -= right[n - 1] * part;
  }
  m_slopes.resize(count);
  m_slopes[count - 1] = right[count - 1] / middle[count - 1];
  for (std::size_t n = count - 1; n-- > 0;) {
    m_slopes[n] = (right[n] - m_slopes[n + 1] * above[n]) / middle[n];
  }
}

Centreline::Derivatives Centreline::derivatives(double t) const {
  const auto above = std::upper_bound(m_knots.begin() + 1, m_knots.end() - 1, t);
  const auto n = std::size_t(above - m_knots.begin()) - 1;
  const double step = m_knots[n + 1] - m_knots[n], x = t - m_knots[n];
  const Vec3d secant = (m_points[n + 1] - m_points[n]) / step;
  // c(x) = p + x m0 + x^2 b + x^3 a
  const Vec3d b = (secant * 3.0 - m_slopes[n] * 2.0 - m_slopes[n + 1]) / step;
  const Vec3d a = (m_slopes[n] + m_slopes[n + 1] - secant * 2.0) / (step * step);
  return {m_points[n] + (m_slopes[n] + (b + a * x) * x) * x,
          m_slopes[n] + (b * 2.0 + a * (3 * x)) * x, b * 2.0 + a * (6 * x)};
}

/// Gauss and Legendre's five points.
double Centreline::length_between(double t_a, double t_b) const {
  constexpr std::array<double, 5> kAt = {-0.9061798459386640, -0.5384693101056831, 0,
                                         0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 5> kWeight = {0.2369268850561891, 0.4786286704993665,
                                             0.5688888888888889, 0.4786286704993665,
                                             0.2369268850561891};
  const double middle = (t_a + t_b) / 2, half = (t_b - t_a) / 2;
  double sum = 0;
  for (std::size_t n = 0; n < kAt.size(); ++n) {
    sum += kWeight[n] * derivatives(middle + half * kAt[n]).first.length();
  }
  return sum * half;
}

void Centreline::sample_lengths() {
  m_samples.push_back({0, 0});
  for (std::size_t n = 0; n + 1 < m_knots.size(); ++n) {
    for (int part = 1; part <= kSamplesPerSegment; ++part) {
      const double t =
          m_knots[n] + (m_knots[n + 1] - m_knots[n]) * (double(part) / kSamplesPerSegment);
      const Sample& last = m_samples.back();
      m_samples.push_back({t, last.length + length_between(last.t, t)});
    }
  }
}

/// The frames of all samples, from the middle to both ends.
void Centreline::set_frames(const std::optional<Vec3d>& up) {
  std::size_t middle = 0;
  const double half = length_mm() / 2, t = parameter(half, middle);
  if (m_samples[middle].length < half) ++middle;
  if (m_samples[middle].length > half) {
    m_samples.insert(m_samples.begin() + std::ptrdiff_t(middle), {t, half});
  }
  const Derivatives there = derivatives(t);
  const Vec3d along = there.first.normalized(), superior(0, 0, 1), anterior(0, -1, 0);
  const bool runs_up = std::abs(along.z) > std::sqrt(0.5);
  const Vec3d wanted = up.value_or(runs_up ? anterior : superior);
  if (part_across(wanted, along) == Vec3d(0)) {
    throw InputError({"", "up", "a direction along the middle of the curve", "one across it"});
  }
  m_samples[middle].frame = frame_of(there.at, along, wanted);
  for (std::size_t n = middle + 1; n < m_samples.size(); ++n) {
    m_samples[n].frame = led_on(m_samples[n - 1].frame, m_samples[n].t);
  }
  for (std::size_t n = middle; n-- > 0;) {
    m_samples[n].frame = led_on(m_samples[n + 1].frame, m_samples[n].t);
  }
}

/// The frame at t by two reflections of one nearby (Wang et al., table I).
CurveFrame Centreline::led_on(const CurveFrame& from, double t) const {
  const Derivatives there = derivatives(t);
  const Vec3d along = there.first.normalized(), chord = there.at - from.at;
  const Vec3d up = reflected(from.up, chord), tangent = reflected(from.along, chord);
  return frame_of(there.at, along, reflected(up, along - tangent));
}

/// The parameter at a length within the curve, and the sample at or before it.
double Centreline::parameter(double length_mm, std::size_t& sample) const {
  const auto above =
      std::upper_bound(m_samples.begin() + 1, m_samples.end() - 1, length_mm,
                       [](double length, const Sample& other) { return length < other.length; });
  sample = std::size_t(above - m_samples.begin()) - 1;
  const Sample& low = m_samples[sample];
  const Sample& high = m_samples[sample + 1];
  double t = low.t + (high.t - low.t) * (length_mm - low.length) / (high.length - low.length);
  for (int step = 0; step < 4; ++step) {
    const double missing = length_mm - low.length - length_between(low.t, t);
    t = std::clamp(t + missing / derivatives(t).first.length(), low.t, high.t);
  }
  return t;
}

CurveFrame Centreline::frame(double length_mm) const {
  const double within = std::clamp(length_mm, 0.0, this->length_mm());
  std::size_t sample = 0;
  const double t = parameter(within, sample);
  CurveFrame found = led_on(m_samples[sample].frame, t);
  found.at += found.along * (length_mm - within);
  return found;
}

Vec3d Centreline::curvature(double length_mm) const {
  if (length_mm < 0 || length_mm > this->length_mm()) return Vec3d(0);
  std::size_t sample = 0;
  const Derivatives there = derivatives(parameter(length_mm, sample));
  const Vec3d along = there.first.normalized();
  const Vec3d across = there.second - along * there.second.dot(along);
  return across / there.first.dot(there.first);
}

std::vector<double> Centreline::sampled_lengths() const {
  std::vector<double> lengths;
  for (const Sample& sample : m_samples) lengths.push_back(sample.length);
  return lengths;
}

}  // namespace supple

#include "raycast/sample/classify.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supple {

namespace {

constexpr double kMostOpaque = 1 - 1e-9;  // what lets nothing through has no extinction
constexpr float kGuardCodes = 0.05f;      // covers the rounding of interpolated densities

/// Densities from the first key point to the last: the function is constant beyond.
std::pair<double, double> domain_of(const TransferFunction& f) {
  return {std::min(f.opacity.front().density, f.colour.front().density),
          std::max(f.opacity.back().density, f.colour.back().density)};
}

}  // namespace

double corrected_opacity(double opacity, double step_mm, double unit_distance_mm) {
  return 1 - std::pow(1 - opacity, step_mm / unit_distance_mm);
}

Classifier::Classifier(const TransferFunction& function, const SourceBricks& source, double step_mm)
    : m_function(function), m_step_mm(step_mm) {
  const auto [first, last] = domain_of(function);
  const double first_code = source.encoded(first), last_code = source.encoded(last);
  m_lo = float(first_code);
  m_entries_per_code = last > first ? float((kEntries - 1) / (last_code - first_code)) : 0;
  const bool per_step = function.blend == Blend::composite && !has_gradient_opacity();
  m_table.resize(kEntries + 1);
  m_visible_before.assign(kEntries + 2, 0);
  for (int n = 0; n <= kEntries; ++n) {
    const double along = double(std::min(n, kEntries - 1)) / (kEntries - 1);
    const double density = first + along * (last - first);
    const auto rgb = function.colour_at(density);
    const double opacity = function.opacity_at(density);
    const double alpha =
        per_step ? corrected_opacity(opacity, step_mm, function.unit_distance_mm) : opacity;
    m_table[n] = Float4{float(rgb[0]), float(rgb[1]), float(rgb[2]), float(alpha)};
    m_visible_before[n + 1] = m_visible_before[n] + (m_table[n][3] > 0 ? 1 : 0);
  }
  m_integrals.resize(kEntries);
  Integral sum;
  for (int n = 0; n < kEntries; ++n) {
    // The trapezoidal rule, half an entry on either side.
    const double density = first + double(n) / (kEntries - 1) * (last - first);
    const double opacity = std::min(function.opacity_at(density), kMostOpaque);
    const double half = -0.5 * std::log1p(-opacity) / function.unit_distance_mm;
    const auto add_half = [&] {
      sum.extinction += half;
      for (int c = 0; c < 3; ++c) sum.colour[c] += half * double(m_table[n][c]);
    };
    if (n > 0) add_half();
    m_integrals[n] = sum;
    add_half();
  }
  find_visible_intervals();
}

void Classifier::find_visible_intervals() {
  m_visible_bits.assign(kEntries / 32, 0);
  int count = 0;
  for (int n = 0; n < kEntries; ++n) {
    if (!(m_table[n][3] > 0 || m_table[n + 1][3] > 0)) continue;
    m_visible_bits[n >> 5] |= std::int32_t(1u << (n & 31));
    if (count++ == 0) m_first_visible = n;
    m_last_visible = n;
  }
  if (count == m_last_visible - m_first_visible + 1) m_visible_bits.clear();
}

/// The integral up to an entry; beyond its ends the function is constant.
Classifier::Integral Classifier::integral_at(double entry) const {
  const int last = kEntries - 1;
  const int n = std::clamp(int(std::floor(entry)), 0, last - 1);
  const Integral &low = m_integrals[n], &high = m_integrals[n + 1];
  if (entry >= 0 && entry <= last) {
    const double t = entry - n;
    Integral result;
    result.extinction = low.extinction + t * (high.extinction - low.extinction);
    for (int c = 0; c < 3; ++c) {
      result.colour[c] = low.colour[c] + t * (high.colour[c] - low.colour[c]);
    }
    return result;
  }
  const Float4& end = entry < 0 ? m_table.front() : m_table[last];
  const double beyond = entry < 0 ? entry : entry - last;
  const double opacity =
      entry < 0 ? m_function.opacity.front().opacity : m_function.opacity.back().opacity;
  const double extinction =
      -std::log1p(-std::min(opacity, kMostOpaque)) / m_function.unit_distance_mm;
  Integral result = entry < 0 ? m_integrals.front() : m_integrals.back();
  result.extinction += beyond * extinction;
  for (int c = 0; c < 3; ++c) result.colour[c] += beyond * extinction * double(end[c]);
  return result;
}

Float4 Classifier::integrate(float front, float back) const {
  const double from = double(front - m_lo) * m_entries_per_code;
  const double to = double(back - m_lo) * m_entries_per_code;
  if (std::abs(to - from) < 1) return classify(0.5f * (front + back));
  const Integral a = integral_at(from), b = integral_at(to);
  const double extinction = b.extinction - a.extinction;
  Float4 result = {0, 0, 0, float(-std::expm1(-m_step_mm * extinction / (to - from)))};
  if (extinction == 0) return result;
  for (int c = 0; c < 3; ++c) result[c] = float((b.colour[c] - a.colour[c]) / extinction);
  return result;
}

float Classifier::with_gradient(float opacity, float gradient_per_mm) const {
  const double share = m_function.gradient_opacity_at(gradient_per_mm);
  return float(corrected_opacity(opacity * share, m_step_mm, m_function.unit_distance_mm));
}

bool Classifier::may_be_visible(const EncodedRange& range) const {
  if (range.empty()) return false;
  const auto entry = [&](float encoded) {
    return std::clamp((encoded - m_lo) * m_entries_per_code, 0.0f, float(kEntries - 1));
  };
  // A transparent density hides the smaller ones from a maximum.
  const bool hides = m_function.blend == Blend::maximum;
  const int first = hides ? 0 : int(std::floor(entry(range.lo - kGuardCodes)));
  const int last = int(std::ceil(entry(range.hi + kGuardCodes)));
  return m_visible_before[last + 1] > m_visible_before[first];
}

}  // namespace supple

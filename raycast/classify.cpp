#include "raycast/classify.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

constexpr int kEntries = 4096;
constexpr float kGuardEntries = 0.01f;  // covers the rounding of interpolated densities

}  // namespace

double corrected_opacity(double opacity, double step_mm, double unit_distance_mm) {
  return 1 - std::pow(1 - opacity, step_mm / unit_distance_mm);
}

Classifier::Classifier(const TransferFunction& function, const SourceBricks& source, double step_mm)
    : m_function(function), m_step_mm(step_mm) {
  const EncodedRange range = source.range().empty() ? EncodedRange{0, 0} : source.range();
  m_lo = range.lo;
  m_entries_per_code = range.hi > range.lo ? float(kEntries - 1) / (range.hi - range.lo) : 0;
  m_table.resize(kEntries + 1);
  m_visible_before.assign(kEntries + 2, 0);
  for (int n = 0; n <= kEntries; ++n) {
    const double along = double(std::min(n, kEntries - 1)) / (kEntries - 1);
    const double density = source.density(range.lo + along * double(range.hi - range.lo));
    const auto rgb = function.colour_at(density);
    const double opacity = function.opacity_at(density);
    const double alpha = has_gradient_opacity()
                             ? opacity
                             : corrected_opacity(opacity, step_mm, function.unit_distance_mm);
    m_table[n] = Float4{float(rgb[0]), float(rgb[1]), float(rgb[2]), float(alpha)};
    m_visible_before[n + 1] = m_visible_before[n] + (m_table[n][3] > 0 ? 1 : 0);
  }
}

Float4 Classifier::classify(float encoded) const {
  const float entry = std::clamp((encoded - m_lo) * m_entries_per_code, 0.0f, float(kEntries - 1));
  const int n = int(entry);
  return m_table[n] + (entry - float(n)) * (m_table[n + 1] - m_table[n]);
}

float Classifier::with_gradient(float opacity, float gradient_per_mm) const {
  const double share = m_function.gradient_opacity_at(gradient_per_mm);
  return float(corrected_opacity(opacity * share, m_step_mm, m_function.unit_distance_mm));
}

bool Classifier::may_be_visible(const EncodedRange& range) const {
  if (range.empty()) return false;
  const auto entry = [&](float encoded) { return (encoded - m_lo) * m_entries_per_code; };
  const int first = std::clamp(int(std::floor(entry(range.lo) - kGuardEntries)), 0, kEntries);
  const int last = std::clamp(int(std::ceil(entry(range.hi) + kGuardEntries)), 0, kEntries);
  return m_visible_before[last + 1] > m_visible_before[first];
}

}  // namespace supple

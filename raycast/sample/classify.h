// Post-classification: the transfer function as a fine table between its first and last key point,
// opacities corrected for the step: alpha = 1 - (1 - a)^(step / unit distance). The table does not
// depend on the densities of the source, so that a part of a volume looks like the whole.
// Cost: 160 kB; 8192 entries, linear between them.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "raycast/sample/offset_bricks.h"
#include "raycast/scene/transfer_function.h"

namespace supple {

/// Opacity of one step when `opacity` is reached over `unit_distance_mm`.
double corrected_opacity(double opacity, double step_mm, double unit_distance_mm);

class Classifier {
 public:
  Classifier(const TransferFunction& function, const SourceBricks& source, double step_mm);

  /// Red, green, blue, and the opacity of one step (with gradient opacity: of the unit distance;
  /// maximum: of the ray).
  Float4 classify(float encoded) const {
    const float last = last_entry();
    const float entry = std::clamp((encoded - m_lo) * m_entries_per_code, 0.0f, last);
    const int n = int(entry);
    return m_table[n] + (entry - float(n)) * (m_table[n + 1] - m_table[n]);
  }
  /// Red, green, blue and opacity of a step along which the density goes linearly from one code to
  /// another: opacity by the integral of the extinction, colour its mean weighted by extinction,
  /// without the part of the step that it hides itself (after K. Engel, M. Kraus, T. Ertl,
  /// High-quality pre-integrated volume rendering, Graphics Hardware 2001). Not with gradient
  /// opacity.
  Float4 integrate(float front, float back) const;
  /// Opacity of one step with the gradient's share (density per mm).
  float with_gradient(float opacity, float gradient_per_mm) const;
  bool has_gradient_opacity() const { return !m_function.gradient_opacity.empty(); }

  /// Place of an encoded density in the table: (encoded - first_code) * entries_per_code, held
  /// between 0 and last_entry.
  float first_code() const { return m_lo; }
  float entries_per_code() const { return m_entries_per_code; }
  static constexpr float last_entry() { return float(kEntries - 1); }
  /// Intervals between neighbouring entries that are not both transparent: the first and the last.
  std::int32_t first_visible() const { return m_first_visible; }
  std::int32_t last_visible() const { return m_last_visible; }
  /// Bits of the intervals between: bit n & 31 of word n >> 5; null when all of them are visible.
  const std::int32_t* visible_bits() const {
    return m_visible_bits.empty() ? nullptr : m_visible_bits.data();
  }

  /// False only when every density of the range is transparent; maximum: and none hides another.
  bool may_be_visible(const EncodedRange& range) const;

 private:
  static constexpr int kEntries = 8192;

  TransferFunction m_function;
  double m_step_mm;
  float m_lo = 0, m_entries_per_code = 0;
  /// Extinction (per mm) and colour times extinction, added up from the first entry on.
  struct Integral {
    double extinction = 0;
    std::array<double, 3> colour{};
  };
  Integral integral_at(double entry) const;
  void find_visible_intervals();

  std::vector<Float4> m_table;
  std::vector<Integral> m_integrals;
  std::int32_t m_first_visible = 0, m_last_visible = -1;
  std::vector<std::int32_t> m_visible_bits;
  std::vector<std::uint32_t> m_visible_before;  // entries with opacity > 0 before this one
};

}  // namespace supple

// Look-up tables from density to link limits (thesis section 4.2.3, figure 4.11; design.md
// section 2). Densities become 256 classes; a link looks its limits up at the mean of both ends,
// half classes kept.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// Piecewise linear through (density, value) key points; constant beyond them.
struct Curve {
  std::vector<std::pair<double, double>> keys;
  double operator()(double density) const;
};

enum class Combine { density, limits };

/// The table as the user wrote it. Lengths are factors of the rest length.
struct MaterialTable {
  double domain_lo = 0, domain_hi = 255;  // densities spanned by the 256 classes
  double active_lo = 1, active_hi = 255;  // densities that are elements
  Curve max_length, min_length, shear1, shear2;
  /// Overrides for one grid axis, e.g. max_length_i (figure 4.7).
  std::array<std::optional<Curve>, 3> max_length_axis, min_length_axis;
  Combine combine = Combine::density;
  int components = 0;  // 0: all pieces; n: the n largest ("largest" is 1)

  /// Throws InputError naming table, key point, value and expectation: 0 < min_length <= 1 <=
  /// max_length, shear >= 0, densities strictly ascending and inside the domain, lo < hi.
  void validate(const std::string& file) const;
  /// One line per pair of key points that fall into the same class; empty when none do.
  std::vector<std::string> warnings() const;

  /// round(255 * (clamp(v) - domain_lo) / (domain_hi - domain_lo)).
  std::uint8_t class_of(double density) const;
};

/// Limits of one link, mm per mm of rest length.
struct LinkLimits {
  double min_length, max_length, shear1, shear2;
};
LinkLimits limits_of(const MaterialTable& table, int axis, int class_a, int class_b);

/// Integer slack of a link a -> b in the positive direction of `axis`, per coordinate c:
///   q_b[c] - q_a[c] <= upper[c]   and   q_a[c] - q_b[c] <= lower[c],
/// in 2^-16 voxel, rounded down, clamped to [0, 2^30] (2^30 means unlimited).
struct LinkSlack {
  std::array<std::int32_t, 3> upper, lower;
};

/// All slacks by look-up from the classes of both ends.
class SlackTable {
 public:
  SlackTable() = default;
  /// Transverse slack converts by the spacing: shear * h_axis mm is that many voxels of the
  /// coordinate's own axis.
  SlackTable(const MaterialTable& table, const Vec3d& spacing_mm);

  LinkSlack slack(int axis, std::uint8_t class_a, std::uint8_t class_b) const;
  /// slack(...).upper[coordinate] / .lower[coordinate] without building the struct.
  std::int32_t upper(int axis, int coordinate, std::uint8_t class_a, std::uint8_t class_b) const;
  std::int32_t lower(int axis, int coordinate, std::uint8_t class_a, std::uint8_t class_b) const;

 private:
  Combine m_combine = Combine::density;
  // density: [axis][coordinate][class_a + class_b]; limits: sums of two half-limits, see source
  std::vector<std::int32_t> m_upper, m_lower;
};

}  // namespace supple

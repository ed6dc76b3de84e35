#include "volumes/field/inversion_certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace supple {

namespace {

/// Counts of residuals, eight bins per power of two: the upper bits of a float.
struct Histogram {
  static constexpr int kShift = 20;
  std::array<std::int64_t, (0x7f800000u >> kShift) + 1> bins{};
  std::int64_t count = 0;
  float max = 0;

  void add(float value) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    ++bins[bits >> kShift];
    ++count;
    max = std::max(max, value);
  }
  void join(const Histogram& other) {
    for (std::size_t n = 0; n < bins.size(); ++n) bins[n] += other.bins[n];
    count += other.count;
    max = std::max(max, other.max);
  }
  /// Upper end of the bin in which the given part of all values is reached.
  double percentile(double part) const {
    std::int64_t seen = bins[0];
    const double wanted = part * double(count);
    if (double(seen) >= wanted) return 0;
    for (std::size_t n = 1; n < bins.size(); ++n) {
      seen += bins[n];
      if (double(seen) < wanted) continue;
      const std::uint32_t bits = std::uint32_t(n + 1) << kShift;
      float edge;
      std::memcpy(&edge, &bits, sizeof edge);
      return std::min(double(edge), double(max));
    }
    return max;
  }
};

/// u at the source position of `offset`, which rounding may have pushed just over the border of the
/// valid cells.
bool sample_at_border(const VectorBricks& u, Vec3d pos, const Vec3f& offset, Vec3d& vector) {
  if (u.sample(pos, vector)) return true;
  const double slack = 1e-5 + 1e-6 * double(offset.length());
  for (int a = 0; a < 3; ++a) {
    const double nearest = std::round(pos[a]);
    if (std::abs(pos[a] - nearest) <= slack) pos[a] = nearest;
  }
  return u.sample(pos, vector);
}

bool starts_in_folded_cell(const VectorBricks& u, const std::vector<BrickMask>& folded,
                           const Vec3d& pos) {
  const Vec3i cell(int(std::floor(pos.x)), int(std::floor(pos.y)), int(std::floor(pos.z)));
  const std::int32_t b = u.topology.find(cell);
  return b >= 0 && mask_test(folded[b], brick_offset(cell));
}

void measure_brick(const VectorBricks& u, const VectorBricks& o,
                   const std::vector<BrickMask>& folded, bool any_folded, std::size_t b,
                   Histogram& histogram) {
  const Vec3i& origin = o.topology.origin(b);
  const std::int32_t same = u.topology.find(origin);
  for_each_active(o.topology.mask(b), [&](int offset) {
    const Vec3f& vector = o.vectors[b * kBrickVoxels + offset];
    if (vector == Vec3f(0) && same >= 0 && mask_test(u.topology.mask(same), offset)) {
      if (any_folded && mask_test(folded[same], offset)) return;
      histogram.add(u.vectors[std::size_t(same) * kBrickVoxels + offset].length());
      return;
    }
    const Vec3d pos = Vec3d(origin + brick_local(offset)) + Vec3d(vector);
    if (any_folded && starts_in_folded_cell(u, folded, pos)) return;
    Vec3d moved;
    const bool known = sample_at_border(u, pos, vector, moved);
    histogram.add(known ? float((Vec3d(vector) + moved).length())
                        : std::numeric_limits<float>::infinity());
  });
}

}  // namespace

void measure_residuals(const VectorBricks& u, const VectorBricks& o,
                       const std::vector<BrickMask>& folded, InversionCertificate& certificate) {
  const bool any_folded = certificate.folded_cells > 0;
  using Range = tbb::blocked_range<std::size_t>;
  const Histogram histogram = tbb::parallel_reduce(
      Range(0, o.topology.brick_count(), 16), Histogram{},
      [&](const Range& range, Histogram part) {
        for (std::size_t b = range.begin(); b < range.end(); ++b) {
          measure_brick(u, o, folded, any_folded, b, part);
        }
        return part;
      },
      [](Histogram a, const Histogram& b) {
        a.join(b);
        return a;
      });
  certificate.residual_max = histogram.max;
  certificate.residual_p999 = histogram.percentile(0.999);
}

}  // namespace supple

#include "volumes/field/inversion/inversion_certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

/// u up to half a voxel beyond the border of the volume, where the cells there go on.
bool sample_beyond(const VectorBricks& u, const Vec3i& dims, const Vec3d& pos, Vec3d& vector) {
  const Vec3d inside = within_border(pos, dims);
  if (inside == pos) return false;
  Vec3i cell(int(std::floor(inside.x)), int(std::floor(inside.y)), int(std::floor(inside.z)));
  for (int a = 0; a < 3; ++a) cell[a] = std::max(std::min(cell[a], dims[a] - 2), 0);
  std::optional<Vec3f> first;  // differences to it are exactly 0 where nothing differs
  for (int n = 0; n < kCellCorners; ++n) {
    const Vec3i step = cell_corner(n);
    double weight = 1;
    for (int a = 0; a < 3; ++a) weight *= step[a] ? pos[a] - cell[a] : 1 - (pos[a] - cell[a]);
    if (weight == 0) continue;  // beyond a place on a lattice plane nothing need be
    Vec3f corner;
    if (!u.at(cell + step, corner)) return false;
    if (first) {
      vector += Vec3d(corner - *first) * weight;
    } else {
      first = corner;
      vector = Vec3d(corner);
    }
  }
  return true;
}

/// u at the source position of `offset`, which may lie beyond the border of the volume, or which
/// rounding may have pushed just over that of the valid cells.
bool sample_at_border(const VectorBricks& u, const Vec3i& dims, Vec3d pos, const Vec3f& offset,
                      Vec3d& vector) {
  if (u.sample(pos, vector) || sample_beyond(u, dims, pos, vector)) return true;
  const double slack = 1e-5 + 1e-6 * double(offset.length());
  for (int a = 0; a < 3; ++a) {
    const double nearest = std::round(pos[a]);
    if (std::abs(pos[a] - nearest) <= slack) pos[a] = nearest;
  }
  return u.sample(pos, vector);
}

bool starts_in_folded_cell(const VectorBricks& u, const FoldedCells& folded, const Vec3d& pos) {
  const Vec3i cell(int(std::floor(pos.x)), int(std::floor(pos.y)), int(std::floor(pos.z)));
  const BrickMask* const cells = folded.of(u.topology.find(cell));
  return cells != nullptr && mask_test(*cells, brick_offset(cell));
}

/// Residuals of one output brick after the other, with the memory for it.
class Probe {
 public:
  Probe(const VectorBricks& u, const Vec3i& dims, const FoldedCells& folded)
      : m_u(u), m_dims(dims), m_folded(folded) {}

  void measure_brick(const Vec3i& origin, const VectorBrickView& offsets,
                     ResidualHistogram& histogram);

 private:
  bool measure_still(const Vec3i& origin, const VectorBrickView& offsets,
                     ResidualHistogram& histogram) const;
  void measure_far(const Vec3d& pos, const Vec3f& offset, ResidualHistogram& histogram) const;

  const VectorBricks& m_u;
  const Vec3i m_dims;
  const FoldedCells& m_folded;
  SourceWindow m_window;
  std::array<float, kBrickVoxels> m_residuals;
};

/// Measures a residual by look-up in the sparse field.
void Probe::measure_far(const Vec3d& pos, const Vec3f& offset, ResidualHistogram& histogram) const {
  if (starts_in_folded_cell(m_u, m_folded, pos)) return;
  Vec3d moved;
  const bool known = sample_at_border(m_u, m_dims, pos, offset, moved);
  histogram.add(known ? float((Vec3d(offset) + moved).length())
                      : std::numeric_limits<float>::infinity());
}

void Probe::measure_brick(const Vec3i& origin, const VectorBrickView& offsets,
                          ResidualHistogram& histogram) {
  if (measure_still(origin, offsets, histogram)) return;
  const Vec3f* const vectors = offsets.vectors;
  const BrickMask& nodes = *offsets.mask;
  const bool measured = m_window.measure(m_u, m_folded, origin, nodes, vectors, m_residuals);
  for_each_active(nodes, [&](int offset) {
    const float residual = measured ? m_residuals[offset] : SourceWindow::kUnknown;
    if (residual >= 0) {
      histogram.add(residual);
    } else if (residual == SourceWindow::kUnknown) {
      const Vec3f& o = vectors[offset];
      measure_far(Vec3d(origin + brick_local(offset)) + Vec3d(o), o, histogram);
    }
  });
}

/// Measures a brick whose offsets are all 0: u at the voxels themselves is the residual. False for
/// other bricks, or when such a voxel is no source.
bool Probe::measure_still(const Vec3i& origin, const VectorBrickView& offsets,
                          ResidualHistogram& histogram) const {
  if (!are_zeros(offsets.vectors)) return false;
  const std::int32_t same = m_u.topology.find(origin);
  if (same < 0) return false;
  const BrickMask &nodes = *offsets.mask, &sources = m_u.topology.mask(std::size_t(same));
  if (&nodes != &sources && !holds(sources, nodes)) return false;
  const Vec3f* u = m_u.vectors.brick_or_zero(std::size_t(same));
  const BrickMask* const folded = m_folded.of(same);
  if (folded == nullptr && are_zeros(u)) {
    histogram.add_zeros(mask_count(nodes));
    return true;
  }
  for_each_active(nodes, [&](int offset) {
    if (folded == nullptr || !mask_test(*folded, offset)) histogram.add(u[offset].length());
  });
  return true;
}

}  // namespace

void ResidualHistogram::add(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  ++m_bins[bits >> kShift];
  ++m_count;
  m_max = std::max(m_max, value);
}

void ResidualHistogram::add_zeros(int count) {
  m_bins[0] += count;
  m_count += count;
}

void ResidualHistogram::join(const ResidualHistogram& other) {
  for (std::size_t n = 0; n < m_bins.size(); ++n) m_bins[n] += other.m_bins[n];
  m_count += other.m_count;
  m_max = std::max(m_max, other.m_max);
}

void ResidualHistogram::add(const BrickResiduals& brick) {
  for (const std::uint32_t entry : brick.bins) {
    m_bins[entry >> 10] += entry & 0x3ff;
    m_count += entry & 0x3ff;
  }
  m_max = std::max(m_max, brick.max);
}

void ResidualHistogram::remove(const BrickResiduals& brick) {
  for (const std::uint32_t entry : brick.bins) {
    m_bins[entry >> 10] -= entry & 0x3ff;
    m_count -= entry & 0x3ff;
  }
}

BrickResiduals ResidualHistogram::of_one_brick() const {
  BrickResiduals brick;
  brick.max = m_max;
  std::int64_t left = m_count;
  for (std::size_t n = 0; left > 0; ++n) {
    left -= m_bins[n];
    if (m_bins[n] > 0) brick.bins.push_back(std::uint32_t(n << 10 | std::size_t(m_bins[n])));
  }
  return brick;
}

double ResidualHistogram::percentile(double part) const {
  std::int64_t seen = m_bins[0];
  const double wanted = part * double(m_count);
  if (double(seen) >= wanted) return 0;
  for (std::size_t n = 1; n < m_bins.size(); ++n) {
    seen += m_bins[n];
    if (double(seen) < wanted) continue;
    const std::uint32_t bits = std::uint32_t(n + 1) << kShift;
    float edge;
    std::memcpy(&edge, &bits, sizeof edge);
    return std::min(double(edge), double(m_max));
  }
  return m_max;
}

ResidualHistogram measure_residuals(const VectorBricks& u, const Vec3i& dims, const VectorBricks& o,
                                    const FoldedCells& folded) {
  PerThread<Probe> probes([&] { return Probe(u, dims, folded); });
  return parallel_reduce(
      o.topology.brick_count(), Grain{16}, ResidualHistogram{},
      [&](std::size_t b, ResidualHistogram& part) {
        probes.local().measure_brick(o.topology.origin(b),
                                     {&o.topology.mask(b), o.vectors.brick_or_zero(b)}, part);
      },
      [](ResidualHistogram a, const ResidualHistogram& b) {
        a.join(b);
        return a;
      });
}

std::vector<BrickResiduals> measure_bricks(const VectorBricks& u, const Vec3i& dims,
                                           const std::vector<Vec3i>& origins,
                                           const VectorBrickFinder& offsets,
                                           const FoldedCells& folded) {
  std::vector<BrickResiduals> residuals(origins.size());
  PerThread<Probe> probes([&] { return Probe(u, dims, folded); });
  parallel_for(origins.size(), [&](std::size_t n) {
    ResidualHistogram histogram;
    probes.local().measure_brick(origins[n], offsets(origins[n]), histogram);
    residuals[n] = histogram.of_one_brick();
  });
  return residuals;
}

}  // namespace supple

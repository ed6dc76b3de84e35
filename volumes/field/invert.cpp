// Forward over source cells: each deformed cell solves for the lattice nodes in its box, so every
// cell is set up once and its nodes compete in an order-free accumulator.
#include "volumes/field/invert.h"

#include <algorithm>
#include <cmath>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "volumes/field/inversion_certificate.h"
#include "volumes/field/offset_accumulator.h"
#include "volumes/field/output_bricks.h"
#include "volumes/field/ring_fill.h"
#include "volumes/field/source_cells.h"

namespace supple {

namespace {

// Offsets are floats: beyond a million voxels they no longer resolve a sixteenth of a voxel.
constexpr float kMaxDisplacement = 1e6f;
constexpr std::size_t kMaxListed = 1000;

/// Parallel over bricks in chunks, with progress and cancellation between them.
template <class Body>
void for_bricks(std::size_t count, Progress* progress, Body&& body) {
  constexpr std::size_t kChunk = 4096;
  for (std::size_t start = 0; start < count; start += kChunk) {
    report(progress, double(start) / double(count));
    tbb::parallel_for(start, std::min(count, start + kChunk), body);
  }
}

/// A node in the box of a cell for which the quick solve could not decide.
struct Doubt {
  Vec3i node;
  Vec3i cell;
};

/// Sums of one thread; they merge to the same result in any order.
struct Totals {
  std::int64_t cells = 0;
  std::int64_t folded_cells = 0;
  std::int64_t folded_air_cells = 0;
  double min_det = 1;
  std::vector<Doubt> doubts;
  std::vector<OffsetAccumulator::Hit> hits;  // of the brick at work
};

class Inversion {
 public:
  Inversion(const VectorBricks& u, const Vec3i& dims, const InvertParams& params)
      : m_u(u), m_dims(dims), m_params(params), m_folded(u.topology.brick_count(), BrickMask{}) {
    classify_bricks();
  }

  VectorBricks run(InversionCertificate& certificate, Progress* progress);

 private:
  void classify_bricks();
  void solve_brick(std::size_t b, OffsetAccumulator& accumulator, Totals& totals);
  std::vector<Vec3i> settle(const std::vector<Doubt>& doubts, OffsetAccumulator& accumulator) const;
  void translate_cell(const Vec3i& cell, const Vec3f& shift, Totals& totals) const;
  bool solve_cell(const CellCorners& corners, const Vec3i& cell, Totals& totals) const;
  bool reaches_into_air(const Vec3i& cell) const;
  void add_hit(const Vec3i& node, const Vec3d& source, const Vec3f& o, Totals& totals) const;

  const VectorBricks& m_u;
  const Vec3i m_dims;
  const InvertParams m_params;
  std::vector<BrickMask> m_folded;    // cells per source brick
  std::vector<std::uint8_t> m_still;  // u = 0 at all corners of the brick's cells
};

/// Refuses values that have no place on the lattice, and finds the bricks that did not move.
void Inversion::classify_bricks() {
  const BrickTopology& bricks = m_u.topology;
  std::vector<std::uint8_t> zero(bricks.brick_count());
  tbb::parallel_for(std::size_t(0), bricks.brick_count(), [&](std::size_t b) {
    float largest = 0;
    for_each_active(bricks.mask(b), [&](int offset) {
      const Vec3f& u = m_u.vectors[b * kBrickVoxels + offset];
      const float size = std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z)});
      if (!(size <= kMaxDisplacement) || std::isnan(u.x + u.y + u.z)) {
        throw InputError(
            {"", "displacement at voxel " + to_text(bricks.origin(b) + brick_local(offset)),
             "a vector that is not finite or longer than 10^6 voxels", "finite displacements"});
      }
      largest = std::max(largest, size);
    });
    zero[b] = largest == 0;
  });
  const bool flat = std::min({m_dims.x, m_dims.y, m_dims.z}) == 1;
  m_still.assign(bricks.brick_count(), 0);
  if (flat) return;
  tbb::parallel_for(std::size_t(0), bricks.brick_count(), [&](std::size_t b) {
    bool still = zero[b];
    for (int n = 1; n < 8 && still; ++n) {
      const Vec3i step(n >> 2, (n >> 1) & 1, n & 1);
      const std::int32_t upper = bricks.find(bricks.origin(b) + step * kBrickDim);
      still = upper < 0 || zero[upper];
    }
    m_still[b] = still;
  });
}

/// Along an axis with one slice only what comes from that slice counts, not from its copies.
void Inversion::add_hit(const Vec3i& node, const Vec3d& source, const Vec3f& o,
                        Totals& totals) const {
  for (int a = 0; a < 3; ++a) {
    if (m_dims[a] == 1 && !(source[a] > -0.5 && source[a] <= 0.5)) return;
  }
  totals.hits.push_back({node, o});
}

/// All corners moved alike: o = -shift at the nodes of the moved unit cube, exactly.
void Inversion::translate_cell(const Vec3i& cell, const Vec3f& shift, Totals& totals) const {
  const Vec3d u(shift);
  const Vec3i lo(int(std::ceil(u.x)), int(std::ceil(u.y)), int(std::ceil(u.z)));
  const Vec3i hi(int(std::floor(u.x + 1)), int(std::floor(u.y + 1)), int(std::floor(u.z + 1)));
  const Vec3f o = Vec3f(0) - shift;
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) {
        const Vec3i node = cell + Vec3i(x, y, z);
        add_hit(node, Vec3d(node) - u, o, totals);
      }
    }
  }
}

/// True when a corner of the cell is no element. The cells of a one-slice volume have their far
/// corners in the slice as well.
bool Inversion::reaches_into_air(const Vec3i& cell) const {
  if (m_params.material == nullptr) return false;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3i voxel = cell + Vec3i(corner & 1, (corner >> 1) & 1, corner >> 2);
    for (int a = 0; a < 3; ++a) {
      if (m_dims[a] == 1) voxel[a] = 0;
    }
    if (!m_params.material->is_active(voxel)) return true;
  }
  return false;
}

/// True when the cell is folded.
bool Inversion::solve_cell(const CellCorners& corners, const Vec3i& cell, Totals& totals) const {
  const double min_det = min_corner_det(corners);
  totals.min_det = std::min(totals.min_det, min_det);
  const bool folded = min_det <= 0;
  const IndexBox nodes = nodes_of(corners, cell);
  if (nodes.empty()) return folded;

  const DeformedCell deformed(corners, folded);
  const double tolerance = m_params.residual_tolerance_voxels;
  for (int x = nodes.lo.x; x <= nodes.hi.x; ++x) {
    for (int y = nodes.lo.y; y <= nodes.hi.y; ++y) {
      for (int z = nodes.lo.z; z <= nodes.hi.z; ++z) {
        const Vec3d node(x, y, z);
        Vec3d local;
        auto outcome = deformed.solve(node, tolerance, m_params.max_newton_steps, local);
        if (outcome == DeformedCell::Outcome::outside) continue;
        if (folded) {
          outcome = deformed.solve_by_bisection(node, tolerance, m_params.max_newton_steps, local);
        }
        if (outcome == DeformedCell::Outcome::inside) {
          add_hit(cell + Vec3i(x, y, z), Vec3d(cell) + local, Vec3f(local - node), totals);
        } else if (outcome == DeformedCell::Outcome::undecided) {
          totals.doubts.push_back({cell + Vec3i(x, y, z), cell});
        }
      }
    }
  }
  return folded;
}

void Inversion::solve_brick(std::size_t b, OffsetAccumulator& accumulator, Totals& totals) {
  if (m_still[b]) {
    const BrickMask cells = cell_mask(m_u.topology, b);
    totals.cells += mask_count(cells);
    accumulator.merge_zeros(m_u.topology.origin(b), cells);
    return;
  }
  SourceCells cells;
  if (!gather_cells(m_u, b, cells)) return;
  totals.cells += mask_count(cells.mask);
  totals.hits.clear();
  const std::size_t first_doubt = totals.doubts.size();
  for_each_active(cells.mask, [&](int offset) {
    const Vec3i cell = cells.origin + brick_local(offset);
    Vec3f shift;
    if (is_translated(cells, offset, shift)) {
      translate_cell(cell, shift, totals);
    } else if (solve_cell(cell_corners(cells, offset), cell, totals)) {
      mask_set(m_folded[b], offset);
      ++totals.folded_cells;
      totals.folded_air_cells += reaches_into_air(cell);
    }
  });
  accumulator.merge(totals.hits);
  // Most doubtful nodes lie in the cell beside; those need no further thought.
  const auto solved = [&](const Doubt& doubt) { return accumulator.contains(doubt.node); };
  totals.doubts.erase(
      std::remove_if(totals.doubts.begin() + first_doubt, totals.doubts.end(), solved),
      totals.doubts.end());
}

/// Bisects the cells around nodes that are still without a solution; returns those that are covered
/// by such a cell and yet stay without.
std::vector<Vec3i> Inversion::settle(const std::vector<Doubt>& doubts,
                                     OffsetAccumulator& accumulator) const {
  tbb::enumerable_thread_specific<Totals> parts;
  tbb::enumerable_thread_specific<std::vector<Vec3i>> covered;
  tbb::parallel_for(std::size_t(0), doubts.size(), [&](std::size_t n) {
    const auto [node, cell] = doubts[n];
    CellCorners corners;
    for (int c = 0; c < 8; ++c) {
      const Vec3i step(c >> 2, (c >> 1) & 1, c & 1);
      Vec3f u(0);
      m_u.at(cell + step, u);
      for (int a = 0; a < 3; ++a) corners.p[a][c] = step[a] + double(u[a]);
    }
    const Vec3d x(node - cell);
    Vec3d local;
    const auto outcome = DeformedCell(corners, min_corner_det(corners) <= 0)
                             .solve_by_bisection(x, m_params.residual_tolerance_voxels,
                                                 m_params.max_newton_steps, local);
    if (outcome == DeformedCell::Outcome::inside) {
      add_hit(node, Vec3d(cell) + local, Vec3f(local - x), parts.local());
    } else if (outcome == DeformedCell::Outcome::undecided && covered_by_tetrahedra(corners, x)) {
      covered.local().push_back(node);
    }
  });
  for (const Totals& part : parts) accumulator.merge(part.hits);
  std::vector<Vec3i> unresolved;
  for (const std::vector<Vec3i>& part : covered) {
    std::copy_if(part.begin(), part.end(), std::back_inserter(unresolved),
                 [&](const Vec3i& node) { return !accumulator.contains(node); });
  }
  sort_unique(unresolved);
  return unresolved;
}

VectorBricks Inversion::run(InversionCertificate& certificate, Progress* progress) {
  OffsetAccumulator accumulator(output_origins(m_u, m_still));
  tbb::enumerable_thread_specific<Totals> totals;
  for_bricks(m_u.topology.brick_count(), progress,
             [&](std::size_t b) { solve_brick(b, accumulator, totals.local()); });

  // What the quick solves left open.
  std::vector<Doubt> doubts;
  for (const Totals& part : totals) {
    certificate.cells += part.cells;
    certificate.folded_cells += part.folded_cells;
    certificate.folded_air_cells += part.folded_air_cells;
    certificate.min_det = std::min(certificate.min_det, part.min_det);
    std::copy_if(part.doubts.begin(), part.doubts.end(), std::back_inserter(doubts),
                 [&](const Doubt& doubt) { return !accumulator.contains(doubt.node); });
  }
  std::vector<Vec3i> unresolved = settle(doubts, accumulator);
  certificate.unresolved_voxels = std::int64_t(unresolved.size());
  unresolved.resize(std::min(unresolved.size(), kMaxListed));
  certificate.unresolved = std::move(unresolved);

  VectorBricks o = accumulator.finish();
  measure_residuals(m_u, o, m_folded, certificate);
  return o;
}

}  // namespace

OffsetField invert(const Displacement& displacement, const InvertParams& params,
                   Progress* progress) {
  if (progress != nullptr) progress->stage("inverting");
  const Vec3i& dims = displacement.geometry.dims();
  OffsetField field{displacement.geometry, {}, {}};
  if (std::min({dims.x, dims.y, dims.z}) == 1) {
    const VectorBricks thick = thickened(displacement.u, dims);
    field.o = Inversion(thick, dims, params).run(field.certificate, progress);
  } else {
    field.o = Inversion(displacement.u, dims, params).run(field.certificate, progress);
  }
  report(progress, 1);
  return field;
}

VectorBricks extrapolate_into_bricks(const VectorBricks& offsets, int rings) {
  return fill_rings(offsets, touching_bricks(offsets.topology), rings);
}

}  // namespace supple

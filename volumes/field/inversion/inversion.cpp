// Forward over source cells: each deformed cell solves for the lattice nodes in its box, so every
// cell is set up once and its nodes compete in an order-free accumulator.
#include "volumes/field/inversion/inversion.h"

#include <algorithm>
#include <numeric>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

constexpr std::size_t kMaxListed = 1000;

/// Parallel over bricks in chunks, with progress and cancellation between them.
template <class Body>
void for_bricks(const std::vector<std::int32_t>& bricks, Progress* progress, Body&& body) {
  constexpr std::size_t kChunk = 4096;
  const std::size_t count = bricks.size();
  for (std::size_t start = 0; start < count; start += kChunk) {
    report(progress, double(start) / double(count));
    tbb::parallel_for(start, std::min(count, start + kChunk),
                      [&](std::size_t n) { body(std::size_t(bricks[n])); });
  }
}

std::vector<std::int32_t> all_bricks(std::size_t count) {
  std::vector<std::int32_t> bricks(count);
  std::iota(bricks.begin(), bricks.end(), 0);
  return bricks;
}

void add_origins(const IndexBox& reach, std::vector<Vec3i>& origins) {
  if (!reach.empty()) add_box(reach.lo, reach.hi, origins);
}

bool is_in_brick_of(const std::vector<Vec3i>& origins, const Vec3i& node) {
  const Vec3i origin(node.x & ~7, node.y & ~7, node.z & ~7);
  return std::binary_search(origins.begin(), origins.end(), origin, voxel_less);
}

}  // namespace

/// What one thread works with.
struct Inversion::Worker {
  Worker(const Vec3i& dims, const InvertParams& params) : solver(dims, params) {}

  BrickSolver solver;
  SourceCells cells;
  std::vector<OpenNode> doubts;
};

Inversion::Inversion(const Vec3i& dims, const InvertParams& params)
    : m_dims(dims), m_params(params) {
  const bool is_slice = std::min({dims.x, dims.y, dims.z}) == 1;
  if (is_slice && params.material != nullptr) m_slice = thickened(*params.material, dims);
}

CellContents Inversion::contents_of(const Vec3i& origin) const {
  return {m_slice.empty() ? m_params.material : &m_slice, origin};
}

/// Refuses values that have no place on the lattice, and finds how far these bricks move.
void Inversion::classify(const VectorBricks& u, const std::vector<std::int32_t>& bricks) {
  m_ranges.resize(u.topology.brick_count());
  tbb::parallel_for(std::size_t(0), bricks.size(), [&](std::size_t n) {
    m_ranges[bricks[n]] = ranges_of(u, std::size_t(bricks[n]));
  });
}

/// Finds what the cells of these bricks reach.
void Inversion::place(const VectorBricks& u, const std::vector<std::int32_t>& bricks) {
  const std::size_t count = u.topology.brick_count();
  const bool flat = std::min({m_dims.x, m_dims.y, m_dims.z}) == 1;
  m_reach.resize(count);
  m_still.resize(count);
  tbb::parallel_for(std::size_t(0), bricks.size(), [&](std::size_t n) {
    const std::size_t b = std::size_t(bricks[n]);
    m_reach[b] = reach_of(u.topology, m_ranges, b);
    m_still[b] = !flat && is_still(u.topology, m_ranges, b);
  });
}

void Inversion::solve_brick(const VectorBricks& u, std::size_t b, OffsetAccumulator& accumulator,
                            Worker& worker) {
  const Vec3i& origin = u.topology.origin(b);
  m_findings[b] = {};
  m_folded[b] = {};
  if (m_still[b]) {
    const BrickMask cells = cell_mask(u.topology, b);
    m_findings[b].cells = mask_count(cells);
    accumulator.merge_zeros(origin, cells, contents_of(origin));
    return;
  }
  if (!gather_cells(u, b, worker.cells)) return;
  const CellContents contents = contents_of(origin);
  m_findings[b] = worker.solver.solve(worker.cells, contents, m_folded[b]);
  CellResults& results = worker.solver.results();
  accumulator.merge_zeros(origin, results.still, contents);
  if (is_torn(m_reach[b])) {
    accumulator.merge(results.hits);
  } else {
    // Most doubtful nodes lie in the cell beside; those need no further thought.
    accumulator.merge(m_reach[b], results.hits, results.doubts);
  }
  worker.doubts.insert(worker.doubts.end(), results.doubts.begin(), results.doubts.end());
}

/// Bisects the cells around nodes that are still without a solution, and lists those that are
/// covered by such a cell and yet stay without.
void Inversion::settle(const VectorBricks& u, const std::vector<OpenNode>& doubts,
                       OffsetAccumulator& accumulator) {
  tbb::enumerable_thread_specific<BrickSolver> solvers(
      [&] { return BrickSolver(m_dims, m_params); });
  tbb::enumerable_thread_specific<std::vector<OffsetAccumulator::NodeSolution>> hits;
  tbb::enumerable_thread_specific<std::vector<Vec3i>> covered;
  tbb::parallel_for(std::size_t(0), doubts.size(), [&](std::size_t n) {
    BrickSolver& solver = solvers.local();
    bool is_covered;
    const Vec3i& cell = doubts[n].cell;
    const CellContents contents = contents_of({cell.x & ~7, cell.y & ~7, cell.z & ~7});
    if (solver.settle(u, doubts[n], contents, is_covered)) {
      hits.local().push_back(solver.results().hits.front());
    } else if (is_covered) {
      covered.local().push_back(doubts[n].node);
    }
  });
  for (const auto& part : hits) accumulator.merge(part);
  for (const std::vector<Vec3i>& part : covered) {
    std::copy_if(part.begin(), part.end(), std::back_inserter(m_unresolved),
                 [&](const Vec3i& node) { return !accumulator.holds(node, Content::air); });
  }
  sort_unique(m_unresolved);
}

VectorBricks Inversion::solve_bricks(const VectorBricks& u, const std::vector<std::int32_t>& bricks,
                                     OffsetAccumulator& accumulator, Progress* progress) {
  tbb::enumerable_thread_specific<Worker> workers([&] { return Worker(m_dims, m_params); });
  for_bricks(bricks, progress,
             [&](std::size_t b) { solve_brick(u, b, accumulator, workers.local()); });
  // What the quick solves left open.
  std::vector<OpenNode> doubts;
  for (const Worker& part : workers) {
    std::copy_if(
        part.doubts.begin(), part.doubts.end(), std::back_inserter(doubts),
        [&](const OpenNode& doubt) { return !accumulator.holds(doubt.node, doubt.content); });
  }
  settle(u, doubts, accumulator);
  const BrickTopology overlaps = accumulator.overlaps();
  for (std::size_t b = 0; b < overlaps.brick_count(); ++b) {
    m_overlaps.emplace(overlaps.origin(b), overlaps.mask(b));
  }
  return accumulator.finish();
}

VectorBricks Inversion::solve(const VectorBricks& u, Progress* progress) {
  const std::vector<std::int32_t> bricks = all_bricks(u.topology.brick_count());
  m_unresolved.clear();
  m_overlaps.clear();
  m_findings.assign(bricks.size(), {});
  m_folded.assign(bricks.size(), {});
  classify(u, bricks);
  place(u, bricks);
  OffsetAccumulator accumulator(reachable_origins(u, m_reach));
  return solve_bricks(u, bricks, accumulator, progress);
}

bool Inversion::solve_changed(const VectorBricks& u, const std::vector<std::int32_t>& changed,
                              std::vector<Vec3i>& touched, VectorBricks& offsets) {
  // What the cells with a changed corner reached, and what they reach now.
  const std::vector<std::int32_t> affected = with_lower_neighbours(u.topology, changed);
  touched.clear();
  for (int pass = 0; pass < 2; ++pass) {
    for (const std::int32_t b : affected) {
      if (is_torn(m_reach[b])) return false;
      add_origins(m_reach[b], touched);
    }
    sort_unique(touched);
    if (pass > 0) break;
    classify(u, changed);
    place(u, affected);
  }

  // Every brick that reaches them takes part, changed or not.
  const auto is_touched = [&](const Vec3i& node) { return is_in_brick_of(touched, node); };
  m_unresolved.erase(std::remove_if(m_unresolved.begin(), m_unresolved.end(), is_touched),
                     m_unresolved.end());
  for (const Vec3i& origin : touched) m_overlaps.erase(origin);
  OffsetAccumulator accumulator(touched);
  std::vector<std::uint8_t> takes_part(u.topology.brick_count());
  tbb::parallel_for(std::size_t(0), takes_part.size(),
                    [&](std::size_t b) { takes_part[b] = accumulator.is_reached_by(m_reach[b]); });
  for (const std::int32_t b : affected) takes_part[b] = 1;
  std::vector<std::int32_t> bricks;
  for (std::size_t b = 0; b < takes_part.size(); ++b) {
    if (takes_part[b]) bricks.push_back(std::int32_t(b));
  }
  offsets = solve_bricks(u, bricks, accumulator, nullptr);
  return true;
}

BrickTopology Inversion::overlaps() const {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const auto& [origin, mask] : m_overlaps) {
    origins.push_back(origin);
    masks.push_back(mask);
  }
  return {std::move(origins), std::move(masks)};
}

InversionCertificate Inversion::certificate() const {
  InversionCertificate certificate;
  for (std::size_t b = 0; b < m_findings.size(); ++b) {
    const BrickFindings& findings = m_findings[b];
    certificate.cells += findings.cells;
    certificate.folded_cells += findings.folded_cells;
    certificate.folded_air_cells += findings.folded_air_cells;
    certificate.min_det = std::min(certificate.min_det, findings.min_det);
  }
  for (const auto& [origin, mask] : m_overlaps) certificate.overlapped_voxels += mask_count(mask);
  certificate.unresolved_voxels = std::int64_t(m_unresolved.size());
  certificate.unresolved = m_unresolved;
  certificate.unresolved.resize(std::min(m_unresolved.size(), kMaxListed));
  return certificate;
}

}  // namespace supple

// Forward over source cells: each deformed cell solves for the lattice nodes in its box, so every
// cell is set up once and its nodes compete in an order-free accumulator.
#include "volumes/field/inversion/inversion.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "volumes/base/parallel.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/field/inversion/resting_brick.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

constexpr std::size_t kMaxListed = 1000;

/// Runs `body` in parallel over all numbers, in chunks with progress and cancellation between.
template <class Body>
void for_numbers(const std::vector<std::size_t>& numbers, Progress* progress, Body&& body) {
  constexpr std::size_t kChunk = 4096;
  const std::size_t count = numbers.size();
  for (std::size_t start = 0; start < count; start += kChunk) {
    report(progress, double(start) / double(count));
    parallel_for(start, std::min(count, start + kChunk), [&](std::size_t n) { body(numbers[n]); });
  }
}

template <class Number>
std::vector<Number> all_numbers(std::size_t count) {
  std::vector<Number> numbers(count);
  std::iota(numbers.begin(), numbers.end(), Number(0));
  return numbers;
}

}  // namespace

/// Solver and scratch memory of one thread.
struct Inversion::Worker {
  Worker(const Vec3i& dims, const InvertParams& params) : solver(dims, params) {}

  BrickSolver solver;
  SourceCells cells;
  std::vector<OpenNode> doubts;
};

Inversion::Inversion(const Vec3i& dims, const InvertParams& params)
    : m_dims(dims), m_params(params), m_ranges(dims) {
  if (is_flat(dims) && params.material != nullptr) m_slice = thickened(*params.material, dims);
}

CellContents Inversion::contents_of(const Vec3i& origin) const {
  return {m_slice.empty() ? m_params.material : &m_slice, origin};
}

void Inversion::add_sources(const std::vector<std::int32_t>& bricks) {
  for (const std::int32_t b : bricks) {
    if (!rests(b)) continue;
    m_source_of[std::size_t(b)] = std::int32_t(m_sources.size());
    m_resting_cells[std::size_t(b)] = 0;
    m_sources.push_back({b, {}});
  }
}

/// Finds what the cells of these bricks, which are sources, reach.
void Inversion::place(const VectorBricks& u, const std::vector<std::int32_t>& bricks) {
  parallel_for(bricks.size(), [&](std::size_t n) {
    const auto b = std::size_t(bricks[n]);
    Source& source = m_sources[std::size_t(m_source_of[b])];
    source.reach = m_ranges.reach(u.topology, b);
    source.is_still = !is_flat(m_dims) && m_ranges.is_still(u.topology, b);
  });
}

void Inversion::solve_source(const VectorBricks& u, Source& source, OffsetAccumulator& accumulator,
                             Worker& worker) const {
  const auto b = std::size_t(source.brick);
  const Vec3i& origin = u.topology.origin(b);
  source.findings = {};
  source.folded = {};
  if (source.is_still) {
    const BrickMask cells = cell_mask(u.topology, b);
    source.findings.cells = mask_count(cells);
    accumulator.merge_zeros(origin, cells, contents_of(origin));
    return;
  }
  if (!gather_cells(u, b, worker.cells)) return;
  const CellContents contents = contents_of(origin);
  source.findings = worker.solver.solve(worker.cells, contents, source.folded);
  CellResults& results = worker.solver.results();
  accumulator.merge_zeros(origin, results.still, contents);
  if (is_torn(source.reach)) {
    accumulator.merge(results.hits);
  } else {
    // Most doubtful nodes lie in the cell beside; those need no further thought.
    accumulator.merge(source.reach, results.hits, results.doubts);
  }
  worker.doubts.insert(worker.doubts.end(), results.doubts.begin(), results.doubts.end());
}

/// Merges the zeros of resting cells with corners in the output bricks.
void Inversion::merge_resting(const VectorBricks& u, OffsetAccumulator& accumulator) const {
  const std::vector<Vec3i>& outputs = accumulator.bricks().index().origins();
  std::vector<std::int32_t> beside;
  for (const Vec3i& origin : outputs) {
    for (int n = 0; n < 8; ++n) {
      const std::int32_t b = u.topology.find(origin - cell_corner(n) * kBrickDim);
      if (rests(b)) beside.push_back(b);
    }
  }
  std::sort(beside.begin(), beside.end());
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  parallel_for(beside.size(), [&](std::size_t n) {
    const auto b = std::size_t(beside[n]);
    const Vec3i& origin = u.topology.origin(b);
    accumulator.merge_zeros(origin, cell_mask(u.topology, b), contents_of(origin));
  });
}

/// Bisects the cells around nodes that are still without a solution, and lists those that are
/// covered by such a cell and yet stay without.
void Inversion::settle(const VectorBricks& u, const std::vector<OpenNode>& doubts,
                       OffsetAccumulator& accumulator) {
  PerThread<BrickSolver> solvers([&] { return BrickSolver(m_dims, m_params); });
  PerThread<std::vector<OffsetAccumulator::NodeSolution>> hits;
  PerThread<std::vector<Vec3i>> covered;
  parallel_for(doubts.size(), [&](std::size_t n) {
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

VectorBricks Inversion::solve_sources(const VectorBricks& u,
                                      const std::vector<std::size_t>& sources,
                                      OffsetAccumulator& accumulator, Progress* progress) {
  merge_resting(u, accumulator);  // first, so that fewer offsets are stored in vain
  PerThread<Worker> workers([&] { return Worker(m_dims, m_params); });
  for_numbers(sources, progress,
              [&](std::size_t n) { solve_source(u, m_sources[n], accumulator, workers.local()); });
  // Nodes that the quick solves left open.
  std::vector<OpenNode> doubts;
  for (const Worker& part : workers) {
    std::copy_if(part.doubts.begin(), part.doubts.end(), std::back_inserter(doubts),
                 [&](const OpenNode& doubt) {
                   return accumulator.bricks().find(doubt.node) >= 0 &&
                          !accumulator.holds(doubt.node, doubt.content);
                 });
  }
  settle(u, doubts, accumulator);
  const BrickTopology overlaps = accumulator.overlaps();
  for (std::size_t b = 0; b < overlaps.brick_count(); ++b) {
    m_overlaps.emplace(overlaps.origin(b), overlaps.mask(b));
  }
  return accumulator.finish();
}

VectorBricks Inversion::solve(const VectorBricks& u, Progress* progress) {
  const std::size_t count = u.topology.brick_count();
  m_unresolved.clear();
  m_overlaps.clear();
  m_sources.clear();
  m_source_of.assign(count, -1);
  m_resting_cells.assign(count, 0);
  m_ranges = DisplacementRanges(m_dims);
  // The copies of a slice count as moving, so that nothing comes from them.
  const std::vector<std::int32_t> moving =
      is_flat(m_dims) ? all_numbers<std::int32_t>(count) : bricks_that_move(u);
  add_sources(moving);
  m_ranges.update(u, moving);
  place(u, moving);
  std::vector<BrickReach> reaches;
  for (const Source& source : m_sources) reaches.push_back({source.brick, source.reach});
  const std::vector<Vec3i> reached = reachable_origins(u, reaches);
  const std::vector<Vec3i> wanted = wanted_of(reached);
  m_is_partial = wanted.size() < reached.size();
  OffsetAccumulator accumulator(wanted);
  VectorBricks moved = solve_sources(u, sources_reaching(accumulator), accumulator, progress);
  return with_resting(u.topology, BrickIndex(reached), std::move(moved));
}

std::vector<Vec3i> Inversion::wanted_of(const std::vector<Vec3i>& origins) const {
  if (!m_params.wants) return origins;
  std::vector<Vec3i> wanted;
  std::copy_if(origins.begin(), origins.end(), std::back_inserter(wanted), m_params.wants);
  return wanted;
}

std::vector<std::size_t> Inversion::sources_reaching(const OffsetAccumulator& accumulator) const {
  std::vector<std::size_t> sources = all_numbers<std::size_t>(m_sources.size());
  if (!m_params.wants) return sources;
  const auto reaches_none = [&](std::size_t n) {
    const IndexBox& reach = m_sources[n].reach;
    return !is_torn(reach) && !accumulator.is_reached_by(reach);
  };
  sources.erase(std::remove_if(sources.begin(), sources.end(), reaches_none), sources.end());
  return sources;
}

/// The bricks that moving ones reach, and the others of u. Counts the cells that rest.
VectorBricks Inversion::with_resting(const BrickTopology& bricks, const BrickIndex& reached,
                                     VectorBricks moved) {
  const std::size_t count = bricks.brick_count();
  PerThread<std::vector<std::pair<std::size_t, BrickMask>>> parts;
  std::vector<std::uint8_t> full(count);
  parallel_for(count, [&](std::size_t b) { full[b] = is_full(bricks.mask(b)) ? 1 : 0; });
  parallel_for(count, [&](std::size_t b) {
    const RestingBrick brick(bricks, full, b, [&](std::int32_t lower) { return rests(lower); });
    if (rests(std::int32_t(b))) m_resting_cells[b] = std::int16_t(brick.cells());
    if (reached.find(bricks.origin(b)) >= 0) return;
    const BrickMask nodes = brick.nodes();
    if (nodes != bricks.mask(b)) parts.local().emplace_back(b, nodes);
  });
  std::unordered_map<std::size_t, BrickMask> differing;
  for (const auto& part : parts) differing.insert(part.begin(), part.end());

  // Mostly the bricks are those of u, which are shared then.
  const auto is_of_u = [&](std::size_t n) {
    const std::int32_t b = bricks.find(moved.topology.origin(n));
    return b >= 0 && bricks.mask(std::size_t(b)) == moved.topology.mask(n);
  };
  bool is_same = differing.empty();
  std::size_t replaced = 0;  // bricks of u among the reached ones
  for (const Vec3i& origin : reached.origins()) replaced += bricks.find(origin) >= 0;
  is_same = is_same && replaced == moved.topology.brick_count();
  for (std::size_t n = 0; n < moved.topology.brick_count() && is_same; ++n) is_same = is_of_u(n);
  BrickTopology all = bricks;
  if (!is_same) {
    std::vector<Vec3i> origins = moved.topology.index().origins();
    std::vector<BrickMask> masks;
    for (std::size_t n = 0; n < origins.size(); ++n) masks.push_back(moved.topology.mask(n));
    for (std::size_t b = 0; b < count; ++b) {
      if (reached.find(bricks.origin(b)) >= 0) continue;
      origins.push_back(bricks.origin(b));
      const auto found = differing.find(b);
      masks.push_back(found == differing.end() ? bricks.mask(b) : found->second);
    }
    all = BrickTopology(std::move(origins), std::move(masks));
  }
  std::vector<std::size_t> places;
  for (const Vec3i& origin : moved.topology.index().origins()) {
    places.push_back(std::size_t(all.find(origin)));
  }
  moved.vectors.place_at(places, all.brick_count());
  return {std::move(all), std::move(moved.vectors)};
}

bool Inversion::solve_changed(const VectorBricks& u, const std::vector<std::int32_t>& changed,
                              std::vector<Vec3i>& touched, VectorBricks& offsets) {
  // Bricks that the cells with a changed corner reached, and those that they reach now.
  const std::vector<std::int32_t> affected = with_lower_neighbours(u.topology, changed);
  BrickIndex reached;
  const auto add = [&](const Vec3i& origin) { reached.add(origin); };
  const auto add_reached = [&] {
    for (const std::int32_t b : affected) {
      const IndexBox& reach = m_sources[std::size_t(m_source_of[std::size_t(b)])].reach;
      if (is_torn(reach)) return false;
      if (!reach.empty()) for_bricks_of(reach.lo, reach.hi, add);
    }
    return true;
  };
  for (const std::int32_t b : affected) {
    const Vec3i& origin = u.topology.origin(std::size_t(b));
    if (rests(b)) for_bricks_of(origin, origin + Vec3i(kBrickDim), add);
  }
  add_sources(affected);
  if (!add_reached()) return false;
  m_ranges.update(u, changed);
  place(u, affected);
  if (!add_reached()) return false;
  touched = reached.origins();
  std::sort(touched.begin(), touched.end(), voxel_less);

  // Every brick that reaches them takes part, changed or not.
  const auto is_touched = [&](const Vec3i& node) { return reached.find(node) >= 0; };
  m_unresolved.erase(std::remove_if(m_unresolved.begin(), m_unresolved.end(), is_touched),
                     m_unresolved.end());
  for (const Vec3i& origin : touched) m_overlaps.erase(origin);
  OffsetAccumulator accumulator(touched);
  std::vector<std::uint8_t> takes_part(m_sources.size());
  parallel_for(takes_part.size(), [&](std::size_t n) {
    takes_part[n] = accumulator.is_reached_by(m_sources[n].reach);
  });
  for (const std::int32_t b : affected) {
    takes_part[std::size_t(m_source_of[std::size_t(b)])] = 1;
  }
  std::vector<std::size_t> sources;
  for (std::size_t n = 0; n < takes_part.size(); ++n) {
    if (takes_part[n]) sources.push_back(n);
  }
  offsets = solve_sources(u, sources, accumulator, nullptr);
  return true;
}

FoldedCells Inversion::folded() const {
  FoldedCells folded;
  for (const Source& source : m_sources) {
    if (mask_count(source.folded) > 0) folded.add(source.brick, source.folded);
  }
  return folded;
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
  certificate.of_part = m_is_partial;
  for (const std::int16_t cells : m_resting_cells) certificate.cells += cells;
  for (const Source& source : m_sources) {
    const BrickFindings& findings = source.findings;
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

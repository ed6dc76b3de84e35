#include "volumes/field/inversion/brick_solver.h"

#include <algorithm>
#include <cmath>

#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/padded_rows.h"

namespace supple {

namespace {

// Single precision cannot promise less.
constexpr double kLaneTolerance = 5e-5;

int count_common(const BrickMask& a, const BrickMask& b) {
  BrickMask both;
  for (int word = 0; word < 8; ++word) both[word] = a[word] & b[word];
  return mask_count(both);
}

/// Turns the corners of a cell into those of the half voxel beside it, where its motion goes on
/// linearly.
void go_beyond(CellCorners& corners, int axis, int side) {
  const int across = 4 >> axis;  // from a lower corner to the upper one
  for (auto& p : corners.p) {
    for (int n = 0; n < kCellCorners; ++n) {
      if (cell_corner(n)[axis] == 1) continue;
      double &lower = p[n], &upper = p[n + across];
      const double inner = side < 0 ? lower : upper;
      const double outer = inner + (side < 0 ? lower - upper : upper - lower) * kBeyondBorder;
      lower = side < 0 ? outer : inner;
      upper = side < 0 ? inner : outer;
    }
  }
}

}  // namespace

/// Adds a solution; along an axis with one slice only one from that slice, not from its copies.
void BrickSolver::add_hit(const Vec3i& node, const Vec3d& source, const Vec3f& o) {
  for (int a = 0; a < 3; ++a) {
    if (m_dims[a] == 1 && !(source[a] > -0.5 && source[a] <= 0.5)) return;
  }
  m_results.hits.push_back({node, o});
}

/// The cells at the border of the volume go on for half a voxel, as the voxels there do. What lies
/// there is no more than the surface of tissue.
void BrickSolver::solve_borders(const SourceCells& cells, const CellContents& contents) {
  Vec3i lower(-1), upper(-1);  // of the cells that lie there, in the brick
  for (int a = 0; a < 3; ++a) {
    if (m_dims[a] == 1) continue;
    if (cells.origin[a] == 0) lower[a] = 0;
    upper[a] = m_dims[a] - 2 - cells.origin[a];
  }
  const auto is_in_brick = [](int at) { return at >= 0 && at < kBrickDim; };
  const std::size_t first = m_results.hits.size();
  for (int n = 0; n < 27; ++n) {
    const Vec3i side = surrounding_step(n);
    IndexBox beside{Vec3i(0), Vec3i(kBrickDim - 1)};  // the cells at this side of the volume
    for (int a = 0; a < 3; ++a) {
      if (side[a] == 0) continue;
      beside.lo[a] = beside.hi[a] = side[a] < 0 ? lower[a] : upper[a];
    }
    const bool is_beyond = side != Vec3i(0) && is_in_brick(beside.lo.x) &&
                           is_in_brick(beside.lo.y) && is_in_brick(beside.lo.z);
    if (!is_beyond) continue;
    for (int x = beside.lo.x; x <= beside.hi.x; ++x) {
      for (int y = beside.lo.y; y <= beside.hi.y; ++y) {
        for (int z = beside.lo.z; z <= beside.hi.z; ++z) {
          const int offset = brick_offset({x, y, z});
          if (mask_test(cells.mask, offset)) solve_beyond(cells, offset, side);
        }
      }
    }
  }
  for (std::size_t n = first; n < m_results.hits.size(); ++n) {
    auto& hit = m_results.hits[n];
    hit.content =
        std::min(contents.at(Vec3d(hit.node - cells.origin) + Vec3d(hit.o)), Content::surface);
  }
}

/// Solves the half voxel beside a cell, on the sides that are not 0.
void BrickSolver::solve_beyond(const SourceCells& cells, int offset, const Vec3i& side) {
  const Vec3i cell = cells.origin + brick_local(offset);
  Vec3f shift;
  const bool is_shifted = is_translated(cells, offset, shift);
  if (is_shifted && shift == Vec3f(0)) return;
  Vec3d low(0), size(1);  // of the part, in the frame of the cell
  for (int a = 0; a < 3; ++a) {
    if (side[a] != 0) size[a] = kBeyondBorder;
    if (side[a] != 0) low[a] = side[a] < 0 ? -kBeyondBorder : 1;
  }
  CellCorners corners = cell_corners(cells, offset);
  for (int a = 0; a < 3; ++a) {
    if (side[a] != 0) go_beyond(corners, a, side[a]);
  }
  const IndexBox nodes = nodes_of(corners, cell);
  if (nodes.empty()) return;
  const bool folded = min_corner_det(corners) <= 0 || is_folded(corners);
  const DeformedCell deformed(corners, folded);
  const auto part_of = [&](const Vec3d& node, Vec3d& part) {
    if (is_shifted) {
      for (int a = 0; a < 3; ++a) part[a] = (node[a] - double(shift[a]) - low[a]) / size[a];
      return std::min({part.x, part.y, part.z}) >= 0 && std::max({part.x, part.y, part.z}) <= 1;
    }
    const double tolerance = m_params.residual_tolerance_voxels;
    auto outcome = deformed.solve(node, tolerance, m_params.max_newton_steps, part);
    if (outcome == DeformedCell::Outcome::undecided) {
      outcome = deformed.solve_by_bisection(node, tolerance, m_params.max_newton_steps, part);
    }
    return outcome == DeformedCell::Outcome::inside;
  };
  for (int x = nodes.lo.x; x <= nodes.hi.x; ++x) {
    for (int y = nodes.lo.y; y <= nodes.hi.y; ++y) {
      for (int z = nodes.lo.z; z <= nodes.hi.z; ++z) {
        const Vec3d node(x, y, z);
        Vec3d local;
        if (!part_of(node, local)) continue;
        bool is_beyond = true;
        for (int a = 0; a < 3; ++a) {
          local[a] = low[a] + local[a] * size[a];
          is_beyond &= side[a] == 0 || (side[a] < 0 ? -local[a] : local[a] - 1) > 0;
        }
        if (!is_beyond) continue;
        const Vec3f o = is_shifted ? Vec3f(0) - shift : Vec3f(local - node);
        add_hit(cell + Vec3i(x, y, z), Vec3d(cell) + local, o);
      }
    }
  }
}

/// All corners moved alike: o = -shift at the nodes of the moved unit cube, exactly. Those of a
/// face in a lattice plane are left to the complete cell on its upper side.
void BrickSolver::translate_cell(const SourceCells& cells, int offset, const Vec3f& shift) {
  const Vec3i in_brick = brick_local(offset), cell = cells.origin + in_brick;
  const Vec3d u(shift);
  const Vec3i lo(int(std::ceil(u.x)), int(std::ceil(u.y)), int(std::ceil(u.z)));
  Vec3i hi(int(std::floor(u.x + 1)), int(std::floor(u.y + 1)), int(std::floor(u.z + 1)));
  constexpr int kStep[3] = {64, 8, 1};
  for (int a = 0; a < 3; ++a) {
    const bool has_upper = in_brick[a] + 1 < kBrickDim && mask_test(cells.mask, offset + kStep[a]);
    if (has_upper && hi[a] == u[a] + 1) --hi[a];
  }
  const Vec3f o = Vec3f(0) - shift;
  for (int x = lo.x; x <= hi.x; ++x) {
    for (int y = lo.y; y <= hi.y; ++y) {
      for (int z = lo.z; z <= hi.z; ++z) {
        const Vec3i node = cell + Vec3i(x, y, z);
        add_hit(node, Vec3d(node) - u, o);
      }
    }
  }
}

void BrickSolver::solve_cell(const CellCorners& corners, const Vec3i& cell, bool folded) {
  const IndexBox nodes = nodes_of(corners, cell);
  if (nodes.empty()) return;

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
          add_hit(cell + Vec3i(x, y, z), Vec3d(cell) + local, Vec3f(local - node));
        } else if (outcome == DeformedCell::Outcome::undecided) {
          m_results.doubts.push_back({cell + Vec3i(x, y, z), cell});
        }
      }
    }
  }
}

BrickFindings BrickSolver::solve(const SourceCells& cells, const CellContents& contents,
                                 BrickMask& folded) {
  m_results.hits.clear();
  m_results.doubts.clear();
  m_results.still = {};
  m_results.suspects = {};
  BrickFindings findings;
  findings.cells = mask_count(cells.mask);
  BrickMask rest = cells.mask;
  const bool flat = is_flat(m_dims);
  if (!flat && m_params.residual_tolerance_voxels >= kLaneTolerance) {
    rest = m_lanes.solve(cells, contents.tissue_cells(), m_params.residual_tolerance_voxels,
                         m_results, findings.min_det);
  }
  for_each_active(rest, [&](int offset) {
    const Vec3i cell = cells.origin + brick_local(offset);
    Vec3f shift;
    if (is_translated(cells, offset, shift)) {
      if (shift == Vec3f(0) && !flat) {
        mask_set(m_results.still, offset);
      } else {
        translate_cell(cells, offset, shift);
      }
      return;
    }
    const CellCorners corners = cell_corners(cells, offset);
    const double min_det = min_corner_det(corners);
    const bool is_tissue = mask_test(contents.tissue_cells(), offset);
    if (is_tissue) findings.min_det = std::min(findings.min_det, min_det);
    const bool is_fold = min_det <= 0 || is_folded(corners);
    solve_cell(corners, cell, is_fold);
    if (is_fold) mask_set(folded, offset);
  });
  // Lanes give one solution of several; the accumulator chooses among all.
  for_each_active(m_results.suspects, [&](int offset) {
    const CellCorners corners = cell_corners(cells, offset);
    if (!is_folded(corners)) return;
    solve_cell(corners, cells.origin + brick_local(offset), true);
    mask_set(folded, offset);
  });
  findings.folded_cells = mask_count(folded);
  findings.folded_air_cells = findings.folded_cells - count_common(folded, contents.tissue_cells());
  set_contents(cells, contents);
  solve_borders(cells, contents);
  return findings;
}

void BrickSolver::set_contents(const SourceCells& cells, const CellContents& contents) {
  if (contents.is_all_tissue()) return;
  for (auto& hit : m_results.hits) {
    hit.content = contents.at(Vec3d(hit.node - cells.origin) + Vec3d(hit.o));
  }
  for (OpenNode& doubt : m_results.doubts) {
    doubt.content = contents.best_in(brick_offset(doubt.cell));
  }
}

bool BrickSolver::settle(const VectorBricks& u, const OpenNode& doubt, const CellContents& contents,
                         bool& covered) {
  m_results.hits.clear();
  CellCorners corners;
  for (int c = 0; c < 8; ++c) {
    const Vec3i step = cell_corner(c);
    Vec3f moved(0);
    u.at(doubt.cell + step, moved);
    for (int a = 0; a < 3; ++a) corners.p[a][c] = step[a] + double(moved[a]);
  }
  const Vec3d x(doubt.node - doubt.cell);
  Vec3d local;
  const auto outcome = DeformedCell(corners, is_folded(corners))
                           .solve_by_bisection(x, m_params.residual_tolerance_voxels,
                                               m_params.max_newton_steps, local);
  covered = outcome == DeformedCell::Outcome::undecided && covered_by_tetrahedra(corners, x);
  if (outcome != DeformedCell::Outcome::inside) return false;
  add_hit(doubt.node, Vec3d(doubt.cell) + local, Vec3f(local - x));
  if (m_results.hits.empty()) return false;
  m_results.hits.front().content =
      contents.at(Vec3d(brick_local(brick_offset(doubt.cell))) + local);
  return true;
}

}  // namespace supple

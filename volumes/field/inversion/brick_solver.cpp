#include "volumes/field/inversion/brick_solver.h"

#include <algorithm>
#include <cmath>

#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

// Single precision cannot promise less.
constexpr double kLaneTolerance = 5e-5;

int count_common(const BrickMask& a, const BrickMask& b) {
  BrickMask both;
  for (int word = 0; word < 8; ++word) both[word] = a[word] & b[word];
  return mask_count(both);
}

}  // namespace

/// Along an axis with one slice only what comes from that slice counts, not from its copies.
void BrickSolver::add_hit(const Vec3i& node, const Vec3d& source, const Vec3f& o) {
  for (int a = 0; a < 3; ++a) {
    if (m_dims[a] == 1 && !(source[a] > -0.5 && source[a] <= 0.5)) return;
  }
  m_results.hits.push_back({node, o});
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
  if (contents.is_all_tissue()) return findings;
  for (auto& hit : m_results.hits) {
    hit.content = contents.at(Vec3d(hit.node - cells.origin) + Vec3d(hit.o));
  }
  for (OpenNode& doubt : m_results.doubts) {
    doubt.content = contents.best_in(brick_offset(doubt.cell));
  }
  return findings;
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

#include "volumes/field/dense/unfolded_extension.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"
#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/field/split_offsets.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

constexpr int kPasses = 20;

/// A voxel and those that share a face with it.
template <class Visit>
void for_cross(const Vec3i& voxel, Visit&& visit) {
  visit(voxel);
  for (int face = 0; face < 6; ++face) {
    Vec3i next = voxel;
    next[face / 2] += face % 2 ? 1 : -1;
    visit(next);
  }
}

bool is_folded_at(const Vec3d (&moved)[kCellCorners]) {
  CellCorners corners;
  for (int n = 0; n < kCellCorners; ++n) {
    for (int a = 0; a < 3; ++a) corners.p[a][n] = moved[n][a];
  }
  return is_folded(corners);
}

}  // namespace

UnfoldedExtension::UnfoldedExtension(const OffsetField& offsets, const BrickTopology* elements)
    : m_offsets(offsets), m_elements(elements), m_smooth(offsets.o) {
  const Vec3i& dims = offsets.geometry.dims();
  if (std::min({dims.x, dims.y, dims.z}) == 1) return;
  std::vector<Vec3i> folded = all_folded_cells();
  for (int pass = 0; pass < kPasses && !folded.empty(); ++pass) folded = smooth(folded);
}

Vec3d UnfoldedExtension::at(const Vec3i& voxel) const {
  const auto replaced = m_replaced.find(voxel);
  return replaced != m_replaced.end() ? replaced->second : m_smooth.at(voxel);
}

bool UnfoldedExtension::is_folded_cell(const Vec3i& cell) const {
  Vec3d moved[kCellCorners];
  for (int n = 0; n < kCellCorners; ++n) {
    moved[n] = Vec3d(cell_corner(n)) + at(cell + cell_corner(n));
  }
  return is_folded_at(moved);
}

bool UnfoldedExtension::is_fixed(const Vec3i& voxel) const {
  if (m_offsets.split != nullptr && m_offsets.split->bricks().find(voxel) >= 0) return true;
  Vec3f offset;
  if (!m_offsets.o.at(voxel, offset)) return false;
  return m_elements == nullptr ||
         m_elements->is_active(floor_voxel(Vec3d(voxel) + Vec3d(offset) + Vec3d(0.5)));
}

std::vector<Vec3i> UnfoldedExtension::all_folded_cells() const {
  const BrickTopology bricks = touching_bricks(m_offsets.o.topology);
  std::vector<std::vector<Vec3i>> found(bricks.brick_count());
  constexpr int kNodes = kBrickDim + 1;
  parallel_for(bricks.brick_count(), [&](std::size_t b) {
    const Vec3i& origin = bricks.origin(b);
    std::vector<Vec3d> offsets;
    for (int n = 0; n < kNodes * kNodes * kNodes; ++n) {
      offsets.push_back(
          m_smooth.at(origin + Vec3i(n / (kNodes * kNodes), n / kNodes % kNodes, n % kNodes)));
    }
    for (int local = 0; local < kBrickVoxels; ++local) {
      Vec3d moved[kCellCorners];
      bool is_translated = true;
      for (int n = 0; n < kCellCorners; ++n) {
        const Vec3i node = brick_local(local) + cell_corner(n);
        const Vec3d& o = offsets[std::size_t((node.x * kNodes + node.y) * kNodes + node.z)];
        moved[n] = Vec3d(cell_corner(n)) + o;
        is_translated = is_translated && moved[n] - Vec3d(cell_corner(n)) == moved[0];
      }
      if (!is_translated && is_folded_at(moved)) found[b].push_back(origin + brick_local(local));
    }
  });
  std::vector<Vec3i> folded;
  for (const auto& part : found) folded.insert(folded.end(), part.begin(), part.end());
  return folded;
}

std::vector<Vec3i> UnfoldedExtension::smooth(const std::vector<Vec3i>& folded) {
  std::vector<Vec3i> nodes, cells;
  for (const Vec3i& cell : folded) {
    for (int n = 0; n < kCellCorners; ++n) {
      for_cross(cell + cell_corner(n), [&](const Vec3i& node) { nodes.push_back(node); });
    }
  }
  sort_unique(nodes);
  std::vector<std::pair<Vec3i, Vec3d>> means;
  for (const Vec3i& node : nodes) {
    if (is_fixed(node)) continue;
    Vec3d sum(0);
    for_cross(node, [&](const Vec3i& near) { sum += at(near); });
    means.emplace_back(node, (sum - at(node)) / 6.0);
    for (int n = 0; n < kCellCorners; ++n) cells.push_back(node - cell_corner(n));
  }
  for (const auto& [node, mean] : means) m_replaced[node] = mean;
  cells.insert(cells.end(), folded.begin(), folded.end());
  sort_unique(cells);
  const auto is_whole = [&](const Vec3i& cell) { return !is_folded_cell(cell); };
  cells.erase(std::remove_if(cells.begin(), cells.end(), is_whole), cells.end());
  return cells;
}

Vec3d UnfoldedExtension::sample(const Vec3d& pos_index) const {
  if (!is_replaced(pos_index)) return m_smooth.sample(pos_index);
  const Vec3i low = floor_voxel(pos_index);
  const Vec3d t = pos_index - Vec3d(low);
  Vec3d sum(0);
  for (int n = 0; n < kCellCorners; ++n) {
    const Vec3i step = cell_corner(n);
    double weight = 1;
    for (int a = 0; a < 3; ++a) weight *= step[a] ? t[a] : 1 - t[a];
    if (weight > 0) sum += at(low + step) * weight;
  }
  return sum;
}

bool UnfoldedExtension::is_replaced(const Vec3d& pos_index) const {
  if (m_replaced.empty()) return false;
  const Vec3i low = floor_voxel(pos_index);
  for (int n = 0; n < kCellCorners; ++n) {
    const Vec3i step = cell_corner(n);
    bool has_weight = true;
    for (int a = 0; a < 3; ++a) has_weight = has_weight && (step[a] == 0 || pos_index[a] > low[a]);
    if (has_weight && m_replaced.count(low + step) != 0) return true;
  }
  return false;
}

}  // namespace supple

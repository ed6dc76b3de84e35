#include "volumes/field/cuts/upper_nodes.h"

#include <algorithm>
#include <cstring>

#include "volumes/grid/cell.h"

namespace supple {

namespace {

/// The cells of a brick that have a corner at a node, relative to its lowest voxel.
BrickMask cells_at(const Vec3i& node) {
  BrickMask cells{};
  for (int n = 0; n < kCellCorners; ++n) {
    const Vec3i cell = node - cell_corner(n);
    if (std::min({cell.x, cell.y, cell.z}) < 0) continue;
    if (std::max({cell.x, cell.y, cell.z}) < kBrickDim) mask_set(cells, brick_offset(cell));
  }
  return cells;
}

}  // namespace

BrickMask UpperNodes::follow(const VectorBrickFinder& lattice, const Vec3i& origin) {
  std::array<VectorBrickView, kCellCorners> views;
  for (int n = 1; n < kCellCorners; ++n) {
    views[std::size_t(n)] = lattice(origin + cell_corner(n) * kBrickDim);
  }
  BrickMask changed{};
  std::size_t number = 0;
  for (int at = 0; at < 9 * 9 * 9; ++at) {
    const Vec3i node(at / 81, at / 9 % 9, at % 9);
    const int above = 4 * (node.x >> 3) + 2 * (node.y >> 3) + (node.z >> 3);
    if (above == 0) continue;
    const std::size_t n = number++;
    const VectorBrickView& view = views[std::size_t(above)];
    const bool is_valid = view.mask != nullptr && mask_test(*view.mask, brick_offset(node));
    const Vec3f vector = is_valid ? view.vectors[brick_offset(node)] : Vec3f(0);
    if (m_are_known && m_valid[n] == is_valid &&
        std::memcmp(&m_vectors[n], &vector, sizeof vector) == 0) {
      continue;
    }
    m_valid[n] = is_valid;
    m_vectors[n] = vector;
    const BrickMask cells = cells_at(node);
    for (std::size_t word = 0; word < cells.size(); ++word) changed[word] |= cells[word];
  }
  m_are_known = true;
  return changed;
}

}  // namespace supple

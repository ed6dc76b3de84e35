#include "volumes/field/cuts/torn_cells.h"

#include <algorithm>

#include "volumes/base/parallel.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

BrickList TornCells::follow(const VectorBricks& u, const CutBody& body, const BrickList& moved,
                            const BrickList& parted, double closed) {
  const BrickList planned = with_neighbours(body.cells(), parted);
  const BrickList seeing = unite(planned, with_neighbours(body.cells(), moved));
  const BrickList bricks = bricks_where(
      seeing, [&](std::size_t b) { return !m_cells[b].empty() || !body.parted_in(b).empty(); });
  std::vector<std::vector<TornCell>> found(bricks.size());
  parallel_for(bricks.size(), [&](std::size_t n) {
    const auto b = std::size_t(bricks[n]);
    const bool is_other = std::binary_search(planned.begin(), planned.end(), bricks[n]);
    if (is_other) m_nodes[b].reset();
    if (body.parted_in(b).empty()) return;
    if (!m_nodes[b]) m_nodes[b] = std::make_unique<VirtualNodes>(u.topology, body, b);
    found[n] = m_nodes[b]->torn(u.vectors, closed);
  });
  BrickList others;
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    std::vector<TornCell>& cells = m_cells[std::size_t(bricks[n])];
    if (cells == found[n]) continue;
    m_count += std::int64_t(found[n].size()) - std::int64_t(cells.size());
    cells = std::move(found[n]);
    others.push_back(bricks[n]);
  }
  return others;
}

bool TornCells::holds(const Vec3i& cell) const {
  const std::int32_t b = m_bricks.find(cell);
  if (b < 0) return false;
  const std::vector<TornCell>& cells = m_cells[std::size_t(b)];
  const auto found = std::lower_bound(
      cells.begin(), cells.end(), cell,
      [](const TornCell& torn, const Vec3i& at) { return voxel_less(torn.cell, at); });
  return found != cells.end() && found->cell == cell;
}

}  // namespace supple

#include "volumes/io/load/brick_store.h"

#include <limits>

#include "volumes/base/parallel.h"

namespace supple {

DensityGrid BrickStore::take_above(float background) {
  std::vector<BrickMask> masks(m_bricks.size());
  parallel_for(m_bricks.size(), [&](std::size_t n) {
    masks[n] = m_bricks[n].above(background);
    m_bricks[n].note_extremes(masks[n]);
  });
  return take_masked(std::move(masks), background);
}

DensityGrid BrickStore::take_grid(const BrickTopology& where, float background) {
  constexpr float kLowest = -std::numeric_limits<float>::infinity();  // only NaN is not above
  std::vector<BrickMask> masks(m_bricks.size(), BrickMask{});
  parallel_for(m_bricks.size(), [&](std::size_t n) {
    const std::int32_t wanted = where.find(m_bricks[n].origin);
    if (wanted < 0) return;
    masks[n] = m_bricks[n].above(kLowest);
    for (int word = 0; word < 8; ++word) masks[n][word] &= where.mask(wanted)[word];
    m_bricks[n].note_extremes(masks[n]);
  });
  return take_masked(std::move(masks), background);
}

/// Bricks with an empty mask are freed first.
DensityGrid BrickStore::take_masked(std::vector<BrickMask> masks, float background) {
  std::vector<Vec3i> origins(m_bricks.size());
  for (std::size_t n = 0; n < m_bricks.size(); ++n) origins[n] = m_bricks[n].origin;
  BrickTopology topology(std::move(origins), std::move(masks));
  std::vector<SlabBrick*> sources(topology.brick_count());
  for (SlabBrick& brick : m_bricks) {
    const std::int32_t b = topology.find(brick.origin);
    if (b >= 0)
      sources[b] = &brick;
    else
      brick.leaf = DensityLeaf();
  }
  const auto take = [&](std::size_t b) { return sources[b]->take_leaf(); };
  DensityGrid grid = assemble_density_grid(std::move(topology), take, background);
  m_bricks.clear();
  return grid;
}

}  // namespace supple

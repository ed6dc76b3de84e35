#include "volumes/field/cuts/moved_bricks.h"

#include <algorithm>
#include <cstring>

#include "volumes/base/parallel.h"

namespace supple {

DisplacedBricks all_moved(const BrickTopology& topology) {
  DisplacedBricks moved(topology.brick_count());
  for (std::size_t b = 0; b < moved.size(); ++b) {
    moved[b].number = std::int32_t(b);
    moved[b].voxels = topology.mask(b);
  }
  return moved;
}

BrickList numbers_of(const DisplacedBricks& moved) {
  BrickList numbers;
  for (const DisplacedBrick& brick : moved) numbers.push_back(brick.number);
  return numbers;
}

const DisplacedBrick* find_moved(const DisplacedBricks& moved, std::int32_t number) {
  const auto found = std::lower_bound(
      moved.begin(), moved.end(), number,
      [](const DisplacedBrick& brick, std::int32_t b) { return brick.number < b; });
  return found != moved.end() && found->number == number ? &*found : nullptr;
}

KeptVectors::KeptVectors(const VectorBricks& u, const BrickList& bricks) : m_kept(bricks.size()) {
  parallel_for(bricks.size(), [&](std::size_t n) {
    m_kept[n].number = bricks[n];
    const Vec3f* const vectors = u.vectors.brick_or_zero(std::size_t(bricks[n]));
    m_kept[n].before.assign(vectors, vectors + kBrickVoxels);
  });
}

DisplacedBricks KeptVectors::moved(const VectorBricks& u) {
  parallel_for(m_kept.size(), [&](std::size_t n) {
    const Vec3f* const now = u.vectors.brick_or_zero(std::size_t(m_kept[n].number));
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      const Vec3f& before = m_kept[n].before[std::size_t(offset)];
      if (std::memcmp(&now[offset], &before, sizeof before) != 0) {
        mask_set(m_kept[n].voxels, offset);
      }
    }
  });
  m_kept.erase(
      std::remove_if(m_kept.begin(), m_kept.end(),
                     [](const DisplacedBrick& brick) { return mask_count(brick.voxels) == 0; }),
      m_kept.end());
  return std::move(m_kept);
}

}  // namespace supple

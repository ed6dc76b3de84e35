#include "lib/fem/voxel/transfer.h"

#include <algorithm>

#include "lib/fem/voxel/element_matrix.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Corners that share in a place among the 27 of a cell.
struct PlaceWeights {
  int count = 0;
  int corner[8];
  float weight[8];
};

std::array<PlaceWeights, 27> weights_of_places() {
  std::array<PlaceWeights, 27> all;
  for (int place = 0; place < 27; ++place) {
    const Vec3d halves(Vec3i(place / 9, place / 3 % 3, place % 3));
    const std::array<double, 8> weights = corner_weights(halves / 2.0);
    for (int c = 0; c < 8; ++c) {
      if (weights[c] == 0) continue;
      all[place].corner[all[place].count] = c;
      all[place].weight[all[place].count++] = float(weights[c]);
    }
  }
  return all;
}
const std::array<PlaceWeights, 27> kPlaceWeights = weights_of_places();

}  // namespace

/// Calls visit(node, weights, corners of the coarse element around it) for the nodes that a block
/// of the fine mesh met first. The coarse elements around these lie in one block.
template <class Visit>
void Transfer::for_nodes_of_block(std::size_t block, Visit&& visit) const {
  const NodeIndex begin = m_fine->node_begin[block], end = m_fine->node_begin[block + 1];
  if (begin == end) return;
  const std::size_t coarse_block = m_coarse->block_of(m_coarsening->parent_of_node(block, begin));
  for (NodeIndex n = begin; n < end; ++n) {
    visit(std::size_t(n), kPlaceWeights[m_coarsening->node_place[n]],
          m_coarse->corners_in(coarse_block, m_coarsening->parent_of_node(block, n)));
  }
}

void Transfer::prolong(const float* coarse, const ShortFloat* inverse_diagonal, float* fine) const {
  const auto prolong_to = [&](std::size_t n, const PlaceWeights& weights, const Corners& corners) {
    float sum[3] = {0, 0, 0};
    for (int w = 0; w < weights.count; ++w) {
      const float* from = coarse + 3 * std::size_t(corners[weights.corner[w]]);
      for (int a = 0; a < 3; ++a) sum[a] += weights.weight[w] * from[a];
    }
    for (int a = 0; a < 3; ++a) {
      const std::size_t at = 3 * n + a;
      fine[at] = inverse_diagonal[at] == 0 ? 0 : sum[a];
    }
  };
  parallel_for(std::size_t(m_fine->block_count()),
               [&](std::size_t b) { for_nodes_of_block(b, prolong_to); });
}

void Transfer::restrict_to(const float* fine, const ShortFloat* inverse_diagonal,
                           float* coarse) const {
  std::fill_n(coarse, 3 * std::size_t(m_coarse->node_count()), 0.0f);
  const auto restrict_from = [&](std::size_t n, const PlaceWeights& weights,
                                 const Corners& corners) {
    float value[3];
    for (int a = 0; a < 3; ++a) {
      const std::size_t at = 3 * n + a;
      value[a] = inverse_diagonal[at] == 0 ? 0 : fine[at];
    }
    for (int w = 0; w < weights.count; ++w) {
      float* to = coarse + 3 * std::size_t(corners[weights.corner[w]]);
      for (int a = 0; a < 3; ++a) to[a] += weights.weight[w] * value[a];
    }
  };
  for (const std::vector<std::int32_t>& blocks : m_fine->of_colour) {
    parallel_for(blocks.size(),
                 [&](std::size_t b) { for_nodes_of_block(std::size_t(blocks[b]), restrict_from); });
  }
}

}  // namespace supple

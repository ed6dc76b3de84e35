#include "lib/fem/transfer.h"

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lib/fem/element_matrix.h"

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
    const std::array<double, 8> weights =
        corner_weights({place / 9 / 2.0, place / 3 % 3 / 2.0, place % 3 / 2.0});
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

void Transfer::prolong(const float* coarse, const float* inverse_diagonal, float* fine) const {
  const auto work = [&](const tbb::blocked_range<NodeIndex>& range) {
    for (NodeIndex n = range.begin(); n < range.end(); ++n) {
      const PlaceWeights& weights = kPlaceWeights[m_coarsening->node_place[n]];
      const Corners& corners = m_coarse->corners[m_coarsening->node_parent[n]];
      float sum[3] = {0, 0, 0};
      for (int w = 0; w < weights.count; ++w) {
        const float* from = coarse + 3 * std::size_t(corners[weights.corner[w]]);
        for (int a = 0; a < 3; ++a) sum[a] += weights.weight[w] * from[a];
      }
      for (int a = 0; a < 3; ++a) {
        const std::size_t at = 3 * std::size_t(n) + a;
        fine[at] = inverse_diagonal[at] == 0 ? 0 : sum[a];
      }
    }
  };
  tbb::parallel_for(tbb::blocked_range<NodeIndex>(0, m_fine->node_count(), 2048), work);
}

void Transfer::restrict_to(const float* fine, const float* inverse_diagonal, float* coarse) const {
  std::fill_n(coarse, 3 * std::size_t(m_coarse->node_count()), 0.0f);
  // The coarse elements around the nodes that a block met first lie in that block.
  for (const std::vector<std::int32_t>& blocks : m_fine->of_colour) {
    const auto work = [&](const tbb::blocked_range<std::size_t>& range) {
      for (std::size_t b = range.begin(); b < range.end(); ++b) {
        for (NodeIndex n = m_fine->node_begin[blocks[b]]; n < m_fine->node_begin[blocks[b] + 1];
             ++n) {
          const PlaceWeights& weights = kPlaceWeights[m_coarsening->node_place[n]];
          const Corners& corners = m_coarse->corners[m_coarsening->node_parent[n]];
          float value[3];
          for (int a = 0; a < 3; ++a) {
            const std::size_t at = 3 * std::size_t(n) + a;
            value[a] = inverse_diagonal[at] == 0 ? 0 : fine[at];
          }
          for (int w = 0; w < weights.count; ++w) {
            float* to = coarse + 3 * std::size_t(corners[weights.corner[w]]);
            for (int a = 0; a < 3; ++a) to[a] += weights.weight[w] * value[a];
          }
        }
      }
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.size(), 1), work);
  }
}

}  // namespace supple

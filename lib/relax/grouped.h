// Items of clusters, those of each side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace supple {

/// Fills `items` with the items of cluster 0, then of 1, …, each in the order of `pairs` (cluster,
/// item), and `first` with where each cluster begins, one more at the end.
template <class Item>
void group_by_cluster(const std::vector<std::pair<std::uint32_t, Item>>& pairs,
                      std::size_t clusters, std::vector<Item>& items,
                      std::vector<std::uint32_t>& first) {
  first.assign(clusters + 1, 0);
  for (const auto& [cluster, item] : pairs) ++first[cluster + 1];
  for (std::size_t c = 0; c < clusters; ++c) first[c + 1] += first[c];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  items.resize(pairs.size());
  for (const auto& [cluster, item] : pairs) items[next[cluster]++] = item;
}

}  // namespace supple

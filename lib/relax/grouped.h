// Items of clusters, those of each side by side.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "volumes/base/parallel.h"

namespace supple {

/// Items, each with its cluster.
template <class Item>
using ClusteredItems = std::vector<std::pair<std::uint32_t, Item>>;

/// Fills `items` with the items of cluster 0, then of 1, …, each in the order of `parts` one after
/// another, and `first` with where each cluster begins, one more at the end.
template <class Item>
void group_by_cluster(std::vector<ClusteredItems<Item>> parts, std::size_t clusters,
                      std::vector<Item>& items, std::vector<std::uint32_t>& first) {
  struct Run {
    std::uint32_t cluster, begin, end;
    std::uint32_t place;  // in `items`
  };
  std::vector<std::vector<Run>> runs(parts.size());
  parallel_for(parts.size(), Grain{4}, [&](std::size_t p) {
    ClusteredItems<Item>& part = parts[p];
    const auto before = [](const auto& a, const auto& b) { return a.first < b.first; };
    if (!std::is_sorted(part.begin(), part.end(), before)) {
      std::stable_sort(part.begin(), part.end(), before);
    }
    for (std::uint32_t n = 0; n < part.size(); ++n) {
      if (n == 0 || part[n].first != part[n - 1].first) runs[p].push_back({part[n].first, n, n, 0});
      runs[p].back().end = n + 1;
    }
  });
  first.assign(clusters + 1, 0);
  for (const std::vector<Run>& of_part : runs) {
    for (const Run& run : of_part) first[run.cluster + 1] += run.end - run.begin;
  }
  for (std::size_t c = 0; c < clusters; ++c) first[c + 1] += first[c];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::vector<Run>& of_part : runs) {
    for (Run& run : of_part) {
      run.place = next[run.cluster];
      next[run.cluster] += run.end - run.begin;
    }
  }
  items.resize(first.back());
  parallel_for(parts.size(), Grain{4}, [&](std::size_t p) {
    for (const Run& run : runs[p]) {
      std::transform(parts[p].begin() + run.begin, parts[p].begin() + run.end,
                     items.begin() + run.place, [](const auto& pair) { return pair.second; });
    }
    parts[p] = {};
  });
}

}  // namespace supple

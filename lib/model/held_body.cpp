#include <algorithm>

#include "lib/model/model.h"

namespace supple {

void add_nodes(NodeSet& set, const NodeSet& more) {
  set.insert(set.end(), more.begin(), more.end());
  std::sort(set.begin(), set.end());
  set.erase(std::unique(set.begin(), set.end()), set.end());
}

void remove_nodes(NodeSet& set, const NodeSet& less) {
  NodeSet sorted = less;
  std::sort(sorted.begin(), sorted.end());
  const auto is_less = [&](int node) {
    return std::binary_search(sorted.begin(), sorted.end(), node);
  };
  set.erase(std::remove_if(set.begin(), set.end(), is_less), set.end());
}

}  // namespace supple

// Symmetric matrices of 3 x 3 blocks between nodes, in compressed rows, put together from sets of
// nodes that are coupled: elements, patches around nodes, triangles.
//
// A row is summed by whoever has it, over its sets in order: no two threads write one block, and
// sums have the same bits on any number of threads. Both halves are stored, 72 bytes per block; a
// block and its mirror image are sums of the same numbers in the same order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lib/fem/nodal_loads.h"
#include "lib/fem/operator.h"
#include "lib/fem/small_matrix.h"
#include "volumes/base/parallel.h"

namespace supple {

/// Lists of nodes, one after the other. A node may stand in a list more than once.
class NodeSets {
 public:
  void add(const NodeIndex* first, std::size_t count) {
    m_nodes.insert(m_nodes.end(), first, first + count);
    m_begin.push_back(m_nodes.size());
  }
  std::size_t size() const { return m_begin.size() - 1; }
  std::size_t count(std::size_t set) const { return m_begin[set + 1] - m_begin[set]; }
  const NodeIndex* nodes(std::size_t set) const { return m_nodes.data() + m_begin[set]; }
  std::size_t largest() const;
  std::size_t bytes() const {
    return m_nodes.capacity() * sizeof(NodeIndex) + m_begin.capacity() * sizeof(std::size_t);
  }

 private:
  std::vector<std::size_t> m_begin{0};
  std::vector<NodeIndex> m_nodes;
};

/// The sets that each node is in.
struct SetsOfNodes {
  struct Place {
    std::int32_t set, at;  // the node is the set's nodes()[at]
  };
  std::vector<std::int32_t> begin;
  std::vector<Place> places;  // by set

  SetsOfNodes(std::size_t node_count, const NodeSets& sets);
};

class BlockCsr final : public Operator {
 public:
  /// Makes room for blocks between nodes of the same set, and sets all to 0.
  BlockCsr(std::size_t node_count, const std::vector<const NodeSets*>& sets);

  /// Adds blocks: fill(set, at, blocks) writes those between the at-th node of a set and each of
  /// its nodes.
  template <class Fill>
  void add_sets(const NodeSets& sets, const Fill& fill);

  void set_zero();
  /// The same matrix where the n-th node has the axes in the rows of frames[n].
  BlockCsr in_frames(const std::vector<Matrix9>& frames) const;

  std::size_t node_count() const { return m_begin.size() - 1; }
  const std::vector<std::int64_t>& begin() const { return m_begin; }
  /// Ascending in each row.
  const std::vector<NodeIndex>& columns() const { return m_columns; }
  const std::vector<Matrix9>& blocks() const { return m_blocks; }

  void add(const float* x, double* y) const override;
  void add(const double* x, double* y) const override;
  void subtract(const double* x, double* y) const override;
  std::vector<float> diagonal() const override;
  std::size_t bytes() const override;

 private:
  template <int sign, class T>
  void multiply(const T* x, double* y) const;

  static constexpr Grain kRows{256};
  std::vector<std::int64_t> m_begin;
  std::vector<NodeIndex> m_columns;
  std::vector<Matrix9> m_blocks;
};

template <class Fill>
void BlockCsr::add_sets(const NodeSets& sets, const Fill& fill) {
  const SetsOfNodes of_node(node_count(), sets);
  struct Scratch {
    std::vector<Matrix9> blocks;
    std::vector<std::int64_t> slot_of;  // of the row's columns
  };
  PerThread<Scratch> scratches(
      Scratch{std::vector<Matrix9>(sets.largest()), std::vector<std::int64_t>(node_count())});
  parallel_ranges(node_count(), kRows, [&](std::size_t begin, std::size_t end) {
    auto& [blocks, slot_of] = scratches.local();
    for (std::size_t row = begin; row < end; ++row) {
      for (std::int64_t slot = m_begin[row]; slot < m_begin[row + 1]; ++slot) {
        slot_of[std::size_t(m_columns[std::size_t(slot)])] = slot;
      }
      for (std::int32_t n = of_node.begin[row]; n < of_node.begin[row + 1]; ++n) {
        const SetsOfNodes::Place place = of_node.places[std::size_t(n)];
        const std::size_t set = std::size_t(place.set);
        fill(set, place.at, blocks.data());
        for (std::size_t b = 0; b < sets.count(set); ++b) {
          Matrix9& to = m_blocks[std::size_t(slot_of[std::size_t(sets.nodes(set)[b])])];
          for (std::size_t m = 0; m < 9; ++m) to[m] += blocks[b][m];
        }
      }
    }
  });
}

}  // namespace supple

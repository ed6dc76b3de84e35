// Values of one block's nodes in the order of its table (node_tables.h), one component after the
// other, so that groups of elements read and write them as vectors; and the loop over all blocks in
// which threads may add to nodes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "lib/fem/voxel/element_groups.h"
#include "lib/fem/voxel/group_kernel.h"
#include "volumes/base/parallel.h"

namespace supple {

template <class T>
class BlockField {
 public:
  BlockField(const HexMesh& mesh, const ElementGroups& groups)
      : m_tables(mesh.tables),
        m_groups(groups),
        m_stride(m_tables.longest()),
        m_values(3 * m_stride) {}

  /// Loads the block from a vector of all nodes, three values each.
  template <class X>
  void load(std::int32_t block, const X* global) {
    const NodeIndex* nodes = table(block);
    const std::uint8_t* in_sequence = sequences(block);
    for (int row = 0; row < kLatticeRows; ++row) {
      const std::size_t first = 9 * std::size_t(row);
      load_one(nodes[first], first, global);
      if (in_sequence[row] != 0) {
        ElementLanes<T> points[3];
        read_points<T>(global + 3 * std::size_t(nodes[first + 1]), points);
        for (int a = 0; a < 3; ++a) {
          set_lanes(points[a], &m_values[a * m_stride + first + 1]);
        }
        continue;
      }
      for (std::size_t n = first + 1; n < first + 9; ++n) load_one(nodes[n], n, global);
    }
    for (std::size_t n = kLatticeNodes; n < table_size(block); ++n) load_one(nodes[n], n, global);
  }
  void clear(std::int32_t block) {
    for (int a = 0; a < 3; ++a) std::fill_n(&m_values[a * m_stride], table_size(block), T(0));
  }
  /// Adds `sign` times the values to a vector of all nodes.
  void add_to(std::int32_t block, T sign, T* global) const {
    const NodeIndex* nodes = table(block);
    const std::uint8_t* in_sequence = sequences(block);
    for (int row = 0; row < kLatticeRows; ++row) {
      const std::size_t first = 9 * std::size_t(row);
      add_one(nodes[first], first, sign, global);
      if (in_sequence[row] != 0) {
        const auto points = [&](int a) -> ElementLanes<T> {
          return lanes_at(&m_values[a * m_stride + first + 1]);
        };
        add_points<T>(points(0), points(1), points(2), sign,
                      global + 3 * std::size_t(nodes[first + 1]));
        continue;
      }
      for (std::size_t n = first + 1; n < first + 9; ++n) add_one(nodes[n], n, sign, global);
    }
    for (std::size_t n = kLatticeNodes; n < table_size(block); ++n) {
      add_one(nodes[n], n, sign, global);
    }
  }

  /// Corners of a group of elements, [3 corner + component].
  void read_corners(const ElementGroup& group, ElementLanes<T>* x) const {
    if (group.row == kListed) {
      for_listed(group,
                 [&](std::size_t n, int lane, std::size_t place) { x[n][lane] = m_values[place]; });
      return;
    }
    const T* first = &m_values[std::size_t(lattice_place(group.row << 3, 0))];
#pragma GCC unroll 8
    for (int c = 0; c < 8; ++c) {
      for (int a = 0; a < 3; ++a) x[3 * c + a] = lanes_at(first + a * m_stride + kCornerStep[c]);
    }
  }
  void add_corners(const ElementGroup& group, const ElementLanes<T>* x) {
    if (group.row == kListed) {
      for_listed(group, [&](std::size_t n, int lane, std::size_t place) {
        m_values[place] += x[n][lane];
      });
      return;
    }
    // Both ends of the edges along k at once: what was just stored would be waited for, if it were
    // read one place further.
    T* first = &m_values[std::size_t(lattice_place(group.row << 3, 0))];
#pragma GCC unroll 4
    for (int c = 0; c < 8; c += 2) {
      for (int a = 0; a < 3; ++a) {
        T* values = first + a * m_stride + kCornerStep[c];
        const ElementLanes<T>&low = x[3 * c + a], &high = x[3 * c + 3 + a];
        const ElementLanes<T> shifted =
            __builtin_shufflevector(high, ElementLanes<T>{}, 8, 0, 1, 2, 3, 4, 5, 6);
        set_lanes(lanes_at(values) + (low + shifted), values);
        values[kGroup] += high[kGroup - 1];
      }
    }
  }

 private:
  /// Steps from the lowest corner of an element of the lattice to its eight corners.
  static constexpr int kCornerStep[8] = {0,
                                         1,
                                         kLatticeDim,
                                         kLatticeDim + 1,
                                         kLatticeRows,
                                         kLatticeRows + 1,
                                         kLatticeRows + kLatticeDim,
                                         kLatticeRows + kLatticeDim + 1};
  static ElementLanes<T> lanes_at(const T* values) {
    ElementLanes<T> lanes;
    std::memcpy(&lanes, values, sizeof lanes);
    return lanes;
  }
  static void set_lanes(const ElementLanes<T>& lanes, T* values) {
    std::memcpy(values, &lanes, sizeof lanes);
  }
  /// Calls visit(3 corner + component, lane, place among the values).
  template <class Visit>
  void for_listed(const ElementGroup& group, Visit&& visit) const {
    const std::uint16_t* places = &m_groups.corners[group.corners];
    for (int c = 0; c < 8; ++c) {
      for (int lane = 0; lane < kGroup; ++lane, ++places) {
        for (std::size_t a = 0; a < 3; ++a)
          visit(3 * std::size_t(c) + a, lane, a * m_stride + *places);
      }
    }
  }
  const NodeIndex* table(std::int32_t block) const {
    return m_tables.nodes(std::size_t(block));
  }
  std::size_t table_size(std::int32_t block) const {
    return m_tables.size(std::size_t(block));
  }
  const std::uint8_t* sequences(std::int32_t block) const {
    return &m_groups.in_sequence[kLatticeRows * std::size_t(block)];
  }
  template <class X>
  void load_one(NodeIndex node, std::size_t n, const X* global) {
    for (int a = 0; a < 3; ++a) {
      m_values[a * m_stride + n] = node < 0 ? T(0) : T(global[3 * std::size_t(node) + a]);
    }
  }
  void add_one(NodeIndex node, std::size_t n, T sign, T* global) const {
    if (node < 0) return;
    for (int a = 0; a < 3; ++a) {
      global[3 * std::size_t(node) + a] += sign * m_values[a * m_stride + n];
    }
  }

  const NodeTables& m_tables;
  const ElementGroups& m_groups;
  std::size_t m_stride;
  std::vector<T> m_values;
};

/// Calls visit(block, scratch) for these blocks, colour by colour: blocks that are visited at the
/// same time share no node. Every range of blocks has a scratch of its own.
template <class Scratch, class Visit>
void for_blocks_by_colour(const HexMesh& mesh, const ElementGroups& groups,
                          const BlocksByColour& of_colour, Visit&& visit) {
  for (const std::vector<std::int32_t>& blocks : of_colour) {
    parallel_ranges(blocks.size(), Grain{1}, [&](std::size_t begin, std::size_t end) {
      Scratch scratch(mesh, groups);
      for (std::size_t n = begin; n < end; ++n) visit(blocks[n], scratch);
    });
  }
}

}  // namespace supple

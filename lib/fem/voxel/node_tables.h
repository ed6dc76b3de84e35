// The nodes at the corners of all elements, block by block. A block has a table of nodes: 9^3
// places of its lattice first, and behind them the further nodes of places that have several. Most
// elements have the nodes of the lattice, so that their cell says which; of the others the places
// in the table are listed.
// Memory: 2.9 kB per block, 4 bytes per further node, 36 per listed element.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/fem/nodal_loads.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

/// Nodes of a hexahedron at its corners 4 di + 2 dj + dk.
using Corners = std::array<NodeIndex, 8>;
/// Places of a hexahedron's corners in the table of its block.
using CornerPlaces = std::array<std::uint32_t, 8>;

constexpr int kLatticeDim = kBrickDim + 1;
constexpr int kLatticeRows = kLatticeDim * kLatticeDim;
constexpr int kLatticeNodes = kLatticeRows * kLatticeDim;

/// Place on the lattice of a corner of the cell with this offset in its block.
inline int lattice_place(int offset, int corner) {
  return ((offset >> 6) + (corner >> 2 & 1)) * kLatticeRows +
         ((offset >> 3 & 7) + (corner >> 1 & 1)) * kLatticeDim + (offset & 7) + (corner & 1);
}

class NodeTables {
 public:
  NodeTables() = default;
  /// Takes elements whose cells and corners these are; those of block b begin at element_begin[b].
  NodeTables(const std::vector<std::int32_t>& element_begin,
             const std::vector<std::uint16_t>& offset, const std::vector<Corners>& corners);

  /// Nodes of one block; -1 at places of the lattice without a node.
  const NodeIndex* nodes(std::size_t block) const { return &m_nodes[m_begin[block]]; }
  std::size_t size(std::size_t block) const { return m_begin[block + 1] - m_begin[block]; }
  std::size_t longest() const { return m_longest; }

  /// Places of the corners of an element of the block in the cell with this offset.
  CornerPlaces places(std::size_t block, std::int32_t element, int offset) const {
    if (m_listed_begin[block] != m_listed_begin[block + 1]) {
      const CornerPlaces* listed = find_listed(block, element);
      if (listed != nullptr) return *listed;
    }
    CornerPlaces out;
    for (int c = 0; c < 8; ++c) out[c] = std::uint32_t(lattice_place(offset, c));
    return out;
  }
  Corners corners(std::size_t block, std::int32_t element, int offset) const {
    const CornerPlaces at = places(block, element, offset);
    const NodeIndex* table = nodes(block);
    Corners out;
    for (int c = 0; c < 8; ++c) out[c] = table[at[c]];
    return out;
  }

  std::size_t bytes() const;

 private:
  void add_block(std::int32_t first, std::int32_t end, const std::vector<std::uint16_t>& offset,
                 const std::vector<Corners>& corners);
  const CornerPlaces* find_listed(std::size_t block, std::int32_t element) const;

  std::vector<NodeIndex> m_nodes;
  std::vector<std::size_t> m_begin{0};           // per block, one more than blocks
  std::vector<std::uint32_t> m_listed_begin{0};  // likewise
  std::vector<std::int32_t> m_listed;            // elements, ascending
  std::vector<CornerPlaces> m_places;            // of the listed elements
  std::size_t m_longest = kLatticeNodes;
};

}  // namespace supple

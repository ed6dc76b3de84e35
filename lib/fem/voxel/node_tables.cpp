#include "lib/fem/voxel/node_tables.h"

#include <algorithm>
#include <unordered_map>

namespace supple {

NodeTables::NodeTables(const std::vector<std::int32_t>& element_begin,
                       const std::vector<std::uint16_t>& offset,
                       const std::vector<Corners>& corners) {
  const std::size_t blocks = element_begin.size() - 1;
  m_nodes.reserve(blocks * kLatticeNodes);
  for (std::size_t b = 0; b < blocks; ++b) {
    add_block(element_begin[b], element_begin[b + 1], offset, corners);
  }
  m_nodes.shrink_to_fit();
  m_listed.shrink_to_fit();
  m_places.shrink_to_fit();
}

void NodeTables::add_block(std::int32_t first, std::int32_t end,
                           const std::vector<std::uint16_t>& offset,
                           const std::vector<Corners>& corners) {
  const std::size_t begin = m_nodes.size();
  m_nodes.resize(begin + kLatticeNodes, -1);
  std::unordered_map<NodeIndex, int> place_of;  // of the further nodes
  for (std::int32_t e = first; e < end; ++e) {
    CornerPlaces places;
    bool is_on_lattice = true;
    for (int c = 0; c < 8; ++c) {
      const NodeIndex node = corners[std::size_t(e)][c];
      int place = lattice_place(offset[std::size_t(e)], c);
      NodeIndex& known = m_nodes[begin + std::size_t(place)];
      if (known < 0) known = node;
      if (known != node) {
        is_on_lattice = false;
        const auto [entry, is_new] = place_of.try_emplace(node, int(m_nodes.size() - begin));
        place = entry->second;
        if (is_new) m_nodes.push_back(node);
      }
      places[c] = std::uint32_t(place);
    }
    if (is_on_lattice) continue;
    m_listed.push_back(e);
    m_places.push_back(places);
  }
  m_longest = std::max(m_longest, m_nodes.size() - begin);
  m_begin.push_back(m_nodes.size());
  m_listed_begin.push_back(std::uint32_t(m_listed.size()));
}

const CornerPlaces* NodeTables::find_listed(std::size_t block, std::int32_t element) const {
  const auto begin = m_listed.begin() + m_listed_begin[block];
  const auto end = m_listed.begin() + m_listed_begin[block + 1];
  const auto found = std::lower_bound(begin, end, element);
  if (found == end || *found != element) return nullptr;
  return &m_places[std::size_t(found - m_listed.begin())];
}

std::size_t NodeTables::bytes() const {
  return m_begin.capacity() * sizeof(std::size_t) + m_places.capacity() * sizeof(CornerPlaces) +
         (m_nodes.capacity() + m_listed_begin.capacity() + m_listed.capacity()) * 4;
}

}  // namespace supple

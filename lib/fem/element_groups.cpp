#include "lib/fem/element_groups.h"

#include <algorithm>
#include <unordered_map>

namespace supple {

namespace {

/// One block under way.
struct BlockTable {
  std::array<NodeIndex, kLatticeNodes> lattice;
  std::vector<NodeIndex> further;
  std::unordered_map<NodeIndex, int> place_of;    // of the further nodes
  std::array<std::int32_t, kBrickVoxels> in_row;  // the element of a cell that lies in a row, or -1
  std::vector<std::pair<std::int32_t, std::array<std::uint16_t, 8>>> listed;

  void clear() {
    lattice.fill(-1);
    further.clear();
    place_of.clear();
    in_row.fill(-1);
    listed.clear();
  }
  int place(int lattice_place, NodeIndex node) {
    NodeIndex& first = lattice[lattice_place];
    if (first < 0) first = node;
    if (first == node) return lattice_place;
    const auto [entry, is_new] = place_of.try_emplace(node, kLatticeNodes + int(further.size()));
    if (is_new) further.push_back(node);
    return entry->second;
  }
};

int lattice_place(const Vec3i& local, int corner) {
  return (local.x + (corner >> 2 & 1)) * 81 + (local.y + (corner >> 1 & 1)) * 9 + local.z +
         (corner & 1);
}

void fill_table(const HexMesh& mesh, std::size_t block, const std::vector<GroupKind>& kinds,
                BlockTable& table) {
  table.clear();
  for (std::int32_t e = mesh.element_begin[block]; e < mesh.element_begin[block + 1]; ++e) {
    const Vec3i local = brick_local(mesh.offset[e]);
    std::array<std::uint16_t, 8> places;
    bool is_lattice = kinds[e] == GroupKind::alike && table.in_row[mesh.offset[e]] < 0;
    for (int c = 0; c < 8; ++c) {
      const int on_lattice = lattice_place(local, c);
      const int place = table.place(on_lattice, mesh.corners[e][c]);
      is_lattice = is_lattice && place == on_lattice;
      places[c] = std::uint16_t(place);
    }
    if (is_lattice) {
      table.in_row[mesh.offset[e]] = e;
    } else {
      table.listed.push_back({e, places});
    }
  }
}

void add_rows(const BlockTable& table, ElementGroups& out) {
  for (int row = 0; row < 64; ++row) {
    std::array<std::int32_t, kGroup> lanes;
    unsigned present = 0;
    for (int k = 0; k < kGroup; ++k) {
      lanes[k] = table.in_row[8 * row + k];
      if (lanes[k] >= 0) present |= 1u << k;
    }
    if (present == 0) continue;
    out.groups.push_back({GroupKind::alike, std::uint8_t(row), std::uint8_t(present)});
    out.element.insert(out.element.end(), lanes.begin(), lanes.end());
  }
}

/// Which rows of the lattice have nodes in sequence from their second one on.
void note_sequences(const BlockTable& table, ElementGroups& out) {
  for (int row = 0; row < kLatticeRows; ++row) {
    const NodeIndex* nodes = &table.lattice[9 * row + 1];
    bool is_sequence = nodes[0] >= 0;
    for (int k = 1; k < kGroup; ++k) is_sequence = is_sequence && nodes[k] == nodes[0] + k;
    out.in_sequence.push_back(is_sequence ? 1 : 0);
  }
}

void add_listed(const BlockTable& table, GroupKind kind, const std::vector<GroupKind>& kinds,
                ElementGroups& out) {
  int filled = kGroup;
  for (const auto& [element, places] : table.listed) {
    if (kinds[element] != kind) continue;
    if (filled == kGroup) {
      out.groups.push_back({kind, kListed, 0, std::uint32_t(out.corners.size())});
      out.corners.resize(out.corners.size() + 8 * kGroup, 0);
      out.element.resize(out.element.size() + kGroup, -1);
      filled = 0;
    }
    ElementGroup& group = out.groups.back();
    group.present = std::uint8_t(group.present | 1u << filled);
    for (int c = 0; c < 8; ++c) out.corners[group.corners + c * kGroup + filled] = places[c];
    out.element[out.element.size() - kGroup + filled] = element;
    ++filled;
  }
}

}  // namespace

std::size_t ElementGroups::bytes() const {
  return groups.capacity() * sizeof(ElementGroup) + group_begin.capacity() * 8 +
         nodes.capacity() * 4 + corners.capacity() * 2 + element.capacity() * 4 +
         in_sequence.capacity();
}

ElementGroups group_elements(const HexMesh& mesh, const std::vector<GroupKind>& kinds) {
  ElementGroups out;
  BlockTable table;
  out.nodes.reserve(mesh.block_count() * kLatticeNodes);
  for (std::size_t block = 0; block < mesh.block_count(); ++block) {
    out.group_begin.push_back(std::uint32_t(out.groups.size()));
    out.table_begin.push_back(std::uint32_t(out.nodes.size()));
    fill_table(mesh, block, kinds, table);
    note_sequences(table, out);
    add_rows(table, out);
    for (const GroupKind kind : {GroupKind::alike, GroupKind::mixed, GroupKind::constrained}) {
      add_listed(table, kind, kinds, out);
    }
    out.nodes.insert(out.nodes.end(), table.lattice.begin(), table.lattice.end());
    out.nodes.insert(out.nodes.end(), table.further.begin(), table.further.end());
    out.longest_table = std::max(out.longest_table, kLatticeNodes + table.further.size());
  }
  out.group_begin.push_back(std::uint32_t(out.groups.size()));
  out.table_begin.push_back(std::uint32_t(out.nodes.size()));
  return out;
}

}  // namespace supple

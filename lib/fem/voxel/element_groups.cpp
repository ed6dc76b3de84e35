#include "lib/fem/voxel/element_groups.h"

#include <utility>

namespace supple {

namespace {

/// The elements of one block under way.
struct BlockElements {
  std::array<std::int32_t, kBrickVoxels> in_row;  // the element of a cell that lies in a row, or -1
  std::vector<std::pair<std::int32_t, CornerPlaces>> listed;

  void find(const HexMesh& mesh, std::size_t block, const std::vector<GroupKind>& kinds) {
    in_row.fill(-1);
    listed.clear();
    for (std::int32_t e = mesh.element_begin[block]; e < mesh.element_begin[block + 1]; ++e) {
      if (kinds[e] == GroupKind::held) continue;
      const int offset = mesh.offset[e];
      const CornerPlaces places = mesh.tables.places(block, e, offset);
      bool is_in_row = kinds[e] == GroupKind::alike && in_row[offset] < 0;
      for (int c = 0; c < 8 && is_in_row; ++c) {
        is_in_row = places[c] == std::uint32_t(lattice_place(offset, c));
      }
      if (is_in_row) {
        in_row[offset] = e;
      } else {
        listed.push_back({e, places});
      }
    }
  }
};

void add_rows(const BlockElements& elements, ElementGroups& out) {
  for (int row = 0; row < 64; ++row) {
    std::array<std::int32_t, kGroup> lanes;
    unsigned present = 0;
    for (int k = 0; k < kGroup; ++k) {
      lanes[k] = elements.in_row[8 * row + k];
      if (lanes[k] >= 0) present |= 1u << k;
    }
    if (present == 0) continue;
    out.groups.push_back({GroupKind::alike, std::uint8_t(row), std::uint8_t(present)});
    out.element.insert(out.element.end(), lanes.begin(), lanes.end());
  }
}

/// Notes which rows of the lattice have nodes in sequence from their second one on.
void note_sequences(const NodeIndex* lattice, ElementGroups& out) {
  for (int row = 0; row < kLatticeRows; ++row) {
    const NodeIndex* nodes = lattice + kLatticeDim * row + 1;
    bool is_sequence = nodes[0] >= 0;
    for (int k = 1; k < kGroup; ++k) is_sequence = is_sequence && nodes[k] == nodes[0] + k;
    out.in_sequence.push_back(is_sequence ? 1 : 0);
  }
}

void add_listed(const BlockElements& elements, GroupKind kind, const std::vector<GroupKind>& kinds,
                ElementGroups& out) {
  int filled = kGroup;
  for (const auto& [element, places] : elements.listed) {
    if (kinds[element] != kind) continue;
    if (filled == kGroup) {
      out.groups.push_back({kind, kListed, 0, std::uint32_t(out.corners.size())});
      out.corners.resize(out.corners.size() + 8 * kGroup, 0);
      out.element.resize(out.element.size() + kGroup, -1);
      filled = 0;
    }
    ElementGroup& group = out.groups.back();
    group.present = std::uint8_t(group.present | 1u << filled);
    for (int c = 0; c < 8; ++c) {
      out.corners[group.corners + c * kGroup + filled] = std::uint16_t(places[c]);
    }
    out.element[out.element.size() - kGroup + filled] = element;
    ++filled;
  }
}

}  // namespace

std::size_t ElementGroups::bytes() const {
  return groups.capacity() * sizeof(ElementGroup) + group_begin.capacity() * 4 +
         corners.capacity() * 2 + element.capacity() * 4 + in_sequence.capacity();
}

ElementGroups group_elements(const HexMesh& mesh, const std::vector<GroupKind>& kinds) {
  ElementGroups out;
  BlockElements elements;
  for (std::size_t block = 0; block < mesh.block_count(); ++block) {
    out.group_begin.push_back(std::uint32_t(out.groups.size()));
    elements.find(mesh, block, kinds);
    note_sequences(mesh.tables.nodes(block), out);
    add_rows(elements, out);
    for (const GroupKind kind : {GroupKind::alike, GroupKind::mixed, GroupKind::constrained}) {
      add_listed(elements, kind, kinds, out);
    }
  }
  out.group_begin.push_back(std::uint32_t(out.groups.size()));
  return out;
}

}  // namespace supple

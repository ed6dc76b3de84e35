// Elements of a mesh in groups of eight, which the kernels compute side by side.
//
// The values of a block's nodes are copied in the order of its table (node_tables.h). A group is a
// row of eight cells along k whose elements are of one material and have the nodes of the lattice,
// so that its corners are read as contiguous vectors; or eight elements of one kind of anywhere in
// the block with the places of their corners listed. So one difficult cell does not make its whole
// row difficult.
// Memory: 81 bytes per block, 12 per group, 128 more where its corners are listed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/fem/voxel/hex_mesh.h"

namespace supple {

constexpr int kGroup = 8;

/// Elements that the kernels treat alike.
enum class GroupKind : std::uint8_t {
  alike,        // one material: a voxel, or a cell with eight children of one class
  mixed,        // children of several classes, or missing ones, or some held as a whole
  constrained,  // corners of children are held
  held          // all of them are: in no group
};

struct ElementGroup {
  GroupKind kind;
  std::uint8_t row;           // 8 i + j of a row; kListed: the corners are listed
  std::uint8_t present;       // bit per lane: the others are no elements
  std::uint32_t corners = 0;  // listed: where they begin in ElementGroups::corners
  std::uint32_t lanes = 0;    // where its lanes begin in data of the kind
};
constexpr std::uint8_t kListed = 255;

struct ElementGroups {
  std::vector<ElementGroup> groups;
  std::vector<std::uint32_t> group_begin;  // per block, one more than blocks
  /// Flags per block and row of its lattice: 1 where the nodes are in sequence, without the first
  /// of the nine.
  std::vector<std::uint8_t> in_sequence;
  std::vector<std::uint16_t> corners;  // of listed groups: [corner][lane], places in the table
  /// The element of every lane, -1 where there is none; kept while data of the kinds are filled in.
  std::vector<std::int32_t> element;

  /// True if test(place in the table of the block) holds for a corner of one of its elements.
  template <class Test>
  bool any_corner(const ElementGroup& group, Test&& test) const {
    for (int lane = 0; lane < kGroup; ++lane) {
      if ((group.present >> lane & 1) == 0) continue;
      for (int c = 0; c < 8; ++c) {
        const std::size_t place = group.row == kListed
                                      ? corners[group.corners + std::size_t(kGroup * c + lane)]
                                      : std::size_t(lattice_place((group.row << 3) + lane, c));
        if (test(place)) return true;
      }
    }
    return false;
  }
  std::size_t bytes() const;
};

ElementGroups group_elements(const HexMesh& mesh, const std::vector<GroupKind>& kinds);

}  // namespace supple

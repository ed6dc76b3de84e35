// A plain dense lattice with limits stored per link, for the reference algorithms. Built from a
// body or by hand. Cost: 75 bytes per voxel of the box, so for small bodies and benchmarks only.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/body/body.h"

namespace supple::reference {

/// Offsets from rest per coordinate, 2^-16 voxel, one per voxel of the lattice's box.
using Offsets = std::array<std::vector<std::int32_t>, 3>;

struct ReferenceLattice {
  Vec3i origin{0, 0, 0};  // voxel of the first node
  Vec3i dims{0, 0, 0};
  std::vector<std::uint8_t> mask;                // 1: element; i fastest
  std::vector<std::array<LinkSlack, 3>> slacks;  // link to the next node along i, j, k
  std::vector<std::uint8_t> cut;  // bit a: no link to the next node along axis a; empty: none cut

  std::size_t size() const { return std::size_t(dims.x) * dims.y * dims.z; }
  bool inside(const Vec3i& node) const {
    return node.x >= 0 && node.y >= 0 && node.z >= 0 && node.x < dims.x && node.y < dims.y &&
           node.z < dims.z;
  }
  /// Index of a node, counted from `origin`.
  std::size_t index(const Vec3i& node) const {
    return (std::size_t(node.z) * dims.y + node.y) * dims.x + node.x;
  }
  Vec3i node(std::size_t index) const {
    return {int(index % dims.x), int(index / dims.x % dims.y), int(index / dims.x / dims.y)};
  }
  bool is_element(const Vec3i& node) const { return inside(node) && mask[index(node)] != 0; }
  /// True where a link joins a node to the next one along the axis.
  bool is_linked(const Vec3i& node, int axis) const {
    Vec3i next = node;
    ++next[axis];
    if (!is_element(node) || !is_element(next)) return false;
    return cut.empty() || ((cut[index(node)] >> axis) & 1) == 0;
  }
  /// All elements at rest.
  Offsets at_rest() const;
};

/// The box of the body's elements with the limits of its links.
ReferenceLattice lattice_of(const Body& body);
Offsets offsets_of(const Body& body, const ReferenceLattice& lattice);
/// The body with other offsets; its links are not known to hold.
Body with_offsets(const Body& body, const ReferenceLattice& lattice, const Offsets& offsets);

}  // namespace supple::reference

// Contents of the cells of level 1: the classes of their up to eight voxels, classes of the same
// moduli being one, and which corners of these are held.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/fem/voxel/element_groups.h"
#include "lib/fem/voxel/hex_mesh.h"
#include "lib/fem/voxel/voxel_material.h"

namespace supple {

/// Bits 3 corner + component of the held ones of an element.
constexpr std::uint32_t kAllCornersHeld = 0xffffff;
inline std::uint32_t held_corners(const Corners& corners, const HeldBits& held) {
  std::uint32_t bits = 0;
  for (int c = 0; c < 8; ++c) bits |= std::uint32_t(held[corners[c]]) << 3 * c;
  return bits;
}

struct CellClasses {
  std::vector<std::array<std::uint8_t, 8>> of_child;
  std::vector<std::uint8_t> present;               // bit per child that is not held as a whole
  std::vector<std::int32_t> constraint;            // into `held`, or -1
  std::vector<std::array<std::uint32_t, 8>> held;  // per child, as held_corners()

  GroupKind kind(std::size_t cell) const;
};

CellClasses cell_classes(const HexMesh& voxels, const Coarsening& coarsening,
                         const VoxelMaterial& material, const HeldBits& held, int cells);

}  // namespace supple

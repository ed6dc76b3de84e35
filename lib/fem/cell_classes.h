// What the cells of level 1 consist of: the classes of their up to eight voxels, classes of the
// same moduli being one, and which corners of these are held.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "lib/fem/element_groups.h"
#include "lib/fem/element_matrix.h"
#include "lib/fem/hex_mesh.h"

namespace supple {

/// Per class: shear and bulk modulus in kPa, and inertia, which is what a matrix c M beside the
/// stiffness has per volume, in mN/mm^4 (kPa/mm^2); 0 where K stands alone.
template <class T>
struct ModuliTable {
  std::array<T, 256> shear, bulk;
  std::array<T, 256> inertia{};

  bool has_inertia() const {
    return std::any_of(inertia.begin(), inertia.end(), [](T value) { return value != 0; });
  }
};

/// What the voxels of a mesh are made of.
struct VoxelMaterial {
  ElementMatrix matrix;
  ModuliTable<double> moduli;
  ModuliTable<float> moduli_single;
  std::vector<std::uint8_t> classes;  // per element
};

/// Held components of a node: bit a for component a of LPS.
using HeldBits = std::vector<std::uint8_t>;
constexpr std::uint8_t kAllHeld = 7;

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

// Sums a K + c M of stiffness and mass as one operator, and M alone.
//
// M is the consistent mass, M = sum over elements of integral rho N N: it is what the displacement
// of the elements says of their kinetic energy, needs no rule for corners of mixed material, and
// costs an operator without a matrix nothing (element_matrix.h). Frequencies come from above, as
// those of the stiffness do; a lumped mass would bring them from below, with errors of the same
// size.
#pragma once

#include <array>
#include <vector>

#include "lib/fem/hex_operator.h"

namespace supple {

/// kg/m^3 per class.
using MassDensities = std::array<double, 256>;

/// A factor of the stiffness, per class.
using ClassParts = std::array<double, 256>;
/// The same of all classes.
ClassParts even_parts(double part);

/// What the sum over elements of a K, and c M, are made of: a without a unit, c in 1/s^2. K u is in
/// mN of u in mm, and so is c M u. Throws InputError for a density that is not above 0.
VoxelMaterial weighted_material(const VoxelMaterial& material, const MassDensities& density,
                                const ClassParts& stiffness_parts, double mass_part_per_s2);

/// M, in kg. Of a vector in mm it gives kg mm, of one in mm/s^2 mN.
class MassMatrix {
 public:
  /// `mesh` must outlive this.
  MassMatrix(const HexMesh& mesh, const VoxelMaterial& material, const MassDensities& density)
      : m_material(weighted_material(material, density, even_parts(0), 1)),
        m_operator(mesh, m_material) {}
  MassMatrix(const MassMatrix&) = delete;
  MassMatrix& operator=(const MassMatrix&) = delete;

  /// y += M x.
  void add(const double* x, double* y) const { m_operator.add(x, y); }
  /// M x.
  std::vector<double> times(const std::vector<double>& x) const;
  std::size_t bytes() const { return m_operator.bytes() + m_material.classes.capacity(); }

 private:
  VoxelMaterial m_material;
  HexOperator m_operator;
};

}  // namespace supple

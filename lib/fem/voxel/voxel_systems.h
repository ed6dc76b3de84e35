// The hexahedra of voxels as the solvers know them: sums of stiffness and mass, systems of
// equations with the multigrid cycle, and the tangents of finite strain.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lib/fem/newton.h"
#include "lib/fem/operator.h"
#include "lib/fem/voxel/finite_strain.h"
#include "lib/fem/voxel/hex_operator.h"
#include "lib/fem/voxel/multigrid.h"

namespace supple {

/// An operator with a material of its own.
class WeightedOperator final : public Operator {
 public:
  /// `mesh` must outlive this.
  WeightedOperator(const HexMesh& mesh, VoxelMaterial material)
      : m_material(std::move(material)), m_operator(mesh, m_material) {}
  WeightedOperator(const WeightedOperator&) = delete;
  WeightedOperator& operator=(const WeightedOperator&) = delete;

  void add(const float* x, double* y) const override { m_operator.add(x, y); }
  void add(const double* x, double* y) const override { m_operator.add(x, y); }
  void subtract(const double* x, double* y) const override { m_operator.subtract(x, y); }
  std::vector<float> diagonal() const override { return m_operator.diagonal(); }
  std::size_t bytes() const override { return m_operator.bytes() + m_material.classes.capacity(); }

  const VoxelMaterial& material() const { return m_material; }
  const HexOperator& hexahedra() const { return m_operator; }

 private:
  VoxelMaterial m_material;
  HexOperator m_operator;
};

/// A matrix of the voxels with its multigrid cycle.
class VoxelSystem final : public LinearSystem {
 public:
  /// All but `held` and `progress` must outlive this. `first`: as Multigrid has it.
  VoxelSystem(const MeshLevels& levels, const HexOperator& matrix, const VoxelMaterial& material,
              const HeldBits& held, Progress* progress, int first = 0)
      : m_matrix(&matrix), m_multigrid(levels, matrix, material, held, {}, progress, first) {}
  /// Takes the matrix and keeps it.
  VoxelSystem(const MeshLevels& levels, std::unique_ptr<WeightedOperator> matrix,
              const HeldBits& held, Progress* progress)
      : m_own(std::move(matrix)),
        m_matrix(&m_own->hexahedra()),
        m_multigrid(levels, *m_matrix, m_own->material(), held, {}, progress) {}

  void add(const float* x, double* y) const override { m_matrix->add(x, y); }
  void subtract(const double* x, double* y) const override { m_matrix->subtract(x, y); }
  void precondition(float* r, float* z, const Progress* progress) override {
    m_multigrid.cycle(r, z, progress);
  }
  Multigrid& multigrid() { return m_multigrid; }
  int level_count() const override { return m_multigrid.level_count(); }
  std::size_t bytes() const override { return m_multigrid.bytes() + (m_own ? m_own->bytes() : 0); }

 private:
  std::unique_ptr<WeightedOperator> m_own;
  const HexOperator* m_matrix;
  Multigrid m_multigrid;
};

/// Voxels at finite strain. Tangents are preconditioned by the cycle of the stiffness at rest
/// between turned vectors (NodeTurns).
class FiniteVoxels final : public NonlinearSystem {
 public:
  /// All must outlive this. `multigrid` is that of the stiffness at rest.
  FiniteVoxels(const HexMesh& mesh, const FiniteStrain& strain, const VoxelMaterial& material,
               Multigrid& multigrid, const HeldBits& held)
      : m_mesh(mesh),
        m_strain(strain),
        m_material(material),
        m_multigrid(multigrid),
        m_held(held) {}

  StrainEnergy add_forces(const double* u, double* force, double part) const override {
    return m_strain.add_forces(u, force, part);
  }
  std::unique_ptr<LinearSystem> tangent_at(const std::vector<double>& u_mm,
                                           double part) const override;
  double largest_turn_deg(const std::vector<double>& u_mm) const override;

 private:
  const HexMesh& m_mesh;
  const FiniteStrain& m_strain;
  const VoxelMaterial& m_material;
  Multigrid& m_multigrid;
  const HeldBits& m_held;
};

}  // namespace supple

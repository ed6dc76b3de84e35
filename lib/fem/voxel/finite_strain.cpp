#include "lib/fem/voxel/finite_strain.h"

#include <algorithm>
#include <cmath>

#include "lib/fem/node_vectors.h"
#include "lib/fem/small_matrix.h"
#include "lib/fem/voxel/block_field.h"
#include "lib/fem/voxel/finite_kernel.h"

namespace supple {

namespace {

struct ForceFields {
  ForceFields(const HexMesh& mesh, const ElementGroups& groups)
      : u(mesh, groups), force(mesh, groups) {}

  BlockField<double> u, force;
};

struct TangentFields {
  TangentFields(const HexMesh& mesh, const ElementGroups& groups)
      : u(mesh, groups), x(mesh, groups), force(mesh, groups) {}

  BlockField<double> u, x, force;
};

/// DoubleLanes without an element read nodes of others: they are at rest.
void clear_absent(const ElementGroup& group, DoubleLanes* corners) {
  if (group.present == 255) return;
  for (int lane = 0; lane < kGroup; ++lane) {
    if ((group.present >> lane & 1) != 0) continue;
    for (int n = 0; n < 24; ++n) corners[n][lane] = 0;
  }
}

}  // namespace

FiniteStrain::FiniteStrain(const HexMesh& mesh, const VoxelMaterial& material,
                           const std::vector<double>& swelling_kpa)
    : m_mesh(&mesh),
      m_material(&material),
      m_geometry(mesh.geometry.axes_mm(), material.matrix.dilatation),
      m_groups(group_elements(mesh, std::vector<GroupKind>(mesh.offset.size()))) {
  if (swelling_kpa.empty()) return;
  for (const std::int32_t element : m_groups.element) {
    m_swelling.push_back(element < 0 ? 0 : swelling_kpa[std::size_t(element)]);
  }
}

LaneModuli FiniteStrain::moduli_of(std::size_t group, double part) const {
  LaneModuli out{};
  for (int lane = 0; lane < kGroup; ++lane) {
    const std::size_t at = kGroup * group + std::size_t(lane);
    const std::int32_t element = m_groups.element[at];
    if (element < 0) continue;
    const std::uint8_t of = m_material->classes[std::size_t(element)];
    out.shear[lane] = m_material->moduli.shear[of];
    out.bulk[lane] = m_material->moduli.bulk[of];
    if (!m_swelling.empty()) out.swelling[lane] = part * m_swelling[at];
  }
  return out;
}

StrainEnergy FiniteStrain::add_forces(const double* u, double* force, double part) const {
  std::vector<StrainEnergy> of_block(m_mesh->block_count());
  for_blocks_by_colour<ForceFields>(
      *m_mesh, m_groups, m_mesh->of_colour, [&](std::int32_t block, ForceFields& fields) {
        DoubleLanes x[24], energy, smallest;
        fields.u.load(block, u);
        fields.force.clear(block);
        StrainEnergy& sum = of_block[std::size_t(block)];
        for (auto g = m_groups.group_begin[std::size_t(block)];
             g < m_groups.group_begin[std::size_t(block) + 1]; ++g) {
          const ElementGroup& group = m_groups.groups[g];
          fields.u.read_corners(group, x);
          clear_absent(group, x);
          finite_forces(m_geometry, moduli_of(g, part), x, energy, smallest);
          fields.force.add_corners(group, x);
          for (int lane = 0; lane < kGroup; ++lane) {
            if ((group.present >> lane & 1) == 0) continue;
            sum.energy_uj += energy[lane];
            // A value that is no number is taken, too.
            if (!(smallest[lane] >= sum.smallest_j)) sum.smallest_j = smallest[lane];
          }
        }
        fields.force.add_to(block, 1.0, force);
      });
  StrainEnergy sum;
  for (const StrainEnergy& of : of_block) {
    sum.energy_uj += of.energy_uj;
    if (!(of.smallest_j >= sum.smallest_j)) sum.smallest_j = of.smallest_j;
  }
  return sum;
}

template <class X>
void FiniteStrain::accumulate_tangent(const double* u, const X* x, double* y, double part,
                                      double sign) const {
  for_blocks_by_colour<TangentFields>(
      *m_mesh, m_groups, m_mesh->of_colour, [&](std::int32_t block, TangentFields& fields) {
        DoubleLanes at[24], change[24];
        fields.u.load(block, u);
        fields.x.load(block, x);
        fields.force.clear(block);
        for (auto g = m_groups.group_begin[std::size_t(block)];
             g < m_groups.group_begin[std::size_t(block) + 1]; ++g) {
          const ElementGroup& group = m_groups.groups[g];
          fields.u.read_corners(group, at);
          clear_absent(group, at);
          fields.x.read_corners(group, change);
          finite_tangent(m_geometry, moduli_of(g, part), at, change);
          fields.force.add_corners(group, change);
        }
        fields.force.add_to(block, sign, y);
      });
}

template <class X>
void FiniteStrain::add_tangent(const double* u, const X* x, double* y, double part) const {
  accumulate_tangent(u, x, y, part, 1);
}
template <class X>
void FiniteStrain::subtract_tangent(const double* u, const X* x, double* y, double part) const {
  accumulate_tangent(u, x, y, part, -1);
}
template void FiniteStrain::add_tangent(const double*, const float*, double*, double) const;
template void FiniteStrain::add_tangent(const double*, const double*, double*, double) const;
template void FiniteStrain::subtract_tangent(const double*, const double*, double*, double) const;

ElementEnergy element_energy(const HexMesh& mesh, const VoxelMaterial& material,
                             const std::vector<double>& u_mm, std::int32_t element) {
  const GaussGeometry geometry(mesh.geometry.axes_mm(), material.matrix.dilatation);
  LaneModuli moduli{};
  const std::uint8_t of = material.classes[std::size_t(element)];
  moduli.shear[0] = material.moduli.shear[of];
  moduli.bulk[0] = material.moduli.bulk[of];
  DoubleLanes x[24] = {}, modes[24], energy, smallest;
  const Corners corners = mesh.corners(element);
  for (std::size_t n = 0; n < 24; ++n) {
    x[n][0] = u_mm[3 * std::size_t(corners[n / 3]) + n % 3];
  }
  std::copy(x, x + 24, modes);
  to_modes(modes);
  finite_forces(geometry, moduli, x, energy, smallest);
  return {mean_volume_change(geometry, modes)[0], energy[0] / geometry.volume_mm3};
}

std::size_t FiniteStrain::bytes() const {
  return m_groups.bytes() + m_swelling.capacity() * sizeof(double);
}

// ---- Turns of nodes

NodeTurns::NodeTurns(const HexMesh& mesh, const VoxelMaterial& material, const HeldBits& held,
                     const std::vector<double>& u_mm)
    : m_turns(held.size()) {
  for (std::array<float, 9>& turn : m_turns) turn.fill(0);
  // Sums of F - 1, by elements of one colour at a time.
  for (const std::vector<std::int32_t>& blocks : mesh.of_colour) {
    parallel_for(blocks.size(), [&](std::size_t n) {
      const std::size_t block = std::size_t(blocks[n]);
      for (auto e = mesh.element_begin[block]; e < mesh.element_begin[block + 1]; ++e) {
        const Corners corners = mesh.corners_in(block, e);
        float gradient[9] = {};
        for (int c = 0; c < 8; ++c) {
          for (int a = 0; a < 3; ++a) {
            const double u = u_mm[3 * std::size_t(corners[c]) + std::size_t(a)];
            for (int d = 0; d < 3; ++d) {
              gradient[3 * a + d] += float(u * material.matrix.gradient[3 * c + d]);
            }
          }
        }
        for (const NodeIndex node : corners) {
          std::array<float, 9>& sum = m_turns[std::size_t(node)];
          for (int m = 0; m < 9; ++m) sum[m] += gradient[m];
          // F of the sum is the number of elements plus the sum: its turn is that of the mean.
          for (int m = 0; m < 9; m += 4) sum[m] += 1;
        }
      }
    });
  }
  for_ranges(m_turns.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      Matrix9 f = kIdentity9;
      if (held[n] == 0) std::copy(m_turns[n].begin(), m_turns[n].end(), f.begin());
      const Matrix9 rotation = rotation_of(f);
      std::transform(rotation.begin(), rotation.end(), m_turns[n].begin(),
                     [](double value) { return float(value); });
    }
  });
}

void NodeTurns::turn(float* x) const {
  for_ranges(m_turns.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::array<float, 9>& r = m_turns[n];
      float* v = x + 3 * n;
      const float a = v[0], b = v[1], c = v[2];
      for (std::size_t m = 0; m < 3; ++m) v[m] = r[3 * m] * a + r[3 * m + 1] * b + r[3 * m + 2] * c;
    }
  });
}

void NodeTurns::turn_back(float* x) const {
  for_ranges(m_turns.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::array<float, 9>& r = m_turns[n];
      float* v = x + 3 * n;
      const float a = v[0], b = v[1], c = v[2];
      for (std::size_t m = 0; m < 3; ++m) v[m] = r[m] * a + r[3 + m] * b + r[6 + m] * c;
    }
  });
}

}  // namespace supple

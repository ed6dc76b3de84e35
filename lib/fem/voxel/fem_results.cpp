#include "lib/fem/voxel/fem_results.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lib/fem/small_matrix.h"
#include "lib/fem/voxel/fem.h"
#include "lib/fem/voxel/finite_strain.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// du/dx at the centre of an element, rows are components; the mean of tr e is its trace.
Matrix9 centre_gradient(const HexMesh& voxels, const VoxelMaterial& material,
                        const std::vector<double>& u_mm, std::int32_t element) {
  Matrix9 gradient{};
  const Corners corners = voxels.corners(element);
  for (std::size_t n = 0; n < 24; ++n) {
    const double u = u_mm[3 * std::size_t(corners[n / 3]) + n % 3];
    for (std::size_t d = 0; d < 3; ++d) {
      gradient[3 * (n % 3) + d] += u * material.matrix.gradient[3 * (n / 3) + d];
    }
  }
  return gradient;
}

/// Strain and turn alone.
ElementState linear_motion(const HexMesh& voxels, const VoxelMaterial& material,
                           const std::vector<double>& u_mm, std::int32_t element) {
  const Matrix9 gradient = centre_gradient(voxels, material, u_mm, element);
  ElementState out;
  out.strain = symmetric(gradient);
  out.volume_strain = trace(out.strain);
  Matrix9 f = gradient;
  for (std::size_t n = 0; n < 9; n += 4) f[n] += 1;
  out.det_f = determinant_of(f, cofactors(f));
  out.rotation_rad = axial(gradient);
  return out;
}

ElementState linear_state(const HexMesh& voxels, const VoxelMaterial& material,
                          const std::vector<double>& u_mm, std::int32_t element) {
  ElementState out = linear_motion(voxels, material, u_mm, element);
  const std::uint8_t of = material.classes[element];
  const double shear = material.moduli.shear[of], bulk = material.moduli.bulk[of];
  for (int n = 0; n < 6; ++n) out.stress_kpa[n] = 2 * shear * out.strain[n];
  const double volumetric = (bulk - 2 * shear / 3) * out.volume_strain;
  for (int n = 0; n < 3; ++n) out.stress_kpa[n] += volumetric;
  double local[24], energy = 0;
  const Corners corners = voxels.corners(element);
  for (int n = 0; n < 24; ++n) local[n] = u_mm[3 * std::size_t(corners[n / 3]) + n % 3];
  for (int n = 0; n < 24; ++n) {
    double force = 0;
    for (int m = 0; m < 24; ++m) {
      force += (shear * material.matrix.shear[n][m] + bulk * material.matrix.bulk[n][m]) * local[m];
    }
    energy += local[n] * force / 2;
  }
  out.energy_density_kpa = energy / material.matrix.volume_mm3;
  return out;
}

ElementState finite_state(const HexMesh& voxels, const VoxelMaterial& material,
                          const std::vector<double>& u_mm, std::int32_t element) {
  Matrix9 f = centre_gradient(voxels, material, u_mm, element);
  for (std::size_t n = 0; n < 9; n += 4) f[n] += 1;
  const ElementEnergy energy = element_energy(voxels, material, u_mm, element);
  ElementState out;
  out.volume_strain = energy.volume_change;
  out.energy_density_kpa = energy.density_kpa;
  const double dilatation = material.matrix.dilatation == Dilatation::mean
                                ? energy.volume_change
                                : determinant_of(f, cofactors(f)) - 1;
  const std::uint8_t of = material.classes[element];
  set_finite(f, material.moduli.shear[of], material.moduli.bulk[of] * dilatation, out);
  return out;
}

}  // namespace

ElementState element_state(const HexMesh& voxels, const VoxelMaterial& material,
                           const std::vector<double>& u_mm, std::int32_t element,
                           StrainTheory theory, const std::vector<double>& swelling_kpa) {
  ElementState state = theory == StrainTheory::linear
                           ? linear_state(voxels, material, u_mm, element)
                           : finite_state(voxels, material, u_mm, element);
  if (swelling_kpa.empty()) return state;
  for (int n = 0; n < 3; ++n) state.stress_kpa[n] -= swelling_kpa[std::size_t(element)];
  return state;
}

std::vector<float> element_values(const HexMesh& voxels, const VoxelMaterial& material,
                                  const std::vector<double>& u_mm, FemQuantity quantity,
                                  StrainTheory theory, const std::vector<double>& swelling_kpa) {
  std::vector<float> values(voxels.offset.size());
  parallel_for(voxels.element_count(), Grain{256}, [&](std::int32_t e) {
    const ElementState state = element_state(voxels, material, u_mm, e, theory, swelling_kpa);
    values[e] = float(value_of(state, quantity));
  });
  return values;
}

LargestMotion largest_motion(const HexMesh& voxels, const VoxelMaterial& material,
                             const std::vector<double>& u_mm, StrainTheory theory,
                             const MotionLimits& limits) {
  const auto add = [&](std::int32_t e, LargestMotion& sum) {
    const ElementState state = theory == StrainTheory::linear
                                   ? linear_motion(voxels, material, u_mm, e)
                                   : finite_state(voxels, material, u_mm, e);
    const std::array<double, 3> principal = eigenvalues(state.strain);
    LargestMotion own;
    own.rotation_deg = state.rotation_rad.length() * kDegreesPerRadian;
    own.strain = std::max(std::abs(principal[0]), std::abs(principal[2]));
    own.smallest_det_f = state.det_f;
    own.beyond = own.rotation_deg > limits.rotation_deg || own.strain > limits.strain;
    if (own.rotation_deg > sum.rotation_deg || own.strain > sum.strain) {
      own.turned = own.strained = voxels.cell_of(e);
    }
    sum.take(own);
  };
  const auto join = [](LargestMotion a, const LargestMotion& b) {
    a.take(b);
    return a;
  };
  return parallel_reduce(voxels.element_count(), Grain{256}, LargestMotion{}, add, join);
}

double volume_change_mm3(const HexMesh& voxels, const VoxelMaterial& material,
                         const std::vector<double>& u_mm, StrainTheory theory) {
  // Sums of ranges that do not depend on the threads.
  constexpr std::int32_t kRange = 4096;
  const std::int32_t count = voxels.element_count();
  std::vector<double> sums(std::size_t((count + kRange - 1) / kRange));
  parallel_for(sums.size(), [&](std::size_t range) {
    const std::int32_t begin = std::int32_t(range) * kRange;
    for (std::int32_t e = begin; e < std::min(begin + kRange, count); ++e) {
      if (theory == StrainTheory::finite) {
        sums[range] += element_energy(voxels, material, u_mm, e).volume_change;
      } else {
        const Matrix9 gradient = centre_gradient(voxels, material, u_mm, e);
        sums[range] += gradient[0] + gradient[4] + gradient[8];
      }
    }
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0) * material.matrix.volume_mm3;
}

Vec3d centre_displacement(const HexMesh& voxels, const std::vector<double>& u_mm,
                          std::int32_t element) {
  return centre_displacement(voxels.corners(element), u_mm);
}

Vec3d centre_displacement(const Corners& corners, const std::vector<double>& u_mm) {
  Vec3d sum(0);
  for (const NodeIndex node : corners) {
    const double* u = &u_mm[3 * std::size_t(node)];
    sum += Vec3d(u[0], u[1], u[2]);
  }
  return sum / 8;
}

}  // namespace supple

#include "lib/fem/fem_results.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

double trace(const SymmetricTensor& t) {
  return t[0] + t[1] + t[2];
}

}  // namespace

/// By the angle of the cubic's trigonometric solution (Smith 1961).
std::array<double, 3> eigenvalues(const SymmetricTensor& t) {
  const double mean = trace(t) / 3;
  const double a = t[0] - mean, b = t[1] - mean, c = t[2] - mean;
  const double off = t[3] * t[3] + t[4] * t[4] + t[5] * t[5];
  const double p = std::sqrt((a * a + b * b + c * c + 2 * off) / 6);
  if (p == 0) return {mean, mean, mean};
  const double determinant =
      a * (b * c - t[4] * t[4]) - t[3] * (t[3] * c - t[4] * t[5]) + t[5] * (t[3] * t[4] - b * t[5]);
  const double angle = std::acos(std::clamp(determinant / (2 * p * p * p), -1.0, 1.0)) / 3;
  const double largest = mean + 2 * p * std::cos(angle);
  const double smallest = mean + 2 * p * std::cos(angle + 2 * 3.14159265358979323846 / 3);
  return {largest, 3 * mean - largest - smallest, smallest};
}

ElementState element_state(const HexMesh& voxels, const VoxelMaterial& material,
                           const std::vector<double>& u_mm, std::int32_t element) {
  const Corners& corners = voxels.corners[element];
  // The gradient of the mean of tr e is that of the shape functions at the centre.
  double gradient[3][3] = {};  // [component][direction]
  double local[24];
  for (int n = 0; n < 24; ++n) {
    local[n] = u_mm[3 * std::size_t(corners[n / 3]) + n % 3];
    for (int d = 0; d < 3; ++d) {
      gradient[n % 3][d] += local[n] * material.matrix.gradient[3 * (n / 3) + d];
    }
  }
  const auto mean = [&](int a, int b) { return (gradient[a][b] + gradient[b][a]) / 2; };
  ElementState out;
  out.strain = {gradient[0][0], gradient[1][1], gradient[2][2], mean(0, 1), mean(1, 2), mean(2, 0)};
  out.rotation_rad = {(gradient[2][1] - gradient[1][2]) / 2, (gradient[0][2] - gradient[2][0]) / 2,
                      (gradient[1][0] - gradient[0][1]) / 2};
  const std::uint8_t of = material.classes[element];
  const double shear = material.moduli.shear[of], bulk = material.moduli.bulk[of];
  for (int n = 0; n < 6; ++n) out.stress_kpa[n] = 2 * shear * out.strain[n];
  const double volumetric = (bulk - 2 * shear / 3) * trace(out.strain);
  for (int n = 0; n < 3; ++n) out.stress_kpa[n] += volumetric;
  double energy = 0;
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

double value_of(const ElementState& state, FemQuantity quantity) {
  const SymmetricTensor& s = state.stress_kpa;
  switch (quantity) {
    case FemQuantity::von_mises: {
      const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
      const double off = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
      return std::sqrt((a * a + b * b + c * c) / 2 + 3 * off);
    }
    case FemQuantity::pressure:
      return -trace(s) / 3;
    case FemQuantity::principal_1:
      return eigenvalues(s)[0];
    case FemQuantity::principal_2:
      return eigenvalues(s)[1];
    case FemQuantity::principal_3:
      return eigenvalues(s)[2];
    case FemQuantity::energy_density:
      return state.energy_density_kpa;
    case FemQuantity::strain_1:
      return eigenvalues(state.strain)[0];
    case FemQuantity::strain_3:
      return eigenvalues(state.strain)[2];
    case FemQuantity::volume_strain:
      break;
  }
  return trace(state.strain);
}

std::vector<float> element_values(const HexMesh& voxels, const VoxelMaterial& material,
                                  const std::vector<double>& u_mm, FemQuantity quantity) {
  std::vector<float> values(voxels.corners.size());
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, voxels.element_count(), 256),
                    [&](const tbb::blocked_range<std::int32_t>& range) {
                      for (std::int32_t e = range.begin(); e < range.end(); ++e) {
                        values[e] =
                            float(value_of(element_state(voxels, material, u_mm, e), quantity));
                      }
                    });
  return values;
}

LargestMotion largest_motion(const HexMesh& voxels, const VoxelMaterial& material,
                             const std::vector<double>& u_mm) {
  const auto larger = [](const LargestMotion& a, const LargestMotion& b) {
    return LargestMotion{std::max(a.rotation_deg, b.rotation_deg), std::max(a.strain, b.strain)};
  };
  const auto of_range = [&](const tbb::blocked_range<std::int32_t>& range, LargestMotion sum) {
    for (std::int32_t e = range.begin(); e < range.end(); ++e) {
      const ElementState state = element_state(voxels, material, u_mm, e);
      const std::array<double, 3> principal = eigenvalues(state.strain);
      sum = larger(sum, {state.rotation_rad.length() * kDegrees,
                         std::max(std::abs(principal[0]), std::abs(principal[2]))});
    }
    return sum;
  };
  return tbb::parallel_reduce(tbb::blocked_range<std::int32_t>(0, voxels.element_count(), 256),
                              LargestMotion{}, of_range, larger);
}

Vec3d centre_displacement(const HexMesh& voxels, const std::vector<double>& u_mm,
                          std::int32_t element) {
  Vec3d sum(0);
  for (const NodeIndex node : voxels.corners[element]) {
    const double* u = &u_mm[3 * std::size_t(node)];
    sum += Vec3d(u[0], u[1], u[2]);
  }
  return sum / 8;
}

}  // namespace supple

#include "lib/fem/fem_stress.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

constexpr double kPi = 3.14159265358979323846;

double trace(const Symmetric6& t) {
  return t[0] + t[1] + t[2];
}

Symmetric6 strain_of(const std::array<Vec3d, 3>& gradient) {
  const auto mean = [&](int a, int b) {
    return 0.5 * (gradient[std::size_t(a)][b] + gradient[std::size_t(b)][a]);
  };
  return {mean(0, 0), mean(1, 1), mean(2, 2), mean(1, 2), mean(0, 2), mean(0, 1)};
}

}  // namespace

const char* name_of(ElementQuantity quantity) {
  static constexpr const char* kNames[kElementQuantities] = {
      "von_mises", "principal_max", "principal_min", "pressure", "energy_density", "strain"};
  return kNames[int(quantity)];
}

const char* unit_of(ElementQuantity quantity) {
  return quantity == ElementQuantity::largest_strain ? "" : "kPa";
}

double von_mises(const Symmetric6& t) {
  const double squares = (t[0] - t[1]) * (t[0] - t[1]) + (t[1] - t[2]) * (t[1] - t[2]) +
                         (t[2] - t[0]) * (t[2] - t[0]);
  return std::sqrt(0.5 * squares + 3 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]));
}

std::array<double, 3> principal_values(const Symmetric6& t) {
  const double mean = trace(t) / 3;
  const double a = t[0] - mean, b = t[1] - mean, c = t[2] - mean;
  const double off = t[3] * t[3] + t[4] * t[4] + t[5] * t[5];
  const double p = std::sqrt((a * a + b * b + c * c + 2 * off) / 6);
  if (p == 0) return {mean, mean, mean};
  const double det = a * (b * c - t[3] * t[3]) - t[5] * (t[5] * c - t[3] * t[4]) +
                     t[4] * (t[5] * t[3] - b * t[4]);
  const double angle = std::acos(std::clamp(det / (2 * p * p * p), -1.0, 1.0)) / 3;
  const double largest = mean + 2 * p * std::cos(angle);
  const double smallest = mean + 2 * p * std::cos(angle + 2 * kPi / 3);
  return {smallest, 3 * mean - largest - smallest, largest};
}

ElementStress::ElementStress(const HexMesh& mesh, const std::vector<double>& u_mm,
                             const std::vector<std::uint8_t>& classes, const ElasticTable& elastic,
                             Dilatation dilatation)
    : m_mesh(mesh),
      m_u_mm(u_mm),
      m_classes(classes),
      m_elastic(elastic),
      m_matrix(element_matrix(mesh.geometry.axes_mm(), dilatation)),
      m_gradients(shape_gradients(mesh.geometry.axes_mm(), Vec3d(0.0))) {}

std::array<Vec3d, 3> ElementStress::gradient(std::int32_t element) const {
  std::array<Vec3d, 3> gradient{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};
  const Corners& corners = m_mesh.corners[std::size_t(element)];
  for (std::size_t n = 0; n < 8; ++n) {
    const double* u = &m_u_mm[3 * std::size_t(corners[n])];
    for (std::size_t a = 0; a < 3; ++a) gradient[a] += m_gradients[n] * u[a];
  }
  return gradient;
}

ElasticModuli ElementStress::moduli(std::size_t block, std::int32_t element) const {
  const std::size_t cls =
      m_classes[block * kBrickVoxels + m_mesh.offset[std::size_t(element)]];
  return elastic_moduli(m_elastic.young_kpa[cls], m_elastic.poisson[cls]);
}

Symmetric6 ElementStress::stress_kpa(std::size_t block, std::int32_t element) const {
  const Symmetric6 strain = strain_of(gradient(element));
  const ElasticModuli of = moduli(block, element);
  const double mean = trace(strain) / 3;
  Symmetric6 stress;
  for (std::size_t n = 0; n < 6; ++n) {
    const double sphere = n < 3 ? mean : 0;
    stress[n] = 2 * of.shear_kpa * (strain[n] - sphere) + 3 * of.bulk_kpa * sphere;
  }
  return stress;
}

double ElementStress::energy_density(std::size_t block, std::int32_t element) const {
  const ElasticModuli of = moduli(block, element);
  const Corners& corners = m_mesh.corners[std::size_t(element)];
  Vector24 u;
  for (std::size_t n = 0; n < 24; ++n) u[n] = m_u_mm[3 * std::size_t(corners[n / 3]) + n % 3];
  double energy = 0;
  for (std::size_t row = 0; row < 24; ++row) {
    double shear = 0, bulk = 0;
    for (std::size_t column = 0; column < 24; ++column) {
      shear += m_matrix.shear[row][column] * u[column];
      bulk += m_matrix.bulk[row][column] * u[column];
    }
    energy += u[row] * (of.shear_kpa * shear + of.bulk_kpa * bulk);
  }
  return 0.5 * energy / m_matrix.volume_mm3;
}

double ElementStress::value(ElementQuantity quantity, std::size_t block,
                            std::int32_t element) const {
  switch (quantity) {
    case ElementQuantity::von_mises:
      return von_mises(stress_kpa(block, element));
    case ElementQuantity::principal_max:
      return principal_values(stress_kpa(block, element))[2];
    case ElementQuantity::principal_min:
      return principal_values(stress_kpa(block, element))[0];
    case ElementQuantity::pressure:
      return -trace(stress_kpa(block, element)) / 3;
    case ElementQuantity::energy_density:
      return energy_density(block, element);
    case ElementQuantity::largest_strain:
      break;
  }
  const std::array<double, 3> strains = principal_values(strain_of(gradient(element)));
  return std::abs(strains[0]) > std::abs(strains[2]) ? strains[0] : strains[2];
}

}  // namespace supple

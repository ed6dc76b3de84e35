#include "lib/fem/dynamics/mass.h"

#include <cmath>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// (kg/m^3) mm^3 in kg.
constexpr double kKgPerDensityVolume = 1e-9;

}  // namespace

ClassParts even_parts(double part) {
  ClassParts parts;
  parts.fill(part);
  return parts;
}

VoxelMaterial weighted_material(const VoxelMaterial& material, const MassDensities& density,
                                const ClassParts& stiffness_parts, double mass_part_per_s2) {
  VoxelMaterial out = material;
  for (std::size_t n = 0; n < density.size(); ++n) {
    if (!(density[n] > 0) || !std::isfinite(density[n])) {
      throw InputError({"", "density", number_text(density[n]), "above 0 kg/m³"});
    }
    out.moduli.shear[n] *= stiffness_parts[n];
    out.moduli.bulk[n] *= stiffness_parts[n];
    out.moduli.inertia[n] = mass_part_per_s2 * density[n] * kKgPerDensityVolume;
    out.moduli_single.shear[n] = float(out.moduli.shear[n]);
    out.moduli_single.bulk[n] = float(out.moduli.bulk[n]);
    out.moduli_single.inertia[n] = float(out.moduli.inertia[n]);
  }
  return out;
}

std::vector<double> MassMatrix::times(const std::vector<double>& x) const {
  std::vector<double> y(x.size(), 0.0);
  add(x.data(), y.data());
  return y;
}

}  // namespace supple

#include "lib/fem/elastic_law.h"

#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

ElasticTable ElasticTable::uniform(double young_kpa, double poisson) {
  ElasticTable table;
  table.young_kpa.fill(young_kpa);
  table.poisson.fill(poisson);
  return table;
}

void ElasticTable::validate() const {
  for (int n = 0; n <= kLastClass; ++n) {
    require(young_kpa[n] > 0 && std::isfinite(young_kpa[n]), "stiffness", young_kpa[n],
            "above 0 kPa");
    require(poisson[n] > -1 && poisson[n] <= kLargestPoisson, "poisson", poisson[n],
            "above -1 and at most 0.4999");
  }
}

ClassParts even_parts(double part) {
  ClassParts parts;
  parts.fill(part);
  return parts;
}

ModuliTable<double> weighted_moduli(const ModuliTable<double>& moduli,
                                    const ElementWeights& weights) {
  ModuliTable<double> out = moduli;
  for (std::size_t n = 0; n < weights.density.size(); ++n) {
    const double density = weights.density[n];
    if (!(density > 0) || !std::isfinite(density)) {
      throw InputError({"", "density", number_text(density), "above 0 kg/m³"});
    }
    out.shear[n] *= weights.stiffness_parts[n];
    out.bulk[n] *= weights.stiffness_parts[n];
    out.inertia[n] = weights.mass_part_per_s2 * density * kM3PerMm3;
  }
  return out;
}

}  // namespace supple

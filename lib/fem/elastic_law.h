// Isotropic elasticity as numbers per material class (Body::classes): Young's modulus and Poisson's
// ratio as they are given, shear and bulk modulus as elements use them.
#pragma once

#include <algorithm>
#include <array>

#include "lib/body/body.h"
#include "lib/fem/fem_report.h"

namespace supple {

/// Elastic constants per material class.
struct ElasticTable {
  std::array<double, kLastClass + 1> young_kpa, poisson;

  static ElasticTable uniform(double young_kpa, double poisson);
  /// Throws InputError: 0 < E < infinity, -1 < nu <= kLargestPoisson expected.
  void validate() const;
};

struct ElasticModuli {
  double shear_kpa, bulk_kpa;  // mu, kappa
};
inline ElasticModuli elastic_moduli(double young_kpa, double poisson) {
  return {young_kpa / (2 * (1 + poisson)), young_kpa / (3 * (1 - 2 * poisson))};
}

/// Moduli per class: shear and bulk modulus in kPa, and inertia, which is what a matrix c M beside
/// the stiffness has per volume, in mN/mm^4 (kPa/mm^2); 0 where K stands alone.
template <class T>
struct ModuliTable {
  std::array<T, 256> shear, bulk;
  std::array<T, 256> inertia{};

  bool has_inertia() const {
    return std::any_of(inertia.begin(), inertia.end(), [](T value) { return value != 0; });
  }
};

/// kg/m^3 per class.
using MassDensities = std::array<double, 256>;

/// A factor of the stiffness, per class.
using ClassParts = std::array<double, 256>;
/// Gives all classes the same factor.
ClassParts even_parts(double part);

/// A sum over elements of a K, and c M, with the consistent mass M: a without a unit, c in 1/s^2.
/// K u is in mN of u in mm, and so is c M u.
struct ElementWeights {
  MassDensities density;
  ClassParts stiffness_parts;
  double mass_part_per_s2 = 0;
};

/// The moduli of that sum. Throws InputError for a density that is not above 0.
ModuliTable<double> weighted_moduli(const ModuliTable<double>& moduli,
                                    const ElementWeights& weights);

}  // namespace supple

// The mass matrix of elastic elements.
//
// M is the consistent mass, M = sum over elements of integral rho N N: it is what the displacement
// of the elements says of their kinetic energy, needs no rule for corners of mixed material, and
// costs an operator without a matrix nothing (element_matrix.h). Frequencies come from above, as
// those of the stiffness do; a lumped mass would bring them from below, with errors of the same
// size.
#pragma once

#include <memory>
#include <vector>

#include "lib/fem/elastic_solid.h"

namespace supple {

/// Mass matrix M in kg. Its product with a vector in mm is in kg mm, with one in mm/s^2 in mN.
class MassMatrix {
 public:
  /// `solid` must outlive this. Throws InputError for a density that is not above 0.
  MassMatrix(const ElasticSolid& solid, const MassDensities& density)
      : m_operator(solid.weighted({density, even_parts(0), 1})) {}

  /// y += M x.
  void add(const double* x, double* y) const { m_operator->add(x, y); }
  /// M x.
  std::vector<double> times(const std::vector<double>& x) const {
    std::vector<double> y(x.size(), 0.0);
    add(x.data(), y.data());
    return y;
  }
  const Operator& matrix() const { return *m_operator; }
  std::size_t bytes() const { return m_operator->bytes(); }

 private:
  std::unique_ptr<Operator> m_operator;
};

}  // namespace supple

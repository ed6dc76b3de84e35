// Rows of `supple bench fem` on tetrahedra: a swelling ball of which a part of the surface is held.
#pragma once

#include <string>
#include <vector>

#include "lib/fem/tet/tet_fem.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

struct TetRow {
  TetElement element = TetElement::linear;
  TetEquations equations = TetEquations::gradients;
  int size = 18;  // cubes along an axis, each cut into six, pulled onto spheres
  double poisson = 0.3;
  bool has_dura = false;  // 2.5 MPa, nu = 0.48, 0.6 mm
  StrainTheory strain = StrainTheory::linear;

  /// tets/element/size/nu, with /dura, /factor or /finite behind it.
  std::string name() const;
};

std::vector<TetRow> tet_rows(bool quick);
/// Preparation and solution to 1e-8, with the assembly of the matrix apart. Throws as
/// TetModel::solve().
BenchRow measure_tets(const TetRow& row, int rounds, int threads, Progress& cancel);

}  // namespace supple::tools

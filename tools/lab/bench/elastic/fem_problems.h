// Bodies, constants and loads that `supple bench fem` solves.
#pragma once

#include <string>

#include "lib/fem/voxel/fem.h"

namespace supple::tools {

struct FemProblem {
  Body body;
  ElasticTable elastic;
  FemLoads loads;
};

/// The body and load of one row of a solve.
struct FemSubject {
  /// cube    one material;
  /// ball    one material, just inside its box;
  /// shell   a ball of tissue in a shell that is `contrast` times as stiff (nu = 0.3), a fifth of
  ///         the radius thick;
  /// random  a cube of which 30 % of the voxels, hashed, are `contrast` times as stiff (nu = 0.3);
  /// head    a head CT: tissue of 6 kPa and nu = 0.45, from 250 HU on bone of 10 MPa and nu = 0.3.
  std::string field;
  int size = 0;  // voxels per axis; 0: the head CT's own
  double poisson = 0.3;
  double contrast = 1;
};

/// Voxels of 1 mm and tissue of 1 kPa, but for the head. Cubes and balls are glued to plates below
/// and above, of which the upper one moves by 1 % of the height upwards and 0.5 % sideways; the
/// shell stands on a plate, and a force acts on the middle of what it holds; in the head a voxel of
/// the upper jaw moves by 2 mm and one of the back of the skull stays. Throws as load_volume().
FemProblem fem_problem(const FemSubject& subject, const std::string& head);

}  // namespace supple::tools

// Bodies, constants and loads on which the estimate of the displacement's error (error_estimate.h)
// is calibrated: random ones of ten kinds, the same on every machine.
#pragma once

#include <string>
#include <vector>

#include "tools/lab/bench/elastic/fem_problems.h"

namespace supple::tools {

/// Kinds of bodies:
///   noise       stiff voxels, 5 to 60 % of all;
///   inclusions  stiff balls;
///   shell       a stiff shell around soft tissue;
///   plate       one to four voxels thick, with stiff voxels;
///   foam        soft and stiff struts around pores;
///   gyri        a folded stiff cortex around soft tissue;
///   bar         blocks of soft and stiff tissue in a row;
///   skull       skin, bone with a jaw of its own, brain;
///   layers      stiff sheets in soft tissue, at times with gaps between;
///   random      blocks of six materials, some left out.
/// Voxels are 1 mm wide, at times longer along z. Soft tissue has 1 kPa and nu from 0.3 to 0.499,
/// stiff tissue 2 to 100,000 times as much. One side stays; the other side, one handle, two
/// handles, a force or gravity acts, which of them by the number.
const std::vector<std::string>& error_kinds();
FemProblem error_problem(const std::string& kind, int number);

}  // namespace supple::tools

// `supple bench fem`: how fast the operator of voxel finite elements is, how long solves take and
// what memory they need, and how iterations grow with the contrast of stiffness and with Poisson's
// ratio.
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

struct FemBenchOptions {
  bool quick = false;
  int threads = 0;  // 0: two, one on a single core
  std::vector<std::string> only;
  std::string ct_head;  // a head CT; empty: build/data/ct_head.nhdr where it is
};

/// Names of the rows that these options choose, in order, without measuring any. Throws UsageError
/// when `only` leaves none.
std::vector<std::string> fem_row_names(const FemBenchOptions& options, Console& console);

/// Rows by case:
///   operator    products with the stiffness matrix, one and several threads, both precisions;
///   solve       bodies of one material and the head, to the tolerances that steps have;
///   iterations  the same of contrasts and Poisson's ratios; what does not converge is a row, too.
/// Throws UsageError when `only` leaves no row, Cancelled.
BenchReport bench_fem(const FemBenchOptions& options, Console& console);

}  // namespace supple::tools

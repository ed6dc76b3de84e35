// The benchmarks by name.
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/options/lab_options.h"

namespace supple::tools {

struct Bench {
  const char* name;
  /// Names of the rows that the options choose, in order, without measuring any. Throws UsageError
  /// when `only` leaves none.
  std::vector<std::string> (*row_names)(const BenchOptions& options, Console& console);
  /// Throws UsageError when `only` leaves no row, Cancelled, and Error where sides disagree.
  BenchReport (*measure)(const BenchOptions& options, Console& console);
};

/// The benchmark of a name. A build with SUPPLE_BENCH=OFF (no_benches.cpp) throws UsageError.
const Bench& bench_named(const std::string& name);

std::vector<std::string> ecm_row_names(const BenchOptions& options, Console& console);
BenchReport bench_ecm(const BenchOptions& options, Console& console);
std::vector<std::string> economy_row_names(const BenchOptions& options, Console& console);
BenchReport bench_economy(const BenchOptions& options, Console& console);
std::vector<std::string> fem_row_names(const BenchOptions& options, Console& console);
BenchReport bench_fem(const BenchOptions& options, Console& console);
std::vector<std::string> fit_row_names(const BenchOptions& options, Console& console);
BenchReport bench_fit(const BenchOptions& options, Console& console);
std::vector<std::string> invert_row_names(const BenchOptions& options, Console& console);
BenchReport bench_invert(const BenchOptions& options, Console& console);
std::vector<std::string> io_row_names(const BenchOptions& options, Console& console);
BenchReport bench_io(const BenchOptions& options, Console& console);
std::vector<std::string> membrane_row_names(const BenchOptions& options, Console& console);
BenchReport bench_membrane(const BenchOptions& options, Console& console);
std::vector<std::string> mesh_row_names(const BenchOptions& options, Console& console);
BenchReport bench_mesh(const BenchOptions& options, Console& console);
std::vector<std::string> relax_row_names(const BenchOptions& options, Console& console);
BenchReport bench_relax(const BenchOptions& options, Console& console);
std::vector<std::string> render_row_names(const BenchOptions& options, Console& console);
BenchReport bench_render(const BenchOptions& options, Console& console);
std::vector<std::string> springs_row_names(const BenchOptions& options, Console& console);
BenchReport bench_springs(const BenchOptions& options, Console& console);

}  // namespace supple::tools

#include "tools/lab/bench/elastic/error_rows.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tools/lab/bench/elastic/error_bodies.h"

namespace supple::tools {

namespace {

/// Errors that are asked for, relative to the 95th percentile of all displacements.
constexpr double kErrors[] = {0.05, 0.01, 0.003};

/// The 95th percentile of |a - b| over nodes of which a component is free.
double difference_between(const std::vector<double>& a, const std::vector<double>& b,
                          const HeldBits& held) {
  std::vector<double> lengths;
  for (std::size_t n = 0; n < held.size(); ++n) {
    if (held[n] == kAllHeld) continue;
    double square = 0;
    for (std::size_t i = 3 * n; i < 3 * n + 3; ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
    lengths.push_back(std::sqrt(square));
  }
  if (lengths.empty()) return 0;
  const auto at = lengths.begin() + std::ptrdiff_t(0.95 * double(lengths.size() - 1));
  std::nth_element(lengths.begin(), at, lengths.end());
  return *at;
}

struct ErrorSums {
  int bodies = 0, within = 0, iterations = 0, iterations_to_rounding = 0;
  std::int64_t elements = 0;
  std::vector<double> ratios;  // of errors to their estimates
};

void add_body(const FemProblem& problem, Progress& cancel, ErrorSums& sums) {
  const FemModel model(problem.body, problem.elastic, Dilatation::mean, &cancel);
  FemParams params;
  params.max_iterations = 5000;
  params.tolerance = 1e-9;
  params.reaction_tolerance = 1e-8;
  const FemSolution exact = model.solve(problem.loads, params, &cancel);
  const HeldBits held = held_bits(model.mesh(), problem.loads.held);
  const double farthest_mm =
      difference_between(exact.u_mm, std::vector<double>(exact.u_mm.size()), held);
  sums.bodies += 1;
  sums.elements += exact.report.elements;
  sums.iterations_to_rounding += exact.report.iterations;
  params.tolerance.reset();
  params.reaction_tolerance.reset();
  for (const double part : kErrors) {
    params.error_mm = part * farthest_mm;
    const FemSolution found = model.solve(problem.loads, params, &cancel);
    const double error_mm = difference_between(found.u_mm, exact.u_mm, held);
    sums.iterations += found.report.iterations;
    sums.within += error_mm <= *found.report.error_mm;
    sums.ratios.push_back(error_mm / *found.report.error_mm);
  }
}

}  // namespace

BenchRow measure_errors(const std::string& kind, int bodies, Progress& cancel) {
  ErrorSums sums;
  for (int number = 0; number < bodies; ++number) {
    add_body(error_problem(kind, number), cancel, sums);
  }
  std::sort(sums.ratios.begin(), sums.ratios.end());
  const double solutions = double(sums.ratios.size());
  return {{"case", "error"},
          {"field", kind},
          {"bodies", sums.bodies},
          {"elements", sums.elements},
          {"solutions", sums.ratios.size()},
          {"within", sums.within / solutions},
          {"largest_ratio", sums.ratios.back()},
          {"median_ratio", sums.ratios[sums.ratios.size() / 2]},
          {"iterations", sums.iterations / solutions},
          {"iterations_to_rounding", double(sums.iterations_to_rounding) / sums.bodies}};
}

}  // namespace supple::tools

// `supple bench fem`: how fast the operator of voxel finite elements is, how long solves take and
// what memory they need, and how iterations grow with the contrast of stiffness and with Poisson's
// ratio; and solves on tetrahedra.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include "lib/fem/voxel/hex_operator.h"
#include "tools/console/command.h"
#include "tools/console/console.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/bodies/ecm_bodies.h"
#include "tools/lab/bench/elastic/error_bodies.h"
#include "tools/lab/bench/elastic/error_rows.h"
#include "tools/lab/bench/elastic/fem_problems.h"
#include "tools/lab/bench/elastic/response_rows.h"
#include "tools/lab/bench/elastic/tet_rows.h"
#include "tools/lab/bench/report/memory.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/base/parallel.h"
#include "volumes/base/relayed_progress.h"

namespace supple::tools {

namespace {

/// Number of iterations far above that of any row that converges.
constexpr int kMostIterations = 1000;
/// Bodies of each kind of the rows `error`: 120 in all.
constexpr int kErrorBodies = 12;
/// The memory that a solve is sure to stay below, per element: the own solver and others.
constexpr std::int64_t kBytesPerElement = 400, kPeerBytesPerElement = 30000;
constexpr const char* kSolverNames[] = {"multigrid", "calculix", "calculix-iterative", "dolfinx"};

struct FemBenchRow {
  std::string kind;  // the row's `case`
  FemSubject subject;
  std::string precision;  // of operator rows
  EquationSolver solver = EquationSolver::multigrid;
  int threads = 1;
  TetRow tets;  // of such rows
  ResponseRow responses;

  /// operator/cube/size/precision/threads, solve/field/size/nu, beside/field/size/solver,
  /// iterations/field/size/contrast/nu or error/field.
  std::string name() const {
    if (kind == "tets") return tets.name();
    if (kind == "responses") return responses.name(subject);
    if (kind == "error") return kind + "/" + subject.field;
    char numbers[64];
    if (kind == "operator") {
      std::snprintf(numbers, sizeof numbers, "%d/%s/%d", subject.size, precision.c_str(), threads);
    } else if (kind == "iterations") {
      std::snprintf(numbers, sizeof numbers, "%d/%g/%g", subject.size, subject.contrast,
                    subject.poisson);
    } else if (kind == "beside") {
      std::snprintf(numbers, sizeof numbers, "%d/%s", subject.size, kSolverNames[int(solver)]);
    } else if (subject.field == "head") {
      return kind + "/head";
    } else {
      std::snprintf(numbers, sizeof numbers, "%d/%g", subject.size, subject.poisson);
    }
    return kind + "/" + subject.field + "/" + numbers;
  }
};

FemBenchRow row_of_body(const char* kind, const char* field, int size, int threads) {
  FemBenchRow row;
  row.kind = kind;
  row.subject.field = field;
  row.subject.size = size;
  row.threads = threads;
  return row;
}

void plan_operators(bool quick, int threads, std::vector<FemBenchRow>& plan) {
  for (const int size : quick ? std::vector<int>{64} : std::vector<int>{64, 128}) {
    for (const char* precision : {"single", "double"}) {
      for (int used = 1; used <= threads; used += std::max(1, threads - 1)) {
        plan.push_back(row_of_body("operator", "cube", size, used));
        plan.back().precision = precision;
      }
    }
  }
}

/// Other programs with the same equations, the own solver first.
void plan_peers(int threads, std::vector<FemBenchRow>& plan) {
  const auto add = [&](int size, EquationSolver solver) {
    plan.push_back(row_of_body("beside", "cube", size, threads));
    plan.back().solver = solver;
  };
  for (const EquationSolver solver :
       {EquationSolver::multigrid, EquationSolver::dolfinx, EquationSolver::calculix_iterative,
        EquationSolver::calculix}) {
    add(32, solver);
  }
  for (const EquationSolver solver : {EquationSolver::multigrid, EquationSolver::dolfinx}) {
    add(64, solver);
  }
}

void plan_iterations(bool quick, int threads, std::vector<FemBenchRow>& plan) {
  using Numbers = std::vector<double>;
  const Numbers contrasts = quick ? Numbers{1, 1e6} : Numbers{1, 10, 1e2, 1e3, 1e4, 1e5, 1e6};
  const Numbers ratios = quick ? Numbers{0.3, 0.49} : Numbers{0.3, 0.45, 0.49, 0.499, 0.4999};
  const auto add = [&](const char* field, int size, double poisson, double contrast) {
    plan.push_back(row_of_body("iterations", field, size, threads));
    plan.back().subject.poisson = poisson;
    plan.back().subject.contrast = contrast;
  };
  for (const double poisson : ratios) {
    for (const double contrast : contrasts) add("shell", 32, poisson, contrast);
  }
  for (const double contrast : contrasts) add("random", 32, 0.3, contrast);
  if (quick) return;
  for (const double contrast : {1.0, 1e3, 1e6}) add("shell", 64, 0.3, contrast);
}

std::vector<FemBenchRow> plan_fem(const BenchOptions& options, const std::string& head) {
  int threads = options.threads;
  if (threads == 0) threads = std::min(2, int(std::thread::hardware_concurrency()));
  std::vector<FemBenchRow> plan;
  plan_operators(options.quick, threads, plan);
  for (const int size : options.quick ? std::vector<int>{32, 64} : std::vector<int>{32, 64, 128}) {
    plan.push_back(row_of_body("solve", "cube", size, threads));
  }
  if (!options.quick) {
    plan.push_back(row_of_body("solve", "cube", 256, threads));
    plan.push_back(row_of_body("solve", "ball", 96, threads));
    if (!head.empty()) plan.push_back(row_of_body("solve", "head", 0, threads));
    plan_peers(threads, plan);
  }
  plan_iterations(options.quick, threads, plan);
  for (const ResponseRow& row : response_rows()) {
    plan.push_back(row_of_body("responses", "cube", options.quick ? 32 : 64, threads));
    plan.back().responses = row;
  }
  for (const std::string& kind : error_kinds()) {
    plan.push_back(row_of_body("error", kind.c_str(), 0, threads));
  }
  for (const TetRow& row : tet_rows(options.quick)) {
    plan.push_back(row_of_body("tets", "ball", row.size, threads));
    plan.back().tets = row;
  }
  plan.erase(std::remove_if(
                 plan.begin(), plan.end(),
                 [&](const FemBenchRow& row) { return !is_wanted_row(options.only, row.name()); }),
             plan.end());
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as solve/cube/64/0.3"}));
  }
  return plan;
}

BenchRow fem_fields(const FemBenchRow& row, const Body& body, std::int64_t unknowns) {
  const Vec3i size = body.geometry.dims();
  return {{"case", row.kind},
          {"field", row.subject.field},
          {"size", {size.x, size.y, size.z}},
          {"elements", body.elements.active_count()},
          {"unknowns", unknowns}};
}

/// Side of one thread count and precision: products with a vector that is not zero anywhere.
template <class T>
TimedSide product_side(const HexOperator& stiffness, int threads) {
  const std::size_t count = 3 * std::size_t(stiffness.mesh().node_count());
  auto x = std::make_shared<std::vector<T>>(count);
  for (std::size_t n = 0; n < count; ++n) (*x)[n] = T(1) + T(n % 17) / T(16);
  auto y = std::make_shared<std::vector<T>>(count, T(0));
  TimedSide side;
  side.run = [=, &stiffness](Times& times) {
    const ThreadLimit limit(threads);
    times.ms.push_back(time_ms([&] { stiffness.add(x->data(), y->data()); }));
  };
  return side;
}

/// Rows of one size, in turns.
std::vector<BenchRow> measure_operators(const std::vector<FemBenchRow>& rows, bool quick,
                                        Progress& cancel) {
  const FemProblem problem = fem_problem(rows.front().subject, "");
  const FemModel model(problem.body, problem.elastic);
  const HexOperator stiffness(model.mesh(), model.material());
  std::vector<TimedSide> sides;
  for (const FemBenchRow& row : rows) {
    sides.push_back(row.precision == "single" ? product_side<float>(stiffness, row.threads)
                                              : product_side<double>(stiffness, row.threads));
    Times warm_up;
    sides.back().run(warm_up);
  }
  take_turns(sides, quick ? RoundLimits{5, 20, 500} : RoundLimits{10, 40, 4000},
             [&] { report(&cancel, 0); });
  std::vector<BenchRow> result;
  const std::int64_t unknowns = 3 * std::int64_t(model.mesh().node_count());
  for (std::size_t n = 0; n < rows.size(); ++n) {
    BenchRow fields = fem_fields(rows[n], problem.body, unknowns);
    fields["precision"] = rows[n].precision;
    fields["munknowns_per_s"] = double(unknowns) / 1e3 / sides[n].times.median();
    fields["bytes_per_unknown"] = double(stiffness.bytes()) / double(unknowns);
    add_times(fields, sides[n].times, rows[n].threads);
    result.push_back(std::move(fields));
  }
  return result;
}

/// One solve from the body on; the time of building the hierarchy is in it.
struct TimedSolve {
  FemReport report;
  bool converged = true;
  double ms = 0, cpu_ms = 0;
};

TimedSolve solve_once(const FemProblem& problem, EquationSolver solver, Progress& cancel) {
  TimedSolve solve;
  FemParams params;
  params.max_iterations = kMostIterations;
  params.solver = solver;
  solve.cpu_ms = cpu_time_ms([&] {
    solve.ms = time_ms([&] {
      const FemModel model(problem.body, problem.elastic, Dilatation::mean, &cancel);
      try {
        solve.report = model.solve(problem.loads, params, &cancel).report;
      } catch (const NotConverged& error) {
        solve.report = error.report();
        solve.converged = false;
      }
    });
  });
  return solve;
}

BenchRow measure_solve(const FemBenchRow& row, const BenchOptions& options, const std::string& head,
                       Progress& cancel) {
  if (row.kind == "tets") return measure_tets(row.tets, options.quick ? 1 : 3, row.threads, cancel);
  if (row.kind == "error") {
    const ThreadLimit limit(row.threads);
    return measure_errors(row.subject.field, options.quick ? 2 : kErrorBodies, cancel);
  }
  const FemProblem problem = fem_problem(row.subject, head);
  if (row.kind == "responses") {
    BenchRow fields =
        measure_responses(row.responses, problem, options.quick ? 1 : 3, row.threads, cancel);
    fields["case"] = row.kind;
    fields["field"] = row.subject.field + (row.responses.is_sum ? ", sum" : ", beside");
    fields["size"] = row.subject.size;
    return fields;
  }
  const bool is_small = problem.body.elements.active_count() < 1000000;
  const int rounds = options.quick || !is_small || row.kind == "iterations" ? 1 : 3;
  const ThreadLimit limit(row.threads);
  TimedSolve solve;
  Times times, cpu;
  const PeakMemory peak;
  for (int round = 0; round < rounds; ++round) {
    solve = solve_once(problem, row.solver, cancel);
    times.ms.push_back(solve.ms);
    cpu.ms.push_back(solve.cpu_ms);
  }
  const auto growth = peak.growth();
  const FemReport& report = solve.report;
  const double unknowns = double(report.unknowns);
  BenchRow fields = fem_fields(row, problem.body, report.unknowns);
  if (row.subject.field != "head") fields["poisson"] = row.subject.poisson;
  if (row.kind == "iterations") fields["contrast"] = row.subject.contrast;
  if (row.kind == "beside") fields["solver"] = kSolverNames[int(row.solver)];
  const bool is_own = row.solver == EquationSolver::multigrid;
  if (is_own) fields["levels"] = report.levels;
  fields["iterations"] = report.iterations;
  fields["converged"] = solve.converged;
  fields["residual_max"] = report.residual_max;
  if (is_own) fields["reaction_change"] = report.reaction_change;
  if (solve.converged) {
    fields["force_balance"] = report.force_balance;
    fields["energy_identity"] = report.energy_identity;
  }
  fields["setup_ms"] = times.ms.back() - report.solve_ms;
  fields["solve_ms"] = report.solve_ms;
  fields["munknowns_per_s"] = unknowns / 1e3 / times.median();
  if (is_own) fields["munknowns_per_cpu_s"] = unknowns / 1e3 / cpu.median();
  fields["bytes_per_unknown"] = double(report.bytes) / unknowns;
  if (growth && !is_small) fields["peak_bytes_per_unknown"] = double(*growth) / unknowns;
  if (is_own) fields["cpu_ms"] = cpu.median();
  add_times(fields, times, row.threads);
  return fields;
}

/// True if the memory at hand holds the row's cube; adds a note if it does not.
bool has_memory_for(const FemBenchRow& row, Console& console) {
  const std::int64_t size = row.subject.size;
  const std::int64_t each =
      row.solver == EquationSolver::multigrid ? kBytesPerElement : kPeerBytesPerElement;
  if (size * size * size * each <= available_bytes()) return true;
  console.note("not enough memory: row " + row.name() + " is left out");
  return false;
}

}  // namespace

std::vector<std::string> fem_row_names(const BenchOptions& options, Console& console) {
  std::vector<std::string> names;
  const std::string head = head_file(options.ct_head, options.only.empty(), console);
  for (const FemBenchRow& row : plan_fem(options, head)) names.push_back(row.name());
  return names;
}

/// Rows by case:
///   operator    products with the stiffness matrix, one and several threads, both precisions;
///   solve       bodies of one material and the head, to the tolerances that steps have;
///   iterations  the same of contrasts and Poisson's ratios; what does not converge is a row, too;
///   responses   shifts of a cube's plate, solved beside each other, and their sums;
///   error       true errors of displacements by those that solutions report;
///   tets        a swelling ball of tetrahedra.
/// Throws UsageError when `only` leaves no row, Cancelled.
BenchReport bench_fem(const BenchOptions& options, Console& console) {
  const std::string head = head_file(options.ct_head, options.only.empty(), console);
  const std::vector<FemBenchRow> plan = plan_fem(options, head);
  BenchReport result{"fem", measure_machine(), {}};
  CancelOnly cancel(&console);
  for (auto first = plan.begin(); first != plan.end();) {
    console.stage(first->name());
    if (first->kind != "operator") {
      if (has_memory_for(*first, console)) {
        try {
          result.rows.push_back(measure_solve(*first, options, head, cancel));
        } catch (const InputError& error) {
          if (first->solver == EquationSolver::multigrid) throw;
          console.note("row " + first->name() + " is left out: " + error.what());
        }
      }
      ++first;
      continue;
    }
    const auto last = std::find_if(first, plan.end(), [&](const FemBenchRow& row) {
      return row.kind != "operator" || row.subject.size != first->subject.size;
    });
    for (BenchRow& row : measure_operators({first, last}, options.quick, cancel)) {
      result.rows.push_back(std::move(row));
    }
    first = last;
  }
  return result;
}

}  // namespace supple::tools

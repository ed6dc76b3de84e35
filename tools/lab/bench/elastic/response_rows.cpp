#include "tools/lab/bench/elastic/response_rows.h"

#include <algorithm>

#include "lib/fem/response/response_field.h"
#include "lib/model/fem_grips.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

/// The handle that moves the body goes by 1 mm along an axis.
NodalLoads shifted_along(int axis, const FemModel& model, const FemProblem& problem,
                         Progress& cancel) {
  FemLoads loads = problem.loads;
  for (HeldElements& held : loads.held) {
    if (!held.displacement_mm) continue;
    held.displacement_mm = [axis](const Vec3d&) {
      Vec3d by(0.0);
      by[axis] = 1;
      return by;
    };
  }
  FemReport report;
  return model.checked_loads(loads, {}, &cancel, report);
}

}  // namespace

std::string ResponseRow::name(const FemSubject& subject) const {
  return "responses/" + subject.field + "/" + std::to_string(subject.size) +
         (is_sum ? "/sum/" : "/beside/") + std::to_string(responses);
}

std::vector<ResponseRow> response_rows() {
  return {{false, 1}, {false, 3}, {true, 3}, {true, 12}};
}

BenchRow measure_responses(const ResponseRow& row, const FemProblem& problem, int rounds,
                           int threads, Progress& cancel) {
  const ThreadLimit limit(threads);
  const FemModel model(problem.body, problem.elastic, Dilatation::mean, &cancel);
  std::vector<NodalLoads> loads;
  for (int n = 0; n < std::min(row.responses, 3); ++n) {
    loads.push_back(shifted_along(n, model, problem, cancel));
  }
  Times times, cpu;
  std::vector<NodalSolution> solutions;
  const auto measure = [&](auto&& work) {
    cpu.ms.push_back(cpu_time_ms([&] { times.ms.push_back(time_ms(work)); }));
  };
  const double unknowns = 3.0 * model.mesh().node_count();
  BenchRow fields = {{"elements", problem.body.elements.active_count()},
                     {"responses", row.responses}};
  if (!row.is_sum) {
    for (int round = 0; round < rounds; ++round) {
      measure([&] { solutions = model.solve_beside(loads, {}, &cancel); });
    }
    for (const NodalSolution& of : solutions) fields["iterations"].push_back(of.iterations);
    fields["bytes_per_unknown"] = double(solutions.back().bytes) / unknowns;
  } else {
    ResponseField field;
    std::vector<double> parts;
    solutions = model.solve_beside({loads.front()}, {}, &cancel);
    for (int n = 0; n < row.responses; ++n) {
      std::vector<float> values;
      for (const Vec3d& at : at_centres(model.mesh(), solutions.front().u_mm)) {
        for (int a = 0; a < 3; ++a) values.push_back(float(at[a]));
      }
      field.add(std::make_shared<const std::vector<float>>(std::move(values)));
      parts.push_back(1 + 0.1 * n);
    }
    std::vector<Vec3f> out(std::size_t(model.mesh().element_count()));
    constexpr std::size_t kShare = 1 << 14;
    for (int round = 0; round < 10 * rounds; ++round) {
      measure([&] {
        parallel_for((out.size() + kShare - 1) / kShare, [&](std::size_t share) {
          const std::size_t begin = share * kShare, end = std::min(out.size(), begin + kShare);
          field.sum(parts, begin, end, &out[begin]);
        });
      });
    }
    fields["bytes_per_unknown"] = double(field.bytes()) / unknowns;
  }
  fields["cpu_ms"] = cpu.median();
  add_times(fields, times, threads);
  return fields;
}

}  // namespace supple::tools

// Rows of `supple bench fem` of responses: solutions beside each other, and their sums.
#pragma once

#include <string>
#include <vector>

#include "tools/lab/bench/elastic/fem_problems.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

/// `beside`: so many shifts of what moves the body, solved together; `sum`: their sum at all
/// elements.
struct ResponseRow {
  bool is_sum = false;
  int responses = 1;

  /// responses/field/size/beside or sum/responses.
  std::string name(const FemSubject& subject) const;
};

std::vector<ResponseRow> response_rows();
/// Throws as FemModel::solve_beside().
BenchRow measure_responses(const ResponseRow& row, const FemProblem& problem, int rounds,
                           int threads, Progress& cancel);

}  // namespace supple::tools

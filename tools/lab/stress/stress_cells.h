// The matrix of `supple stress`: every model under every extreme that concerns it, and what is
// expected.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/lab/stress/stress_extremes.h"

namespace supple::tools {

struct StressCell {
  const StressExtreme* extreme = nullptr;
  const StressModel* model = nullptr;

  std::string name() const;              // "far-drag/ecm-6"
  const StressRefusal* refusal() const;  // null: the model keeps its promise
  std::string expectation() const;       // in words
};

/// All of them, by extremes.
std::vector<StressCell> stress_cells();

/// Of the matrix the rows that are wanted: by names of extremes, models or rows (empty: all),
/// without long ones unless they are named or asked for; `quick`: of each extreme one, models
/// taking turns. Throws UsageError for an unknown name.
struct StressChoice {
  std::vector<std::string> only;
  bool quick = false;
  bool with_long = false;
};
std::vector<StressCell> cells_of(const StressChoice& choice);

/// The row of that name. Throws UsageError.
StressCell stress_cell_named(const std::string& name);

/// The input of a row.
StressInput input_of(const StressCell& cell);

}  // namespace supple::tools

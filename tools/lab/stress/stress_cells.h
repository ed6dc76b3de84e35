// The matrix of `supple stress`: every model under every extreme that concerns it, and what is
// expected.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/lab/options/lab_options.h"
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

/// The rows that are wanted. Throws UsageError for an unknown name.
std::vector<StressCell> cells_of(const StressChoice& choice);

/// The row of that name. Throws UsageError.
StressCell stress_cell_named(const std::string& name);

/// The input of a row.
StressInput input_of(const StressCell& cell);

}  // namespace supple::tools

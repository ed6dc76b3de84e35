// The matrix of `supple stress` and its results as text, Markdown, CSV and JSON.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/console/console.h"
#include "tools/lab/options/lab_options.h"
#include "tools/lab/stress/stress_extremes.h"
#include "tools/lab/stress/stress_verdict.h"
#include "volumes/base/process.h"

namespace supple::tools {

// The matrix of `supple stress`: every model under every extreme that concerns it, and what is
// expected.

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

/// Tables of the documentation: each model with its promise; each extreme with the models that keep
/// theirs, and those that are refused.
std::string models_markdown();
std::string extremes_markdown();

// Rows of `supple stress`, each in a process of its own: a crash, a hang or too much memory is the
// verdict of a row, and the others go on.

struct StressRow : StressVerdict {
  StressCell cell;
  double wall_s = 0, peak_mb = 0;
};

/// Runs the rows, and calls `done` after each. Throws Cancelled, SystemError.
std::vector<StressRow> run_stress(const StressOptions& options, Console& console,
                                  const std::function<void(const StressRow&)>& done);

/// One row in this process, in a folder that is there: what was measured. Throws as the row does.
MeasuredValues run_row(const StressCell& cell, const std::string& folder, Console& console);

/// One line per row, with what is expected.
std::string cells_text(const std::vector<StressCell>& cells);
/// A row of results, two lines where it disagrees.
std::string row_text(const StressRow& row);

std::string to_markdown(const std::vector<StressRow>& rows);
std::string to_csv(const std::vector<StressRow>& rows);
nlohmann::ordered_json to_json(const std::vector<StressRow>& rows);

}  // namespace supple::tools

// The matrix of `supple stress` and its results as text, Markdown, CSV and JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/lab/stress/stress_runs.h"

namespace supple::tools {

/// Tables of the documentation: each model with its promise; each extreme with the models that keep
/// theirs, and those that are refused.
std::string models_markdown();
std::string extremes_markdown();

/// One line per row, with what is expected.
std::string cells_text(const std::vector<StressCell>& cells);
/// A row of results, two lines where it disagrees.
std::string row_text(const StressRow& row);

std::string to_markdown(const std::vector<StressRow>& rows);
std::string to_csv(const std::vector<StressRow>& rows);
nlohmann::ordered_json to_json(const std::vector<StressRow>& rows);

}  // namespace supple::tools

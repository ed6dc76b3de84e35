// Results of a benchmark: rows of named fields, as JSON and as tables (design.md section 9).
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/lab/bench/report/machine.h"

namespace supple::tools {

/// One measured line; the keys are the fields that design.md section 9 names, in column order.
using BenchRow = nlohmann::ordered_json;

struct BenchReport {
  std::string benchmark;
  MachineFacts machine;
  std::vector<BenchRow> rows;
};

nlohmann::ordered_json to_json(const BenchReport& report);

/// One aligned table per `case`, columns in the order in which its rows first name them.
std::string to_text(const BenchReport& report);
/// The same as tables of a Markdown document.
std::string to_markdown(const BenchReport& report);

/// Replaces `path` as a whole, or not at all. Throws SystemError.
void write_json(const std::string& path, const BenchReport& report);

// The rows of a benchmark that `--only` chooses.

/// True when the name holds one of the patterns (* stands for anything), or when there are none.
bool is_wanted_row(const std::vector<std::string>& only, const std::string& name);

}  // namespace supple::tools

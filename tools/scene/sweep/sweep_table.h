// The table of a sweep: a row per case, a column per key, per result, and one of errors.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/scene/sweep/sweep.h"

namespace supple::tools {

/// A result that a table is to have: the name of its column, and that in the report.
struct Collected {
  std::string column, name;
};

/// Reads NAME=PATH, or a path that is also the name. Throws UsageError for an empty one.
Collected parse_collected(const std::string& text);

struct SweepTable {
  struct Row {
    std::vector<std::string> values;  // of the keys, as they were written; empty: the scene's
    std::vector<Value> results;       // null where the case has none
    std::string error;
  };
  std::vector<std::string> keys, results;  // names of columns
  std::vector<Row> rows;
};

/// The results that tables have unless told otherwise: the main ones of all reports, each under
/// the shortest end of its name that no other has.
std::vector<Collected> main_results(const std::vector<CaseEnd>& ends);

/// Puts the table together. `wanted` empty: the main results. Throws InputError for a result that
/// no report has where there is any report, and for two columns of one name.
SweepTable make_table(const SweepCases& cases, const std::vector<CaseEnd>& ends,
                      std::vector<Collected> wanted);

/// The names of keys, then those of results.
std::vector<std::string> column_names(const SweepTable& table);
/// The place among them of a name, or of the only one that ends with it. Throws InputError, which
/// names the option.
std::size_t column_of(const SweepTable& table, const std::string& name, const std::string& option);

std::string to_csv(const SweepTable& table);
/// Columns side by side with numbers to six digits, for people. `cleaned`: the text of a cell as it
/// may stand on a terminal.
std::string to_text(const SweepTable& table,
                    const std::function<std::string(std::string)>& cleaned);
Value to_value(const SweepTable& table);

}  // namespace supple::tools

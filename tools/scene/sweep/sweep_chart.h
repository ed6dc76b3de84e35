// The diagram of a sweep: a result against a key, a curve for each value of the other keys.
#pragma once

#include <string>
#include <vector>

#include "tools/scene/chart/chart.h"
#include "tools/scene/sweep/sweep_table.h"

namespace supple::tools {

/// Columns of the axes: whole names or ends of them; empty: the first key that has several values,
/// and the first result that has several.
struct ChartChoice {
  std::string x, y;
  bool x_is_log = false, y_is_log = false;
};

/// Draws the rows that have both values. Throws InputError for a column that the table does not
/// have, and where no row has a point.
Chart chart_of(const SweepTable& table, const SweepCases& cases, const ChartChoice& choice);

}  // namespace supple::tools

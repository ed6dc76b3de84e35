// Results of the cases of a cohort: lines of JSON, a table, and a page with small pictures.
#pragma once

#include <string>
#include <vector>

#include "tools/scene/cohort/cohort.h"
#include "tools/scene/sweep/sweep_table.h"

namespace supple::tools {

/// Lines of the cases that are done, or of those that failed.
std::string lines_of(const std::vector<CohortEnd>& ends, bool failed);
/// Number of cases that failed.
std::size_t failures_of(const std::vector<CohortEnd>& ends);
/// A row per case: its name, its values, the main results, and its error.
SweepTable table_of(const Cohort& cohort, const std::vector<CohortEnd>& ends);
/// HTML beside the folder of cases, whose pictures it shows.
std::string cohort_page(const Cohort& cohort, const std::vector<CohortEnd>& ends);

}  // namespace supple::tools

// Runs scenes under many methods, each run a process of its own (`supple run --method`), so that
// peak memory is that of the method, and neither a crash nor a time limit ends the rest. Times are
// those of the stages that the run itself reports, not of its start.
//
// Rows are written to DIR/runs.csv as they are complete. A later call goes on after them: rows of
// the same scene, volume, program and number of threads are not measured again.
#pragma once

#include <string>
#include <vector>

#include "tools/console/console.h"
#include "tools/scene/step_method.h"
#include "tools/tradeoff/trade_row.h"
#include "tools/tradeoff/trade_tables.h"

namespace supple::tools {

/// Finite elements to this tolerance are what others are compared with.
constexpr double kReferenceTolerance = 1e-10;
StepMethod reference_method();

struct TradeOptions {
  std::vector<std::string> scenes;
  std::string folder;
  std::vector<StepMethod> methods;
  int runs = 5;
  double limit_s = 600;  // of one run
  double row_s = 60;     // no further run of a row begins after so long
  int threads = 0;
};

/// The methods whose names begin with one of these, with each value of their ladders; of
/// "NAME:KNOB" that one alone; all for none. Throws InputError for a name of none.
std::vector<StepMethod> methods_named(const std::vector<std::string>& names);

struct TradeScene {
  std::string file, name;  // as given; the name of its files
  std::string volume;      // as it was found
  double floor_mm = 0;     // errors below are none: the steps in which places are stored, or what
                           // the reference itself is uncertain by
};

struct TradeResults {
  std::string machine;
  std::vector<TradeScene> scenes;
  std::vector<TradeRow> rows;  // the reference of each scene is its first
};

/// Points of one of the scenes as curves.
SceneCurves curves_of(const TradeResults& results, const TradeScene& scene);

/// Measures what DIR/runs.csv does not hold. Throws InputError as read_scene, and for files of two
/// scenes with one name; Error where a reference cannot be solved; Cancelled: complete rows are in
/// the file.
TradeResults run_tradeoff(const TradeOptions& options, Console& console);

}  // namespace supple::tools

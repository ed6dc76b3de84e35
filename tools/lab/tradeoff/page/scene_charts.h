// The diagrams of scenes: time of solving against error and, where there are drawings, time of
// drawing against likeness.
#pragma once

#include <string>
#include <vector>

#include "tools/lab/tradeoff/page/trade_chart.h"
#include "tools/lab/tradeoff/trade_runs.h"

namespace supple::tools {

LogChart chart_of(const TradeResults& results, const SceneCurves& curves);

struct ChartFile {
  std::string name, svg;  // "error_time_SCENE.svg", "likeness_time_SCENE.svg"
};
/// Every diagram of the page.
std::vector<ChartFile> chart_files(const TradeResults& results);

}  // namespace supple::tools

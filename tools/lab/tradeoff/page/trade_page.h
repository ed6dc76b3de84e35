// The results of a trade-off as files: JSON with curves and tables, a page that needs no network,
// and its diagrams as files of their own.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/lab/tradeoff/trade_runs.h"

namespace supple::tools {

/// Scenes, rows, fronts and tables; fields as docs/tradeoff.md lists them.
nlohmann::ordered_json to_json(const TradeResults& results);

/// HTML with charts inside: every point and every number of a table leads to its row of the CSV.
std::string trade_page(const TradeResults& results);

struct ChartFile {
  std::string name, svg;  // "error_time_SCENE.svg", "likeness_time_SCENE.svg"
};
/// Every diagram of the page: time of solving against error and, where there are drawings, time of
/// drawing against likeness.
std::vector<ChartFile> chart_files(const TradeResults& results);

}  // namespace supple::tools

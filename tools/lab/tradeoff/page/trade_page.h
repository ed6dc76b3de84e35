// The results of a trade-off as files: JSON with curves and tables, and a page that needs no
// network.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/lab/tradeoff/trade_runs.h"

namespace supple::tools {

/// Scenes, rows, fronts and tables; fields as docs/tradeoff.md lists them.
nlohmann::ordered_json to_json(const TradeResults& results);

/// HTML with charts inside: every point and every number of a table leads to its row of the CSV.
std::string trade_page(const TradeResults& results);

}  // namespace supple::tools

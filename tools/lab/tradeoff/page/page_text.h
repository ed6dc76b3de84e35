// Words of the page: numbers, times, and what is said of a row wherever it is shown.
#pragma once

#include <string>

#include "tools/scene/choice/trade_row.h"

namespace supple::tools {

/// A number to three digits.
std::string short_number(double value);
/// "16 ms", "1.5 s", "2 min".
std::string time_text(double seconds);
/// "1 s (0.9 s to 1.2 s)".
std::string spread_text(const Spread& spread);

/// Rows are named by their lines in runs.csv, whose first line has the names of columns.
std::string row_id(std::size_t row);
/// Name, command, times and errors, in lines.
std::string tip_of(const TradeRow& row);

}  // namespace supple::tools

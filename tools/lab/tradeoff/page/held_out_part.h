// The part of the page about the held-out load: what choices from the other loads did on it.
#pragma once

#include <string>

#include "tools/lab/tradeoff/trade_runs.h"

namespace supple::tools {

/// A heading, a table and what it means.
std::string held_out_part(const TradeResults& results);

}  // namespace supple::tools

// Methods for scenes that have no table of `supple tradeoff`, and how exact each was on the loads
// of docs/tradeoff.md. Of two methods the one that promises less error was nearer on every load.
#pragma once

#include <string>
#include <vector>

namespace supple::tools {

std::vector<std::string> shipped_methods();

/// Error of one of them that is expected at the 95th percentile where the longest way of a handle
/// is `way_mm`; the worst of all loads.
double shipped_error_mm(const std::string& method, double way_mm);

}  // namespace supple::tools

// Methods for scenes that have no table of `supple tradeoff`: how exact each was on the loads of
// docs/tradeoff.md, and how long plans of the scene say that it takes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/tradeoff/method_choice.h"

namespace supple::tools {

/// By ascending time, in s, which `solve_s` says of a method. The errors, 95th percentiles, are
/// parts of the longest way of a handle; the worst of all loads.
std::vector<MethodChoice> shipped_choices(
    double way_mm, const std::function<double(const std::string& method)>& solve_s);

}  // namespace supple::tools

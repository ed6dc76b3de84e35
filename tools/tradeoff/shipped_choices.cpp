#include "tools/tradeoff/shipped_choices.h"

#include <algorithm>

namespace supple::tools {

namespace {

struct ShippedMethod {
  const char* name;
  double error_part;  // of the way of the handle
};

/// Of docs/tradeoff.md#without-a-table; what another one beats in time and error is left out.
constexpr ShippedMethod kMethods[] = {
    {"ecm:26", 0.95},  {"relax-6:16", 0.59}, {"relax-6:64", 0.27},
    {"fem:0.1", 0.06}, {"fem:0.01", 0.01},
};

}  // namespace

std::vector<MethodChoice> shipped_choices(
    double way_mm, const std::function<double(const std::string& method)>& solve_s) {
  std::vector<MethodChoice> choices;
  for (const ShippedMethod& method : kMethods) {
    choices.push_back({method.name, solve_s(method.name), method.error_part * way_mm});
  }
  sort_by_time(choices);
  return choices;
}

}  // namespace supple::tools

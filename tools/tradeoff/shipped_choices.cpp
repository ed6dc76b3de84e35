#include "tools/tradeoff/shipped_choices.h"

namespace supple::tools {

namespace {

struct ShippedMethod {
  const char* name;
  double s_per_million_voxels;
  double error_part;  // of the way of the handle
};

/// Of docs/tradeoff.md#without-a-table; what another one beats in time and error is left out.
constexpr ShippedMethod kMethods[] = {
    {"ecm:6", 1.1, 0.96},      {"ecm:26", 1.2, 0.95},  {"relax-6:16", 1.5, 0.59},
    {"relax-6:64", 2.3, 0.27}, {"fem:0.1", 5.8, 0.06}, {"fem:0.01", 8, 0.01},
};

}  // namespace

std::vector<MethodChoice> shipped_choices(std::int64_t voxels, double way_mm) {
  std::vector<MethodChoice> choices;
  for (const ShippedMethod& method : kMethods) {
    choices.push_back({method.name, method.s_per_million_voxels * double(voxels) / 1e6,
                       method.error_part * way_mm});
  }
  return choices;
}

}  // namespace supple::tools

#include "tools/scene/choice/shipped_choices.h"

#include <map>

namespace supple::tools {

namespace {

/// Parts of the way of the handle, of docs/tradeoff.md#without-a-table. A method is left out where
/// another one beats it in time and error, and where it was farther off than a faster one on any
/// load, as 64 passes of relaxation than 16.
const std::map<std::string, double> kErrorParts = {
    {"ecm:26", 1.0},   {"relax-6:16", 0.9}, {"fem-coarse:2", 0.26},
    {"fem:0.1", 0.06}, {"fem:0.01", 0.01},
};

}  // namespace

std::vector<std::string> shipped_methods() {
  std::vector<std::string> methods;
  for (const auto& [method, part] : kErrorParts) methods.push_back(method);
  return methods;
}

double shipped_error_mm(const std::string& method, double way_mm) {
  return kErrorParts.at(method) * way_mm;
}

}  // namespace supple::tools

#include "tools/lab/bench/report/row_filter.h"

#include <algorithm>

#include <fnmatch.h>

namespace supple::tools {

bool is_wanted_row(const std::vector<std::string>& only, const std::string& name) {
  return only.empty() || std::any_of(only.begin(), only.end(), [&](const std::string& pattern) {
           return ::fnmatch(("*" + pattern + "*").c_str(), name.c_str(), 0) == 0;
         });
}

}  // namespace supple::tools

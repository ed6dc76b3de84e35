// Which rows of a benchmark `--only` chooses.
#pragma once

#include <string>
#include <vector>

namespace supple::tools {

/// True when the name holds one of the patterns (* stands for anything), or when there are none.
bool is_wanted_row(const std::vector<std::string>& only, const std::string& name);

}  // namespace supple::tools

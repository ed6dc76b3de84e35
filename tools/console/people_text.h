// Values of reports as people read them.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace supple::tools {

/// Numbers that are no integers to four digits, strings without quotes, lists in brackets.
std::string people_text(const nlohmann::ordered_json& value);

}  // namespace supple::tools

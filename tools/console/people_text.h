// Values of reports as people read them.
#pragma once

#include <string>

#include "volumes/base/value.h"

namespace supple::tools {

/// Numbers that are no integers to four digits, strings without quotes, lists in brackets.
std::string people_text(const Value& value);

}  // namespace supple::tools

// Which program this is, as files that it writes say it.
#pragma once

#include <string>

namespace supple::tools {

/// "1.2.3, commit abc".
std::string program_version();

}  // namespace supple::tools

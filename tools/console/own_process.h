// This process: where its program lies, and the most memory that it has held.
#pragma once

#include <string>

namespace supple::tools {

/// The file of the program that is running.
std::string own_program();

/// The largest resident size of the process so far, in millions of bytes. That of the program which
/// started it does not count.
double peak_rss_mb();

}  // namespace supple::tools

// This process: where its program lies, and the memory that it holds and has held.
#pragma once

#include <string>

namespace supple::tools {

/// The file of the program that is running.
std::string own_program();

/// The resident size of the process, in millions of bytes.
double rss_mb();

/// The largest resident size of the process so far, in millions of bytes. That of the program which
/// started it does not count.
double peak_rss_mb();

}  // namespace supple::tools

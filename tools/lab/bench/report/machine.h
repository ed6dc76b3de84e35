// The machine a benchmark ran on, with its memory bandwidth measured in the same run.
#pragma once

#include <string>

namespace supple::tools {

struct MachineFacts {
  std::string cpu;
  int cores = 0;                     // that this process may use
  std::string isa;                   // widest vector extension that the program was compiled for
  double triad_gb_s = 0;             // with every thread that --threads allows
  double triad_one_thread_gb_s = 0;  // with one
};

/// Measures about half a second: a[i] = b[i] + s * c[i] over 3 x 64 MiB of doubles, best of twelve,
/// 24 bytes per element as STREAM counts them.
MachineFacts measure_machine();

}  // namespace supple::tools

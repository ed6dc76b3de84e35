// Stands in for the benchmarks in a build that leaves them out.
#include "tools/console/command.h"
#include "tools/lab/bench/benches.h"

namespace supple::tools {

const Bench& bench_named(const std::string& name) {
  throw UsageError("bench " + name +
                   ": this program was built without benchmarks (-DSUPPLE_BENCH=ON adds them)");
}

}  // namespace supple::tools

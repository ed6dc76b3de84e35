// Stands in for the benchmarks in a build that leaves them out.
#include "tools/console/command.h"
#include "tools/lab/bench/benches.h"

namespace supple::tools {

Bench bench_of(const BenchOptions& options, int, Console&) {
  throw UsageError("bench " + options.name +
                   ": this program was built without benchmarks (-DSUPPLE_BENCH=ON adds them)");
}

}  // namespace supple::tools

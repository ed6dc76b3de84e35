// Work on a given number of threads, also on more than the machine has cores.
#pragma once

#include <cstddef>
#include <utility>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

namespace supple {

/// Runs `work` on that many threads and returns its result. TBB's limit alone only lowers the
/// number of threads: beyond the cores an arena of that size is needed, too.
template <class Work>
auto on_threads(int threads, Work&& work) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  std::size_t(threads));
  tbb::task_arena arena(threads);
  return arena.execute(std::forward<Work>(work));
}

}  // namespace supple

// Loops and sums on all threads, the number of threads, and what threads share: oneTBB, which no
// other file names. Indices come in any order and many at a time, so work writes only what belongs
// to its index; sums are of whole numbers, or the largest of something. Results then do not depend
// on the number of threads.
#pragma once

#include <cstddef>
#include <utility>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/blocked_range2d.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>
#include <oneapi/tbb/parallel_sort.h>
#include <oneapi/tbb/spin_mutex.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

namespace supple {

/// Ranges of up to this many indices are not divided among threads.
struct Grain {
  std::size_t size;
};

/// Calls work(n) for n from `begin` to before `end`.
template <class Index, class Work>
void parallel_for(Index begin, Index end, const Work& work) {
  tbb::parallel_for(begin, end, work);
}

/// Calls work(n) for n from 0 to before `count`.
template <class Index, class Work>
void parallel_for(Index count, const Work& work) {
  tbb::parallel_for(Index(0), count, work);
}

/// Calls work(begin, end) for ranges that together are 0 to before `count`.
template <class Index, class Work>
void parallel_ranges(Index count, Grain grain, const Work& work) {
  using Range = tbb::blocked_range<Index>;
  tbb::parallel_for(Range(0, count, grain.size),
                    [&](const Range& range) { work(range.begin(), range.end()); });
}

/// Calls work(n) for n from 0 to before `count`.
template <class Index, class Work>
void parallel_for(Index count, Grain grain, const Work& work) {
  parallel_ranges(count, grain, [&](Index begin, Index end) {
    for (Index n = begin; n < end; ++n) work(n);
  });
}

/// Joins what work(begin, end, sum) returns for ranges that together are 0 to before `count`; `sum`
/// is that of earlier ranges, or `zero`. join(sum, later_sum) must not depend on how they are cut.
template <class Index, class Sum, class Work, class Join>
Sum reduce_ranges(Index count, Grain grain, const Sum& zero, const Work& work, const Join& join) {
  using Range = tbb::blocked_range<Index>;
  return tbb::parallel_reduce(
      Range(0, count, grain.size), zero,
      [&](const Range& range, Sum sum) { return work(range.begin(), range.end(), std::move(sum)); },
      join);
}

/// Joins sums to each of which add(n, sum) adds some of n from 0 to before `count`.
template <class Index, class Sum, class Add, class Join>
Sum parallel_reduce(Index count, Grain grain, const Sum& zero, const Add& add, const Join& join) {
  const auto add_range = [&](Index begin, Index end, Sum sum) {
    for (Index n = begin; n < end; ++n) add(n, sum);
    return sum;
  };
  return reduce_ranges(count, grain, zero, add_range, join);
}

/// Sorts like std::sort.
template <class Iterator, class Less>
void parallel_sort(Iterator begin, Iterator end, const Less& less) {
  tbb::parallel_sort(begin, end, less);
}

/// Calls work(begin, end) once or so for each thread, with equal shares of 0 to before `count`.
template <class Index, class Work>
void parallel_shares(Index count, const Work& work) {
  using Range = tbb::blocked_range<Index>;
  tbb::parallel_for(
      Range(0, count), [&](const Range& range) { work(range.begin(), range.end()); },
      tbb::static_partitioner());
}

struct PixelTile {
  int row_begin, row_end, column_begin, column_end;
};

/// Calls work(tile) for tiles of a picture that have at most `size` rows and columns.
template <class Work>
void parallel_tiles(int rows, int columns, Grain size, const Work& work) {
  using Range = tbb::blocked_range2d<int>;
  tbb::parallel_for(
      Range(0, rows, size.size, 0, columns, size.size),
      [&](const Range& part) {
        work(PixelTile{part.rows().begin(), part.rows().end(), part.cols().begin(),
                       part.cols().end()});
      },
      tbb::simple_partitioner());
}

/// A value for each thread that asks for its own by local(); a loop over it has them all.
template <class T>
using PerThread = tbb::enumerable_thread_specific<T>;

/// A lock for a few instructions.
using SpinMutex = tbb::spin_mutex;

/// Tasks that run beside the thread that waits for them.
using TaskGroup = tbb::task_group;

/// While it lives, the process uses at most this many threads; it adds none beyond the cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads)
      : m_limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads)) {}

 private:
  tbb::global_control m_limit;
};

/// The number of threads that the process may use.
inline int thread_limit() {
  return int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

/// The number of threads that loops use here: also within on_threads().
inline int threads_here() {
  return tbb::this_task_arena::max_concurrency();
}

/// Runs `work` on that many threads and returns its result. A limit alone only lowers the number of
/// threads: beyond the cores an arena of that size is needed, too.
template <class Work>
auto on_threads(int threads, Work&& work) {
  const ThreadLimit limit(threads);
  tbb::task_arena arena(threads);
  return arena.execute(std::forward<Work>(work));
}

/// Runs `work`, which may be called from within a loop, without taking up other work of that loop
/// while it waits for its own loops.
template <class Work>
auto in_isolation(Work&& work) {
  return tbb::this_task_arena::isolate(std::forward<Work>(work));
}

/// A place to run loops on the calling thread alone. Once made it takes no lock, also in a copy of
/// the process that has none of the other threads, one of which may have held it.
class OneThread {
 public:
  OneThread() : m_arena(1) { m_arena.initialize(); }
  template <class Work>
  auto run(Work&& work) {
    return m_arena.execute(std::forward<Work>(work));
  }

 private:
  tbb::task_arena m_arena;
};

}  // namespace supple

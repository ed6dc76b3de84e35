#include <chrono>
#include <condition_variable>
#include <mutex>

#include <gtest/gtest.h>

#include "volumes/base/parallel.h"

namespace supple {
namespace {

/// True if all items of a loop are at work at the same time: each waits for the others.
bool all_meet(int items, int threads) {
  std::mutex mutex;
  std::condition_variable changed;
  int present = 0;
  bool given_up = false;
  const auto meet = [&](int) {
    std::unique_lock<std::mutex> lock(mutex);
    ++present;
    changed.notify_all();
    const auto settled = [&] { return given_up || present == items; };
    if (!changed.wait_for(lock, std::chrono::milliseconds(threads < items ? 100 : 60000),
                          settled)) {
      given_up = true;
    }
  };
  on_threads(threads, [&] {
    parallel_tiles(items, 1, Grain{1}, [&](const PixelTile& tile) { meet(tile.row_begin); });
  });
  return !given_up;
}

TEST(UnitOnThreads, AsManyItemsAsThreadsAreWorkedOnAtATimeAndNoMore) {
  for (const int threads : {1, 2, 3, 8}) {
    EXPECT_TRUE(all_meet(threads, threads)) << threads;
    EXPECT_FALSE(all_meet(threads + 1, threads)) << threads;
  }
}

TEST(UnitOnThreads, ResultsAndErrorsComeBack) {
  EXPECT_EQ(on_threads(3, [] { return 7; }), 7);
  EXPECT_THROW(on_threads(3, [] { throw std::runtime_error("no"); }), std::runtime_error);
}

}  // namespace
}  // namespace supple

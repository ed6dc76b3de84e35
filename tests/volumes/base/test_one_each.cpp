// Helpers that stand once: loops on threads, text of numbers, starting programs.
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <functional>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"
#include "volumes/base/files.h"
#include "volumes/base/parallel.h"
#include "volumes/base/process.h"
#include "volumes/base/simd.h"
#include "volumes/base/text.h"

using namespace supple;
using namespace supple::test;

namespace {

/// True if each of these counts is one.
bool are_ones(const std::vector<std::atomic<int>>& counts) {
  return std::all_of(counts.begin(), counts.end(), [](const auto& count) { return count == 1; });
}

}  // namespace

TEST(UnitParallel, EveryIndexIsVisitedOnceByAnyLoop) {
  for (const int threads : {1, 3}) {
    on_threads(threads, [] {
      std::vector<std::atomic<int>> plain(1000), grained(1000), ranges(1000), shares(1000);
      std::vector<std::atomic<int>> part(1000);
      parallel_for(plain.size(), [&](std::size_t n) { ++plain[n]; });
      parallel_for(grained.size(), Grain{7}, [&](std::size_t n) { ++grained[n]; });
      parallel_for(100, 900, [&](int n) { ++part[std::size_t(n)]; });
      const auto count_into = [](std::vector<std::atomic<int>>& counts) {
        return [&counts](std::size_t begin, std::size_t end) {
          for (std::size_t n = begin; n < end; ++n) ++counts[n];
        };
      };
      parallel_ranges(ranges.size(), Grain{64}, count_into(ranges));
      parallel_shares(shares.size(), count_into(shares));
      EXPECT_TRUE(are_ones(plain) && are_ones(grained) && are_ones(ranges) && are_ones(shares));
      for (std::size_t n = 0; n < part.size(); ++n) EXPECT_EQ(part[n], n >= 100 && n < 900) << n;
    });
  }
}

TEST(UnitParallel, TilesCoverAPictureOnceAndAreNoLargerThanAsked) {
  std::vector<std::atomic<int>> pixels(37 * 53);
  parallel_tiles(37, 53, Grain{8}, [&](const PixelTile& tile) {
    EXPECT_LE(tile.row_end - tile.row_begin, 8);
    EXPECT_LE(tile.column_end - tile.column_begin, 8);
    for (int y = tile.row_begin; y < tile.row_end; ++y) {
      for (int x = tile.column_begin; x < tile.column_end; ++x)
        ++pixels[std::size_t(53) * std::size_t(y) + std::size_t(x)];
    }
  });
  EXPECT_TRUE(are_ones(pixels));
}

TEST(UnitParallel, SumsOfWholeNumbersDoNotDependOnThreadsOrGrains) {
  for (const int threads : {1, 2, 5}) {
    for (const std::size_t grain : {1, 10, 5000}) {
      const auto sum = on_threads(threads, [&] {
        return parallel_reduce(
            std::size_t(1000), Grain{grain}, std::int64_t(0),
            [](std::size_t n, std::int64_t& to) { to += std::int64_t(n); }, std::plus<>());
      });
      EXPECT_EQ(sum, 499500) << threads << " threads, grain " << grain;
    }
  }
}

TEST(UnitParallel, ALimitOfThreadsLastsAsLongAsItsObject) {
  const int before = thread_limit();
  {
    const ThreadLimit one(1);
    EXPECT_EQ(thread_limit(), 1);
  }
  EXPECT_EQ(thread_limit(), before);
  EXPECT_EQ(on_threads(3, [] { return threads_here(); }), 3);
}

TEST(UnitText, NumbersHaveTheDigitsThatAreAskedFor) {
  EXPECT_EQ(number_text(1.0 / 3), "0.333333");
  EXPECT_EQ(number_text(1.0 / 3, 10), "0.3333333333");
  EXPECT_EQ(number_text(0.1, 17), "0.10000000000000001");
  EXPECT_EQ(decimal_text(12, 1), "12.0");
  EXPECT_EQ(decimal_text(1e300, 0).size(), 301u);
  EXPECT_EQ(to_text(Vec3d(0.5, -2, 1e7)), "0.5,-2,1e+07");
  EXPECT_EQ(to_text(Vec3d(0.5, -2, 3), " "), "0.5 -2 3");
  EXPECT_EQ(to_text(Vec3i(1, 2, -3), ", "), "1, 2, -3");
  EXPECT_TRUE(ends_with("a.vdb", ".vdb") && ends_with("", ""));
  EXPECT_FALSE(ends_with("vdb", ".vdb") || ends_with("a.vdb.gz", ".vdb"));
}

TEST(UnitVoxel, TheNearestOneOfAHalfIsAwayFromZeroAndOfTheFarthestStaysANumber) {
  EXPECT_EQ(nearest_voxel({0.5, -0.5, 0.49999999999999994}), Vec3i(1, -1, 0));
  EXPECT_EQ(nearest_voxel({1e300, -1e300, 2.4}), Vec3i(1000000000, -1000000000, 2));
}

TEST(UnitSimd, PacksAreLoadedFromAnyAddressAndComparedLaneByLane) {
  const float values[5] = {9, 0, 1, 2, 3};
  using Four = Pack<float, 4>;
  const auto pack = load_pack<Four>(values + 1);
  const Four low = lanes_min(pack, Four{} + 2.0f), high = lanes_max(pack, Four{} + 2.0f);
  for (int n = 0; n < 4; ++n) {
    EXPECT_EQ(low[n], std::min(float(n), 2.0f));
    EXPECT_EQ(high[n], std::max(float(n), 2.0f));
  }
  const Four cut = truncated(Four{1.9f, -1.9f, 0.5f, -3});
  EXPECT_TRUE(cut[0] == 1 && cut[1] == -1 && cut[2] == 0 && cut[3] == -3);
}

TEST(UnitProcess, AProgramGetsItsFolderEnvironmentAndStreams) {
  const TemporaryFolder folder;
  const std::string path = folder / "out";
  const int out = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ProgramStart start;
  start.words = {"sh", "-c", "pwd; echo $SUPPLE_TOLD; cat; exit 3"};
  start.folder = "/usr";
  start.environment = {"SUPPLE_TOLD=word"};
  start.in = ProgramStart::kNowhere;
  start.out = out;
  const pid_t process = start_program(start);
  ::close(out);
  ASSERT_GT(process, 0);
  const int status = wait_for_end(process);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 3);
  EXPECT_EQ(text_of_file(path), "/usr\nword\n");
}

TEST(UnitProcess, AProgramThatIsNotThereIsToldAtOnce) {
  ProgramStart start;
  start.words = {"supple-is-not-called-so"};
  EXPECT_EQ(start_program(start), -1);
  EXPECT_EQ(errno, ENOENT);
}

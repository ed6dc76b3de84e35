#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/random_state.h"
#include "tests/support/sanitized.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"

using namespace supple;
using namespace supple::test;

namespace {

/// The message of the InputError that reading gives, checked to be one line of at most 1 kB plus
/// the file's name; empty when the file reads.
std::string read_error(const std::string& path) {
  try {
    read_state(path);
  } catch (const InputError& error) {
    const std::string line = error.what();
    EXPECT_EQ(line.find('\n'), std::string::npos);
    EXPECT_LE(line.size(), 1100 + path.size());
    return line;
  }
  return "";
}

std::string small_state_bytes(const TemporaryFolder& folder) {
  write_state(folder / "good.vdb", random_state(21, 12));
  return read_text(folder / "good.vdb");
}

/// The message with which a state is refused before anything is written.
std::string write_error(const std::function<void(State&)>& damage) {
  const TemporaryFolder folder;
  State state = random_state(22);
  damage(state);
  std::string message;
  try {
    write_state(folder / "a.vdb", state);
  } catch (const InputError& error) {
    message = error.what();
  }
  EXPECT_EQ(folder.entries().size(), message.empty() ? 1u : 0u);
  return message;
}

}  // namespace

TEST(FaultState, EveryFlippedBitIsAnInputError) {
  const TemporaryFolder folder;
  const std::string good = small_state_bytes(folder);
  std::mt19937 random(1);
  for (int n = 0; n < cases(3000); ++n) {
    std::string bad = good;
    bad[random() % bad.size()] ^= char(1u << (random() % 8));
    write_text(folder / "bad.vdb", bad);
    ASSERT_NE(read_error(folder / "bad.vdb"), "") << "case " << n;
  }
}

TEST(FaultState, EveryTruncationAndEveryAppendedByteIsAnInputError) {
  const TemporaryFolder folder;
  const std::string good = small_state_bytes(folder);
  std::mt19937 random(2);
  for (int n = 0; n < 1000; ++n) {
    const std::size_t length = n < 300 ? std::size_t(n) : random() % good.size();
    write_text(folder / "bad.vdb", good.substr(0, length));
    ASSERT_NE(read_error(folder / "bad.vdb"), "") << "length " << length;
  }
  for (int n = 0; n < 100; ++n) {
    write_text(folder / "bad.vdb", good + std::string(1 + random() % 500, char(random())));
    ASSERT_NE(read_error(folder / "bad.vdb"), "");
  }
}

TEST(FaultState, OverwrittenRangesAreInputErrors) {
  const TemporaryFolder folder;
  const std::string good = small_state_bytes(folder);
  std::mt19937 random(3);
  for (int n = 0; n < cases(1000); ++n) {
    std::string bad = good;
    const std::size_t first = random() % bad.size();
    const std::size_t count = std::min<std::size_t>(1 + random() % 400, bad.size() - first);
    const bool zeros = random() % 2 == 0;
    for (std::size_t at = first; at < first + count; ++at) bad[at] = zeros ? 0 : char(random());
    if (bad == good) continue;
    write_text(folder / "bad.vdb", bad);
    ASSERT_NE(read_error(folder / "bad.vdb"), "") << "case " << n;
  }
}

TEST(FaultState, EachKindOfWrongFileHasItsOwnLine) {
  const TemporaryFolder folder;
  const std::string good = small_state_bytes(folder);
  const std::string path = folder / "bad.vdb";
  EXPECT_EQ(read_error(path), path + ": found no such file, expected a readable file");
  EXPECT_NE(read_error(folder / "").find("a directory"), std::string::npos);
  write_text(path, "");
  EXPECT_NE(read_error(path).find("an empty file"), std::string::npos);
  write_text(path, "NRRD0004\ntype: float\n");
  EXPECT_NE(read_error(path).find("not OpenVDB"), std::string::npos);
  EXPECT_FALSE(is_state_file(path));
  write_text(path, good.substr(0, good.size() - 128));
  EXPECT_NE(read_error(path).find("cut off"), std::string::npos);
  EXPECT_TRUE(is_state_file(path));
  std::string damaged = good;
  damaged[damaged.size() / 2] ^= 4;
  write_text(path, damaged);
  EXPECT_NE(read_error(path).find("damaged content"), std::string::npos);
  EXPECT_FALSE(is_state_file(folder / "missing.vdb"));
  EXPECT_FALSE(is_state_file(folder / ""));
}

TEST(FaultState, AFailedWriteKeepsTheOldFileAndLeavesNothingElse) {
  const TemporaryFolder folder;
  write_state(folder / "a.vdb", random_state(30, 6));
  const std::string old = read_text(folder / "a.vdb");
  const State large = random_state(31, 28);
  write_state(folder / "large.vdb", large);
  const std::size_t size = read_text(folder / "large.vdb").size();
  std::filesystem::remove(folder / "large.vdb");

  // Limits go from failing in the header to failing in the trailer.
  for (const std::size_t limit :
       {std::size_t(0), std::size_t(30), size / 2, size - 200, size - 1}) {
    std::string message;
    {
      const FileSizeLimit full(limit);
      try {
        write_state(folder / "a.vdb", large);
      } catch (const SystemError& error) {
        message = error.what();
      }
    }
    EXPECT_NE(message.find("cannot write: File too large"), std::string::npos)
        << "limit " << limit << ": " << message;
    EXPECT_EQ(read_text(folder / "a.vdb"), old);
    EXPECT_EQ(folder.entries().size(), 1u);
  }
}

/// Asks to stop when it is asked a second time while a state is on its way into its file, and hears
/// how far it came.
class StopInTheFile final : public Progress {
 public:
  void stage(std::string_view) override {}
  void update(double fraction) override { m_furthest = fraction; }
  bool cancelled() const override { return m_furthest >= kGridsMade && ++m_polls > 1; }
  double furthest() const { return m_furthest; }

  static constexpr double kGridsMade = 0.3, kWritten = 0.8;

 private:
  double m_furthest = 0;
  mutable int m_polls = 0;
};

TEST(FaultState, ACancelIsHeardWhileGridsAreWrittenAndLeavesTheOldFile) {
  const TemporaryFolder folder;
  write_state(folder / "a.vdb", random_state(30, 6));
  const std::string old = read_text(folder / "a.vdb");
  State large;
  large.geometry = Geometry({96, 96, 96}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  large.elements = bricks_where({96, 96, 96}, [](const Vec3i&) { return true; });
  std::mt19937 random(5);
  std::vector<float> densities(large.elements.brick_count() * kBrickVoxels);
  for (float& density : densities) density = float(random());
  large.density = make_density_grid(large.elements, densities, 0);
  StopInTheFile stop;
  EXPECT_THROW(write_state(folder / "a.vdb", large, &stop), Cancelled);
  EXPECT_GE(stop.furthest(), StopInTheFile::kGridsMade);
  EXPECT_LT(stop.furthest(), StopInTheFile::kWritten);
  EXPECT_EQ(read_text(folder / "a.vdb"), old);
  EXPECT_EQ(folder.entries().size(), 1u);
}

TEST(FaultState, AReadOnlyFolderIsASystemErrorAndAMissingOneAnInputError) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_state(folder / "none/a.vdb", random_state(1)), InputError);
  EXPECT_THROW(write_state(folder / "", random_state(1)), InputError);
  if (::geteuid() == 0) GTEST_SKIP() << "root may write into read-only folders";
  std::filesystem::permissions(
      folder / "", std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_THROW(write_state(folder / "a.vdb", random_state(1)), SystemError);
  std::filesystem::permissions(folder / "", std::filesystem::perms::owner_all);
}

TEST(FaultState, AnInvalidStateIsNotWritten) {
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  ASSERT_EQ(write_error([](State& state) { state.q = {}; }), "");
  EXPECT_TRUE(
      has(write_error([](State& state) { state.q[0].resize(state.elements.brick_count() + 1); }),
          "bricks, expected 0 or "));
  EXPECT_TRUE(has(write_error([](State& state) {
                    state.q[2].resize(state.elements.brick_count());
                    std::fill_n(state.q[2].touch(0), kBrickVoxels, kMaxOffset + 1);
                  }),
                  "q.z at "));
  EXPECT_TRUE(has(write_error([](State& state) {
                    state.geometry = state.geometry.with_dims({1, 1, 1});
                  }),
                  "expected voxels inside 0,0,0 to 0,0,0"));
  EXPECT_TRUE(has(write_error([](State& state) { state.density = DensityGrid(); }), "no density"));
  EXPECT_TRUE(has(write_error([](State& state) {
                    const BrickTopology bricks = state.density.bricks();
                    const float nan = std::numeric_limits<float>::quiet_NaN();
                    state.density = make_density_grid(
                        bricks, std::vector<float>(bricks.brick_count() * kBrickVoxels, nan), 0);
                  }),
                  "not finite"));
  EXPECT_TRUE(has(write_error([](State& state) { state.anchors.emplace_back(); }), "anchors"));
  const auto label = [](std::int32_t value, bool at_element) {
    return [=](State& state) {
      state.anchor_labels.clear();
      state.labels = BrickValues(state.elements.brick_count());
      int offset = 0;
      while (mask_test(state.elements.mask(0), offset) != at_element) ++offset;
      state.labels.touch(0)[offset] = value;
    };
  };
  EXPECT_EQ(write_error(label(65535, true)), "");
  EXPECT_TRUE(has(write_error(label(65536, true)), "found 65536, expected 0 to 65535"));
  EXPECT_TRUE(has(write_error(label(-1, true)), "found -1"));
  EXPECT_TRUE(has(write_error(label(1, false)), "expected 0 where there is no element"));
  EXPECT_TRUE(has(write_error([](State& state) {
                    state.anchor_labels.clear();
                    state.labels = BrickValues(state.elements.brick_count() + 1);
                  }),
                  "label: found "));
  EXPECT_TRUE(has(write_error([&](State& state) {
                    label(7, true)(state);
                    state.anchor_labels = {7, 8};
                  }),
                  "label 8 without elements"));
}

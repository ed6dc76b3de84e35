// Streaming and sparse loading against dense brute force that shares no code with it.
#include <cmath>
#include <deque>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "tests/support/program.h"
#include "tests/volumes/io/dense_file.h"
#include "volumes/base/error.h"
#include "volumes/base/sha256.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

namespace supple::test {
namespace {

TEST(UnitSha256, KnownVectors) {
  EXPECT_EQ(sha256_hex("", 0), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc", 3),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  Sha256 hash;
  for (int n = 0; n < 1000000; ++n) hash.update("a", 1);
  EXPECT_EQ(hash.hex(), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_EQ(hash.hex(), sha256_hex("", 0));
}

TEST(UnitDigest, CountsLeaveNanAndInfinityOut) {
  const float inf = std::numeric_limits<float>::infinity();
  DenseFile file({4, 2, 1}, {1, 2, kNaN, 1, inf, -inf, 4, 8});
  const VolumeDigest digest = digest_volume(file);
  EXPECT_EQ(digest.statistics.min, 1);
  EXPECT_EQ(digest.statistics.max, 8);
  EXPECT_DOUBLE_EQ(digest.statistics.mean, 16.0 / 5);
  EXPECT_EQ(digest.statistics.nan_count, 1);
  EXPECT_EQ(digest.statistics.infinite_count, 2);
  EXPECT_EQ(digest.statistics.above_min_count, 3);
  EXPECT_EQ(void_values_text(digest.statistics), "1 NaN voxel and 2 infinite voxels");
}

TEST(UnitDigest, AllNanIsEmptyNotAnError) {
  DenseFile file({3, 1, 1}, {kNaN, kNaN, kNaN});
  const VolumeDigest digest = digest_volume(file);
  EXPECT_EQ(digest.statistics.nan_count, 3);
  EXPECT_EQ(digest.statistics.above_min_count, 0);
  file.rewind();
  EXPECT_EQ(load_volume(file).density.bricks().active_count(), 0);
}

TEST(PropertyDigest, StatisticsEqualADenseScan) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    DenseFile file = random_file(seed, 24);
    double min = 1e30, max = -1e30, sum = 0;
    std::int64_t finite = 0, nan = 0, above = 0;
    file.for_each([&](const Vec3i& p) {
      const double v = double(file.value(p));
      if (std::isnan(v)) {
        ++nan;
        return;
      }
      min = std::min(min, v), max = std::max(max, v), sum += v, ++finite;
    });
    file.for_each([&](const Vec3i& p) { above += double(file.value(p)) > min; });
    const VolumeStatistics statistics = digest_volume(file).statistics;
    EXPECT_EQ(statistics.min, min);
    EXPECT_EQ(statistics.max, max);
    EXPECT_NEAR(statistics.mean, sum / double(finite), 1e-9);
    EXPECT_EQ(statistics.nan_count, nan);
    EXPECT_EQ(statistics.above_min_count, above);
  }
}

TEST(PropertyDigest, SparseBytesAreThoseOfTheLoadedGrid) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    DenseFile file = random_file(seed, 60);
    const VolumeDigest digest = digest_volume(file);
    file.rewind();
    EXPECT_EQ(digest.sparse_bytes, std::int64_t(load_volume(file).density.bytes())) << seed;
  }
  // Several nodes of the tree on every level.
  std::vector<float> values(std::size_t(5000) * 2 * 9, 0.0f);
  for (std::size_t n = 0; n < values.size(); n += 1777) values[n] = 1;
  DenseFile file({5000, 2, 9}, values);
  const VolumeDigest digest = digest_volume(file);
  file.rewind();
  EXPECT_EQ(digest.sparse_bytes, std::int64_t(load_volume(file).density.bytes()));
}

TEST(PropertyLoad, LoadedVolumeHoldsEveryVoxelAboveTheMinimum) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    DenseFile file = random_file(seed, 30);
    const Volume volume = load_volume(file);
    const float min = float(volume.statistics.min);
    std::int64_t active = 0;
    file.for_each([&](const Vec3i& p) {
      const bool expected = file.value(p) > min;
      active += expected;
      ASSERT_EQ(volume.density.bricks().is_active(p), expected) << p << " seed " << seed;
      ASSERT_EQ(volume.density.at(p), expected ? file.value(p) : min) << p << " seed " << seed;
    });
    EXPECT_EQ(volume.density.bricks().active_count(), active) << "voxels outside the box";
  }
}

/// The `count` largest face-connected pieces of the voxels within [lo, hi], by flooding.
std::vector<char> brute_elements(const DenseFile& file, double lo, double hi, int count) {
  std::vector<std::vector<Vec3i>> pieces;
  const Vec3i& dims = file.header().geometry.dims();
  const std::size_t total = std::size_t(dims.x) * dims.y * dims.z;
  std::vector<char> seen(total, 0);
  const auto is_element = [&](const Vec3i& p) {
    return double(file.value(p)) >= lo && double(file.value(p)) <= hi;
  };
  file.for_each([&](const Vec3i& seed) {
    if (!is_element(seed) || seen[file.index(seed)]) return;
    std::vector<Vec3i> piece;
    std::deque<Vec3i> queue = {seed};
    seen[file.index(seed)] = 1;
    while (!queue.empty()) {
      const Vec3i p = queue.front();
      queue.pop_front();
      piece.push_back(p);
      for (int face = 0; face < 6; ++face) {
        Vec3i q = p;
        q[face / 2] += face % 2 ? 1 : -1;
        if (!file.inside(q) || !is_element(q) || seen[file.index(q)]) continue;
        seen[file.index(q)] = 1;
        queue.push_back(q);
      }
    }
    pieces.push_back(piece);
  });
  std::vector<char> mask(total, 0);
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (std::size_t n = 0; n < pieces.size() && (count == 0 || n < std::size_t(count)); ++n) {
    for (const Vec3i& p : pieces[n]) mask[file.index(p)] = 1;
  }
  return mask;
}

TEST(PropertyLoad, ExtremesOfBricksAreThoseOfTheirActiveVoxels) {
  const auto expect_known = [](const DensityGrid& density, unsigned seed) {
    ASSERT_NE(density.extremes(), nullptr);
    for (std::size_t b = 0; b < density.bricks().brick_count(); ++b) {
      const BrickExtremes expected = find_extremes(density.values(b), density.bricks().mask(b));
      EXPECT_EQ(density.extremes()[b].lo, expected.lo) << seed;
      EXPECT_EQ(density.extremes()[b].hi, expected.hi) << seed;
      EXPECT_EQ(density.extremes()[b].integers, expected.integers) << seed;
    }
  };
  for (unsigned seed = 0; seed < 20; ++seed) {
    DenseFile file = random_file(seed, 30);
    expect_known(load_volume(file).density, seed);
    file.rewind();
    const auto elements = brute_elements(file, 20, 80, 1);
    if (std::count(elements.begin(), elements.end(), char(1)) == 0) continue;
    expect_known(load_elements(file, 20, 80, 1, int(seed % 3)).volume.density, seed);
  }
}

/// True when the `count`-th and the next largest piece are of one size: either may be kept.
bool is_tied(const DenseFile& file, double lo, double hi, int count) {
  const auto size_of = [&](int n) {
    const auto mask = brute_elements(file, lo, hi, n);
    return std::count(mask.begin(), mask.end(), char(1));
  };
  if (count == 0) return false;
  const auto last = size_of(count) - (count > 1 ? size_of(count - 1) : 0);
  return last > 0 && size_of(count + 1) - size_of(count) == last;
}

TEST(PropertyLoad, ElementsAndShellEqualADenseBruteForce) {
  int compared = 0;
  for (unsigned seed = 0; seed < 120; ++seed) {
    DenseFile file = random_file(seed, 26);
    const int components = int(seed % 3), rings = int(seed / 3 % 4);
    const double lo = 20, hi = 80;
    const auto expected = brute_elements(file, lo, hi, components);
    if (std::count(expected.begin(), expected.end(), char(1)) == 0) {
      EXPECT_THROW(load_elements(file, lo, hi, components, rings), InputError);
      continue;
    }
    if (is_tied(file, lo, hi, components)) continue;
    ++compared;
    std::vector<CountedRange> counted = {{lo, hi}, {-1e9, 1e9}};
    const ElementVolume loaded = load_elements(file, lo, hi, components, rings, nullptr, &counted);
    const DensityGrid& density = loaded.volume.density;
    std::int64_t active = 0, elements = 0, in_range = 0, finite = 0;
    file.for_each([&](const Vec3i& p) {
      in_range += file.value(p) >= lo && file.value(p) <= hi;
      finite += !std::isnan(file.value(p));
      bool kept = false;
      for (int dz = -rings; dz <= rings; ++dz) {
        for (int dy = -rings; dy <= rings; ++dy) {
          for (int dx = -rings; dx <= rings; ++dx) {
            const Vec3i q = p + Vec3i(dx, dy, dz);
            kept = kept || (file.inside(q) && expected[file.index(q)]);
          }
        }
      }
      kept = kept && !std::isnan(file.value(p));
      active += kept;
      elements += expected[file.index(p)];
      ASSERT_EQ(loaded.elements.is_active(p), bool(expected[file.index(p)])) << p << " " << seed;
      ASSERT_EQ(density.bricks().is_active(p), kept) << p << " seed " << seed;
      if (kept) {
        ASSERT_EQ(density.at(p), file.value(p)) << p << " seed " << seed;
      }
    });
    EXPECT_EQ(density.bricks().active_count(), active) << "voxels outside the box";
    EXPECT_EQ(loaded.elements.active_count(), elements);
    EXPECT_EQ(counted[0].voxels, in_range);
    EXPECT_EQ(counted[1].voxels, finite);
    EXPECT_EQ(density.background(), float(loaded.volume.statistics.min));
  }
  EXPECT_GT(compared, 60);
}

TEST(PropertyLoad, FilesOfEveryFormatDigestAlike) {
  std::mt19937 random(7);
  for (int round = 0; round < 10; ++round) {
    const TemporaryFolder folder;
    std::vector<std::int16_t> values(9 * 10 * 11);
    for (auto& value : values) value = std::int16_t(random());
    const std::string data = bytes_of_values(values), big = bytes_of_values(values, true);
    const std::string hash = sha256_hex(data.data(), data.size());
    folder.write("a.raw", big);
    folder.write("a.nrrd",
                 "NRRD0004\ntype: int16\ndimension: 3\nsizes: 9 10 11\nendian: big\n"
                 "encoding: gzip\n\n" +
                     gzip(big));
    folder.write("a.mha",
                 "NDims = 3\nDimSize = 9 10 11\nElementType = MET_SHORT\n"
                 "ElementDataFile = LOCAL\n" +
                     data);
    folder.write("a.nii.gz", gzip(nifti_header({9, 10, 11}) + data));
    EXPECT_EQ(digest_volume(*open_volume(folder / "a.raw",
                                         {"dims=9,10,11,type=int16,spacing=1,1,1,endian=big"}))
                  .sha256,
              hash);
    for (const char* name : {"a.nrrd", "a.mha", "a.nii.gz"}) {
      EXPECT_EQ(digest_volume(*open_volume(folder / name)).sha256, hash) << name;
    }
  }
}

TEST(UnitRealData, HeadCtLoadsSparse) {
  const std::string path = public_volume("ct_head.nhdr");
  if (path.empty()) GTEST_SKIP() << "no head CT (tools/fetch_ct_head.sh)";
  const VolumeDigest digest = digest_volume(*open_volume(path));
  if (digest.sha256 != kHeadCtSha256)
    GTEST_SKIP() << path << " holds the phantom that stands in offline";
  EXPECT_EQ(digest.statistics.min, -1024);
  EXPECT_EQ(digest.statistics.max, 2986);
  EXPECT_EQ(digest.statistics.above_min_count, 6746434);
  const ElementVolume head = load_elements(path, {}, 300, 4000, 1);
  EXPECT_TRUE(head.elements.is_active({128, 211, 12}));
  EXPECT_LT(head.volume.density.bytes(), 12000000u);
}

}  // namespace
}  // namespace supple::test

// Guarantees of loading beyond the densities: the bits of the grid, and slabs read ahead.
#include <atomic>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "tests/volumes/io/dense_file.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/grid/density_grid_vdb.h"
#include "volumes/io/load/brick_sample.h"
#include "volumes/io/load/brick_store.h"
#include "volumes/io/load/load.h"

namespace supple::test {
namespace {

std::uint32_t bits_of(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// The densities of `file` where they are above `background` and the background elsewhere, in
/// leaves of active voxels alone, which the bricks mirror.
void expect_bits(const DensityGrid& density, const DenseFile& file, float background) {
  const openvdb::FloatTree& tree = density.vdb().grid->tree();
  EXPECT_EQ(bits_of(tree.background()), bits_of(background));
  EXPECT_EQ(tree.activeTileCount(), 0u);
  EXPECT_EQ(tree.leafCount(), density.bricks().brick_count());
  EXPECT_EQ(tree.activeVoxelCount(), std::uint64_t(density.bricks().active_count()));
  std::size_t above = 0;
  file.for_each([&](const Vec3i& p) { above += file.value(p) > background; });
  EXPECT_EQ(tree.activeVoxelCount(), above);
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    ASSERT_FALSE(leaf->isEmpty());
    const auto origin = leaf->origin();
    const std::int32_t b = density.bricks().find({origin.x(), origin.y(), origin.z()});
    ASSERT_GE(b, 0);
    ASSERT_EQ(density.values(b), leaf->buffer().data());
    for (int n = 0; n < kBrickVoxels; ++n) {
      const Vec3i p = density.bricks().origin(b) + brick_local(n);
      const bool active = file.inside(p) && file.value(p) > background;
      ASSERT_EQ(leaf->isValueOn(openvdb::Index(n)), active) << p;
      ASSERT_EQ(mask_test(density.bricks().mask(b), n), active) << p;
      ASSERT_EQ(bits_of(density.values(b)[n]), bits_of(active ? file.value(p) : background)) << p;
    }
  }
}

TEST(PropertyLoad, InactiveVoxelsHoldTheBackgroundAndEveryLeafAnActiveOne) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    DenseFile file = random_file(seed, 30);
    const Volume volume = load_volume(file);
    expect_bits(volume.density, file, float(volume.statistics.min));
  }
}

/// Slabs of one density each, with the bricks in the corner cut by the volume's end.
DenseFile layered_file(const std::vector<float>& layers) {
  const Vec3i dims(19, 10, 8 * int(layers.size()) - 3);
  std::vector<float> values;
  for (int k = 0; k < dims.z; ++k) {
    values.insert(values.end(), std::size_t(dims.x) * dims.y, layers[k / 8]);
  }
  return DenseFile(dims, std::move(values));
}

TEST(UnitLoad, BricksOfTheLowestDensitySoFarAreActiveOnceALowerOneComes) {
  for (const std::vector<float>& layers : std::vector<std::vector<float>>{
           {5, 5, 3, 3, 4, 3, 1, 2}, {1, 1, 1, 0.5f}, {kNaN, 7, 7, kNaN, 7, 6}, {9}}) {
    DenseFile file = layered_file(layers);
    const Volume volume = load_volume(file);
    expect_bits(volume.density, file, float(volume.statistics.min));
  }
}

TEST(UnitLoad, AirIsToldApartDownToTheSignOfAZero) {
  const SlabBrick brick = constant_brick({8, 8, 0}, {19, 10, 5}, 0.0f);
  EXPECT_EQ(brick.extent, Vec3i(8, 2, 5));
  EXPECT_TRUE(brick.is_all(0.0f));
  EXPECT_FALSE(brick.is_all(-0.0f));
  EXPECT_EQ(mask_count(brick.above(-1)), 80);
}

TEST(UnitLoad, BricksWithoutAFiniteVoxelTakeNoMemory) {
  Slab slab;
  slab.dims = {19, 8, 3};
  slab.depth = 3;
  slab.values.assign(std::size_t(19) * 8 * 3, kNaN);
  slab.values.back() = 1;
  const std::vector<SlabBrick> bricks = bricks_of(slab);
  ASSERT_EQ(bricks.size(), 3u);
  EXPECT_TRUE(bricks[0].is_void() && bricks[1].is_void() && !bricks[2].is_void());
  EXPECT_FALSE(bool(bricks[0].leaf) || bool(bricks[1].leaf));
  EXPECT_EQ(mask_count(bricks[2].above(0)), 1);
}

TEST(UnitLoad, BoundsOfElementsAreComparedAsDoubles) {
  // A float has a double on either side that is no float.
  const float density = 0.1f;
  const double below = std::nextafter(double(density), 0),
               above = std::nextafter(double(density), 1);
  const SlabBrick brick = constant_brick({0, 0, 0}, {1, 1, 1}, density);
  const auto count = [&](double lo, double hi) { return mask_count(brick.within(lo, hi)); };
  EXPECT_EQ(count(below, above), 1);
  EXPECT_EQ(count(density, density), 1);
  EXPECT_EQ(count(above, 1), 0);
  EXPECT_EQ(count(0, below), 0);
  EXPECT_EQ(count(-1e300, 1e300), 1);
  EXPECT_EQ(count(1e300, 1e301), 0);
}

TEST(PropertyLoad, ASampleOfAllSlabsCountsTheElementsThatAreLoaded) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    DenseFile file = random_file(seed, 40);
    const std::pair<double, double> range(0.1, 90.1);
    BrickSample sample = sample_bricks(file, range, 100, [](const BrickSample&) { return false; });
    EXPECT_EQ(sample.slabs_read, sample.slabs);
    if (sample.elements == 0) continue;
    file.rewind();
    const ElementVolume loaded = load_elements(file, range.first, range.second, 0, 0);
    EXPECT_EQ(sample.elements, loaded.elements.active_count()) << seed;
    EXPECT_EQ(sample.bricks, std::int64_t(loaded.elements.brick_count())) << seed;
    file.rewind();
    sample = sample_bricks(file, std::nullopt, 100, [](const BrickSample&) { return false; });
    file.rewind();
    EXPECT_LE(sample.elements, load_volume(file).density.bricks().active_count()) << seed;
  }
}

TEST(UnitLoad, ASampleReadsSomeSlabsAndEndsWhereItIsEnough) {
  constexpr int kSlabs = 20;
  const Vec3i dims(9, 8, kSlabs * 8);
  DenseFile file(dims, std::vector<float>(std::size_t(9) * 8 * 8 * kSlabs, 1));
  const std::pair<double, double> all(0, 2);
  BrickSample sample = sample_bricks(file, all, 5, [](const BrickSample&) { return false; });
  EXPECT_EQ(sample.slabs_read, 5);
  EXPECT_EQ(sample.slabs, kSlabs);
  EXPECT_EQ(sample.bricks, 10);
  EXPECT_EQ(sample.elements, 5 * 9 * 8 * 8);
  EXPECT_EQ(sample.part(), 0.25);
  file.rewind();
  sample = sample_bricks(file, all, 5, [](const BrickSample& found) { return found.bricks > 3; });
  EXPECT_EQ(sample.slabs_read, 2);
}

TEST(PropertyLoad, ThreadsDoNotMatter) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    DenseFile file = random_file(seed, 60);
    const Volume many = on_threads(4, [&] { return load_volume(file); });
    file.rewind();
    const Volume single = on_threads(1, [&] { return load_volume(file); });
    ASSERT_EQ(many.density.bricks(), single.density.bricks());
    for (std::size_t b = 0; b < single.density.bricks().brick_count(); ++b) {
      const std::size_t bytes = kBrickVoxels * sizeof(float);
      ASSERT_EQ(std::memcmp(many.density.values(b), single.density.values(b), bytes), 0);
    }
    EXPECT_EQ(std::memcmp(&many.statistics, &single.statistics, sizeof many.statistics), 0);
  }
}

/// Slices of zeros, the last of which cannot be read.
class FailingFile : public VolumeFile {
 public:
  explicit FailingFile(int depth) {
    m_header.path = "failing";
    m_header.geometry = Geometry().with_dims({3, 3, depth});
  }
  ~FailingFile() override { EXPECT_FALSE(m_reading) << "destroyed while it is read"; }
  void read_slice(void* out) override {
    m_reading = true;
    ++m_reads;
    std::memset(out, 0, 9);
    const bool fails = m_reads == m_header.geometry.dims().z;
    m_reading = false;
    if (fails) throw InputError({"failing", "data", "the end", "another slice"});
  }
  int reads() const { return m_reads; }

 private:
  std::atomic<bool> m_reading{false};
  std::atomic<int> m_reads{0};
};

/// Notes the fractions, and asks to stop from one on.
class Fractions : public Progress {
 public:
  explicit Fractions(double stop = 2) : m_stop(stop) {}
  void stage(std::string_view) override {}
  void update(double fraction) override { m_last = fraction; }
  bool cancelled() const override { return m_last >= m_stop; }
  double last() const { return m_last; }

 private:
  double m_stop;
  double m_last = -1;
};

TEST(FaultLoad, AFailureOfASliceSurfacesWhenItsSlabIsDue) {
  for (const int depth : {1, 8, 9, 40}) {
    FailingFile file(depth);
    Fractions progress;
    EXPECT_THROW(load_volume(file, &progress), InputError) << depth;
    EXPECT_EQ(progress.last(), (depth - 1) / 8 * 8 / double(depth)) << depth;
    EXPECT_EQ(file.reads(), depth);
  }
}

TEST(FaultLoad, CancellingWaitsForTheSlabThatIsBeingReadAhead) {
  FailingFile file(80);
  Fractions progress(0.2);
  EXPECT_THROW(load_volume(file, &progress), Cancelled);
  EXPECT_EQ(file.reads(), 32) << "slabs at 0, 0.1 and 0.2, and the one behind them";
}

}  // namespace
}  // namespace supple::test

// States that refer to a volume, at the level of files: random bodies that move, lose elements and
// change densities in some of their bricks.
#include <cstring>
#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include "lib/state/own_bricks.h"
#include "tests/support/errors.h"
#include "tests/support/random_state.h"
#include "tests/support/sanitized.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/volume_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr double kLo = 100, kHi = 900;

/// A volume of random densities, some voxels of it void, and its body at rest.
State write_body(const std::string& path, unsigned seed) {
  std::mt19937 random(seed);
  const auto dim = [&] { return 9 + int(random() % 60); };
  const Vec3i dims(dim(), dim(), dim());
  std::vector<float> values(std::size_t(dims.x) * dims.y * dims.z);
  const auto tissue_part = random() % 101;
  for (float& value : values) {
    value = random() % 100 < tissue_part ? float(random() % 1000) : float(random() % 7);
    if (random() % 50 == 0) value = std::numeric_limits<float>::quiet_NaN();
  }
  values[random() % values.size()] = 500;
  State state;
  state.geometry = random_geometry(random, dims);
  const std::size_t slice = std::size_t(dims.x) * dims.y;
  write_volume(path, state.geometry, ValueType::float32,
               [&](int k, float* out) { std::copy_n(&values[slice * k], slice, out); });
  const auto file = open_volume(path);
  ElementVolume loaded = load_elements(*file, kLo, kHi, 0);
  state.geometry = file->header().geometry;
  state.density = loaded.volume.density;
  state.elements = loaded.elements;
  state.source = make_source(file->header(), {}, kLo, kHi, 0, state.density, state.elements);
  state.material_toml = "domain = [0, 255]\n";
  state.configuration = "{}";
  state.source_name = "v.nrrd";
  state.source_type = "float32";
  return state;
}

void move_some(State& state, std::mt19937& random) {
  for (BrickValues& q : state.q) {
    q.resize(state.elements.brick_count());
    for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
      if (random() % 8 != 0) continue;
      for_each_active(state.elements.mask(b),
                      [&](int offset) { q.touch(b)[offset] = std::int32_t(random() % 9) - 4; });
    }
    if (q.empty()) q.clear();
  }
}

/// Takes elements out of some bricks, all of them of a few, and alters densities of others.
void alter_some(State& state, std::mt19937& random) {
  const auto part = random() % 4;
  state.elements = bricks_where(state.geometry.dims(), [&](const Vec3i& voxel) {
    const bool is_lost = std::size_t(voxel.x / 8 + voxel.y / 8) % 4 == part && random() % 3 != 0;
    return state.elements.is_active(voxel) && !is_lost;
  });
  const BrickTopology kept = bricks_where(state.geometry.dims(), [&](const Vec3i& voxel) {
    return state.density.bricks().is_active(voxel) &&
           (state.elements.is_active(voxel) || voxel.z / 8 % 2 == 0);
  });
  std::vector<float> values(kept.brick_count() * kBrickVoxels);
  for (std::size_t b = 0; b < kept.brick_count(); ++b) {
    const bool is_altered = random() % 5 == 0;
    for (int n = 0; n < kBrickVoxels; ++n) {
      values[b * kBrickVoxels + n] =
          state.density.at(kept.origin(b) + brick_local(n)) + float(is_altered);
    }
  }
  state.density = make_density_grid(kept, values, state.density.background());
}

}  // namespace

TEST(PropertyStateSource, AStateThatRefersReadsBackBitForBit) {
  const TemporaryFolder folder;
  std::int64_t parts = 0;
  for (int seed = 0; seed < cases(30); ++seed) {
    State state = write_body(folder / "v.nrrd", unsigned(seed));
    std::mt19937 random(unsigned(seed) + 1000);
    if (seed % 3 != 0) move_some(state, random);
    if (seed % 2 != 0) {
      state.q = {};
      alter_some(state, random);
      if (seed % 5 != 0) move_some(state, random);
      state.cuts = random_cuts(random, state.elements);
    }
    state.labels = random_labels(unsigned(seed), state.elements);
    on_threads(1, [&] { write_state(folder / "a.vdb", state); });
    const State read = on_threads(4, [&] { return read_state(folder / "a.vdb"); });
    ASSERT_TRUE(same_state(read, state)) << "seed " << seed;
    ASSERT_EQ(read.source->sha256, state.source->sha256);
    write_state(folder / "b.vdb", read);
    ASSERT_EQ(read_text(folder / "a.vdb"), read_text(folder / "b.vdb")) << "seed " << seed;

    std::filesystem::rename(folder / "v.nrrd", folder / "w.nrrd");
    const State part = read_reachable_state(folder / "a.vdb");
    ASSERT_TRUE(part.source && part.source->elements.empty());
    parts += part.elements.active_count() < state.elements.active_count();
    for (int c = 0; c < 3; ++c) {
      for (std::size_t b = 0; b < state.q[c].brick_count(); ++b) {
        if (state.q[c].brick(b) == nullptr) continue;
        const std::int32_t own = part.elements.find(state.elements.origin(b));
        ASSERT_GE(own, 0);
        ASSERT_TRUE(std::equal(state.q[c].brick(b), state.q[c].brick(b) + kBrickVoxels,
                               part.q[c].brick_or_zero(std::size_t(own))));
      }
    }
    std::filesystem::rename(folder / "w.nrrd", folder / "v.nrrd");
  }
  EXPECT_GE(parts, cases(4));
}

TEST(PropertyStateSource, OneDensityMoreIsAnotherSource) {
  const TemporaryFolder folder;
  const State state = write_body(folder / "v.nrrd", 3);
  write_state(folder / "a.vdb", state);
  const std::string good = read_text(folder / "v.nrrd");
  const auto file = open_volume(folder / "v.nrrd");
  const std::size_t data = good.size() - std::size_t(stored_bytes(file->header()));
  const Vec3i& dims = state.geometry.dims();
  const BrickTopology& elements = state.elements;
  const int bit = __builtin_ctzll(elements.mask(0)[0] | std::uint64_t(1) << 63);
  const Vec3i voxel = elements.origin(0) + brick_local(bit);
  ASSERT_TRUE(elements.is_active(voxel));
  const std::size_t number = (std::size_t(voxel.z) * dims.y + voxel.y) * dims.x + voxel.x;
  std::string altered = good;
  const float density = 101.5F;
  std::memcpy(&altered[data + number * sizeof density], &density, sizeof density);
  write_text(folder / "v.nrrd", altered);
  const std::string line = input_error([&] { read_state(folder / "a.vdb"); });
  EXPECT_NE(line.find("a.vdb: source " + (folder / "v.nrrd") + ": found densities with SHA-256 "),
            std::string::npos)
      << line;
  EXPECT_NE(line.find("expected SHA-256 " + state.source->sha256.substr(0, 16)), std::string::npos)
      << line;
}

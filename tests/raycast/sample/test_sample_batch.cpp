// Sixteen samples at once against one at a time, for every instruction set of this machine.
#include <random>

#include <gtest/gtest.h>

#include "raycast/march/render_context.h"
#include "tests/raycast/scenes.h"
#include "tests/support/scalar_sampling.h"
#include "volumes/field/procedural.h"

namespace supple {
namespace {

/// One sample by the definition.
struct ExpectedSample {
  bool read = false, inside = false, bent = false;
  float encoded = 0;
  Vec3f gradient{0, 0, 0};
};

Vec3i voxel_below(const Vec3d& p) {
  return {int(std::floor(p.x)), int(std::floor(p.y)), int(std::floor(p.z))};
}

ExpectedSample expected_at(const SourceBricks& source, const OffsetBricks& output, Vec3d p) {
  ExpectedSample result;
  Vec3i voxel = voxel_below(p);
  const std::int32_t out = output.find(voxel);
  if (out < 0) return result;
  if (!output.is_identity(out)) {
    if (!output.is_deformed(out)) return result;
    const Vec3f within(p - Vec3d(voxel));
    const Vec3f offset = sample_offset(
        {output.node(out, voxel - output.index().origin(out)), within.x, within.y, within.z});
    if (!(offset.x == offset.x)) return result;
    p += Vec3d(offset);
    voxel = voxel_below(p);
    result.bent = true;
  }
  const std::int32_t in = source.topology().find(voxel);
  if (in < 0 || source.range(in).empty()) return result;
  result.read = true;
  const Vec3f within(p - Vec3d(voxel));
  const SourceCell cell = {source.node(in, voxel - source.topology().origin(in)), within.x,
                           within.y, within.z};
  result.inside = sample_cell(cell, result.encoded);
  if (result.inside) result.gradient = sample_gradient(cell, result.encoded);
  return result;
}

/// A rough volume with holes, two bricks apart from the rest, and offsets on a part of it.
struct RoughScene {
  Geometry geometry = cube_geometry(40);
  BrickTopology where = voxels_of({40, 40, 40}, [](const Vec3i& v) {
    return (v.x * 7 + v.y * 13 + v.z * 29) % 37 != 0 && !(v.x >> 3 == 2 && v.y >> 3 == 2);
  });
  SourceBricks source{grid_of(where, [](const Vec3d& p) {
    return std::floor((300 + 10 * p.x) * std::sin(p.x * 0.9) * std::cos(p.y * 0.7 + p.z * 0.4));
  })};
  OffsetField offsets =
      sample_offsets(bump_warp({20, 20, 20}, 15, 5), geometry, voxels_of({40, 40, 24}, everywhere));
  OffsetBricks output{source, offsets.o};
  RenderContext context = frame_with(fog_function(0.1));

  RenderContext frame_with(const TransferFunction& function) const {
    return {geometry, source, output, default_camera(geometry, 1), function, RenderSettings()};
  }
};

RayPiece random_piece(std::mt19937& random) {
  std::uniform_real_distribution<float> place(2, 38), direction(-1, 1);
  RayPiece piece;
  piece.base = Vec3i(int(place(random)), int(place(random)), int(place(random)));
  piece.first = Vec3f(direction(random), direction(random), direction(random));
  piece.per_sample = Vec3f(direction(random), direction(random), direction(random));
  return piece;
}

void compare_with_scalar(const RoughScene& scene, const SamplingTables& tables, int& bent,
                         int& one_sided) {
  std::mt19937 random(3);
  SampleBatch batch;
  for (int round = 0; round < 300; ++round) {
    const RayPiece piece = random_piece(random);
    const int first = int(random() % 8), stride = 1 + int(random() % 4);
    const int count = 1 + int(random() % SampleBatch::kLanes);
    sample_batch(tables, piece, first, stride, count, batch);
    sample_gradients(tables, batch, batch.visible);
    EXPECT_EQ(batch.read >> count, 0u);
    for (int lane = 0; lane < count; ++lane) {
      const Vec3d p = Vec3d(piece.base) + Vec3d(piece.first) +
                      Vec3d(piece.per_sample) * double(first + lane * stride);
      const ExpectedSample want = expected_at(scene.source, scene.output, p);
      ASSERT_EQ(batch.read >> lane & 1, want.read);
      ASSERT_EQ(batch.inside >> lane & 1, want.inside);
      ASSERT_EQ(batch.bent >> lane & 1, want.bent && want.read);
      if (!want.inside) continue;
      bent += want.bent;
      one_sided += want.gradient.x == 0;
      EXPECT_NEAR(batch.encoded[lane], want.encoded, 0.05);
      ASSERT_EQ(batch.visible >> lane & 1, 1u);
      EXPECT_NEAR(batch.gx[lane], want.gradient.x, 0.1);
      EXPECT_NEAR(batch.gy[lane], want.gradient.y, 0.1);
      EXPECT_NEAR(batch.gz[lane], want.gradient.z, 0.1);
    }
  }
}

TEST(PropertySampleBatch, EveryInstructionSetReadsWhatOneSampleAtATimeReads) {
  const RoughScene scene;
  for (const std::string& name : sampling_instruction_sets()) {
    choose_sampling_instruction_set(name);
    ASSERT_EQ(sampling_instruction_set(), name);
    SCOPED_TRACE(name);
    int bent = 0, one_sided = 0;
    compare_with_scalar(scene, scene.context.tables, bent, one_sided);
    EXPECT_GT(bent, 200);
  }
  choose_sampling_instruction_set("");
}

TEST(PropertySampleBatch, BricksFarApartAreReadOneAfterAnother) {
  const RoughScene scene;
  SamplingTables tables = scene.context.tables;
  for (const std::int32_t span : {1, 3}) {
    tables.gather_span = span;
    int bent = 0, one_sided = 0;
    compare_with_scalar(scene, tables, bent, one_sided);
  }
}

TEST(PropertySampleBatch, VisibleSamplesAreThoseThatTheFunctionShows) {
  const RoughScene scene;
  TransferFunction one_range = fog_function(0.1), two_ranges = fog_function(0.1);
  one_range.opacity = {{-400, 0}, {-100, 0}, {-99, 0.5}, {200, 0.5}, {201, 0}, {400, 0}};
  two_ranges.opacity = {{-400, 0.5}, {-100, 0.5}, {-99, 0}, {200, 0}, {201, 0.5}, {400, 0.5}};
  for (const TransferFunction& function : {one_range, two_ranges}) {
    const RenderContext context = scene.frame_with(function);
    std::mt19937 random(3);
    SampleBatch batch;
    int shown = 0, hidden = 0;
    for (int round = 0; round < 300; ++round) {
      sample_batch(context.tables, random_piece(random), 0, 1, SampleBatch::kLanes, batch);
      for (std::uint32_t rest = batch.inside; rest != 0; rest &= rest - 1) {
        const int lane = __builtin_ctz(rest);
        const double density = context.source.density(batch.encoded[lane]);
        if (function.opacity_at(density - 1) != function.opacity_at(density + 1)) continue;
        const bool visible = function.opacity_at(density) > 0;
        ASSERT_EQ(batch.visible >> lane & 1, std::uint32_t(visible)) << density;
        (visible ? shown : hidden) += 1;
      }
    }
    EXPECT_GT(shown, 200);
    EXPECT_GT(hidden, 200);
  }
}

TEST(PropertySampleBatch, SamplesOnBothSidesOfARegionsBorderFindTheirBricks) {
  const Vec3i dims{144, 16, 16};
  const SourceBricks source{
      grid_of(voxels_of(dims, everywhere), [](const Vec3d& p) { return 10 * p.x + p.y; })};
  const Geometry geometry(dims, Vec3d(0), {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const OffsetBricks output(source);
  const RenderContext context(geometry, source, output, default_camera(geometry, 1),
                              fog_function(0.1), RenderSettings());
  RayPiece piece;
  piece.base = {120, 4, 4};
  piece.per_sample = {1, 0.25f, 0};
  SampleBatch batch;
  sample_batch(context.tables, piece, 0, 1, SampleBatch::kLanes, batch);
  ASSERT_EQ(batch.inside, 0xFFFFu);
  for (int lane = 0; lane < SampleBatch::kLanes; ++lane) {
    EXPECT_NEAR(context.source.density(batch.encoded[lane]), 1204 + 10.25 * lane, 0.05);
  }
}

TEST(PropertySampleBatch, BricksThatHoldNothingLargerAreLeftOutOfAMaximum) {
  const RoughScene scene;
  TransferFunction maximum = fog_function(0.1);
  maximum.blend = Blend::maximum;
  const RenderContext context = scene.frame_with(maximum);
  std::mt19937 random(5);
  SampleBatch all, some;
  int skipped = 0;
  for (int round = 0; round < 300; ++round) {
    RayPiece piece = random_piece(random);
    sample_batch(context.tables, piece, 0, 1, SampleBatch::kLanes, all);
    piece.above = 500;
    sample_batch(context.tables, piece, 0, 1, SampleBatch::kLanes, some);
    EXPECT_EQ(some.inside & ~all.inside, 0u);
    for (std::uint32_t rest = all.inside & ~some.inside; rest != 0; rest &= rest - 1) {
      EXPECT_LE(all.encoded[__builtin_ctz(rest)], 500);
      ++skipped;
    }
  }
  EXPECT_GT(skipped, 10);
}

}  // namespace
}  // namespace supple

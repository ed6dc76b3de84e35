// Pictures of a body that is being dragged: offsets that are updated, and offsets without inverse.
#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "tests/raycast/scenes.h"
#include "volumes/base/error.h"
#include "volumes/field/displacement.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/procedural.h"
#include "volumes/field/split_offsets.h"

namespace supple {
namespace {

const Vec3d kMiddle(47.5, 47.5, 47.5);

struct LiveScene {
  LiveScene()
      : geometry(cube_geometry(96)),
        elements(voxels_of(geometry.dims(), [&](const Vec3i& v) { return body(Vec3d(v)) > 100; })),
        shell(dilate(elements, 2)),
        density(grid_of(shell, body)),
        camera(default_camera(geometry, 1)) {}

  Displacement displaced(const AnalyticWarp& warp) const {
    return extend(sample_displacement(warp, geometry, elements), shell);
  }
  Image draw(const Renderer& renderer) const {
    return renderer.render(camera, surface_function(), small_picture(120, 1.0 / 3));
  }

  Geometry geometry;
  DensityFunction body = lobed_body(kMiddle, 20);
  BrickTopology elements, shell;
  DensityGrid density;
  Camera camera;
};

TEST(PropertyLiveOffsets, UpdatedBricksGiveThePictureOfAllOffsetsSetAnew) {
  const LiveScene scene;
  Renderer live(scene.geometry, scene.density), anew(scene.geometry, scene.density);
  Displacement u = scene.displaced(shear_warp(kMiddle, 0));
  IncrementalInversion inversion(u);
  const OffsetField at_rest = inversion.field(u);
  live.set_offsets(&at_rest);
  const Image rest = scene.draw(live);
  for (int step = 0; step < 3; ++step) {
    // There, elsewhere, and back to rest.
    const Vec3d middle = kMiddle + Vec3d(4, 0, step == 0 ? 8 : -8);
    const Displacement moved = scene.displaced(bump_warp(middle, 14, step == 2 ? 0 : 6));
    std::vector<std::int32_t> changed;
    for (std::size_t b = 0; b < u.u.topology.brick_count(); ++b) {
      const auto brick = [&](const Displacement& d) { return d.u.vectors.brick_or_zero(b); };
      if (!std::equal(brick(u), brick(u) + kBrickVoxels, brick(moved))) changed.push_back(int(b));
    }
    ASSERT_FALSE(changed.empty());
    live.update_offsets(inversion.update(moved, changed), inversion.finder());
    u = moved;
    const OffsetField offsets = invert(moved);
    anew.set_offsets(&offsets);
    const Image picture = scene.draw(live);
    EXPECT_EQ(picture.rgba, scene.draw(anew).rgba);
    EXPECT_EQ(picture.rgba == rest.rgba, step == 2);
  }
}

TEST(PropertyLiveOffsets, WithoutAnInverseThePictureIsAlmostTheSame) {
  const LiveScene scene;
  Renderer renderer(scene.geometry, scene.density);
  const Image rest = scene.draw(renderer);
  for (const AnalyticWarp& warp : {bump_warp(kMiddle + Vec3d(4, 0, 2), 20, 9),
                                   shear_warp(kMiddle, 0.5), stretch_warp(kMiddle, 1.35)}) {
    const Displacement u = scene.displaced(warp);
    renderer.set_pointwise_offsets(std::make_shared<ForwardOffsets>(u));
    const Image forward = scene.draw(renderer);
    const OffsetField offsets = invert(u);
    renderer.set_offsets(&offsets);
    const Image inverse = scene.draw(renderer);
    EXPECT_GE(compare(forward, inverse, true).ssim, 0.995);
    EXPECT_LT(compare(forward, rest, true).ssim, 0.95);
  }
}

TEST(PropertyLiveOffsets, EverySecondOffsetGivesAlmostTheSamePictureInLessMemory) {
  const LiveScene scene;
  Renderer renderer(scene.geometry, scene.density);
  RenderReport straight, full, half;
  const auto draw = [&](RenderReport& report) {
    return renderer.render(scene.camera, surface_function(), small_picture(120, 1.0 / 3), &report);
  };
  const Image rest = draw(straight);
  for (const AnalyticWarp& warp :
       {bump_warp(kMiddle + Vec3d(4, 0, 2), 20, 9), shear_warp(kMiddle, 0.5)}) {
    const OffsetField offsets = invert(scene.displaced(warp));
    renderer.set_offsets(&offsets);
    const Image expected = draw(full);
    renderer.set_offsets(&offsets, OffsetResolution::half);
    const Image image = draw(half);
    EXPECT_GE(compare(image, expected, true).ssim, 0.99);
    EXPECT_LT(compare(image, rest, true).ssim, 0.95);
    EXPECT_LT(double(half.bytes - straight.bytes), 0.35 * double(full.bytes - straight.bytes));
  }
}

TEST(PropertyLiveOffsets, WithoutMovementThePictureIsTheStraightOneBitForBit) {
  const LiveScene scene;
  Renderer renderer(scene.geometry, scene.density);
  const Image rest = scene.draw(renderer);
  Displacement u = scene.displaced(bump_warp(kMiddle, 20, 9));
  const auto offsets = std::make_shared<ForwardOffsets>(u);
  renderer.set_pointwise_offsets(offsets);
  EXPECT_NE(scene.draw(renderer).rgba, rest.rgba);
  u = scene.displaced(bump_warp(kMiddle, 20, 0));
  std::vector<std::int32_t> all;
  for (std::size_t b = 0; b < u.u.topology.brick_count(); ++b) all.push_back(int(b));
  offsets->update(all);
  EXPECT_TRUE(offsets->bricks().empty());
  renderer.set_pointwise_offsets(offsets);
  EXPECT_EQ(scene.draw(renderer).rgba, rest.rgba);
}

class OneSplitBrick final : public SplitOffsets {
 public:
  OneSplitBrick() { set_bricks({Vec3i(40)}); }
  bool sample(std::size_t, const Vec3d&, Sample&) const override { return false; }
  bool offset_of(int, const Vec3d&, Vec3d&) const override { return false; }
  double depth_mm(int, const Vec3d&) const override { return 0; }
  void source_box(std::size_t, Vec3d& lo, Vec3d& hi) const override {
    lo = Vec3d(1), hi = Vec3d(0);
  }
};

TEST(FaultLiveOffsets, OffsetsThatJumpAreNotUpdated) {
  const LiveScene scene;
  Renderer renderer(scene.geometry, scene.density);
  OffsetField offsets = invert(scene.displaced(bump_warp(kMiddle, 20, 9)));
  offsets.split = std::make_shared<OneSplitBrick>();
  renderer.set_offsets(&offsets);
  EXPECT_THROW(renderer.update_offsets({}, finder_of(offsets.o)), InputError);
}

}  // namespace
}  // namespace supple

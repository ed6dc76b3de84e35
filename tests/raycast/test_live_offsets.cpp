// Pictures of a body that is being dragged: offsets that are updated, and offsets without inverse.
#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "raycast/progressive.h"
#include "tests/raycast/scenes.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/offset_field.h"
#include "volumes/field/procedural.h"

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

/// The body at rest, and what a renderer follows it with.
class FollowedBody {
 public:
  explicit FollowedBody(const LiveScene& scene, Interpolation interpolation = Interpolation::linear,
                        OffsetResolution resolution = OffsetResolution::full)
      : renderer(scene.geometry, scene.density, 0, interpolation),
        m_scene(scene),
        m_u(scene.displaced(shear_warp(kMiddle, 0))),
        m_inversion(m_u) {
    const OffsetField at_rest = m_inversion.offsets();
    renderer.set_offsets(&at_rest, resolution);
  }
  void move(const AnalyticWarp& warp) {
    const Displacement moved = m_scene.displaced(warp);
    std::vector<std::int32_t> changed;
    for (std::size_t b = 0; b < m_u.u.topology.brick_count(); ++b) {
      const auto brick = [&](const Displacement& d) { return d.u.vectors.brick_or_zero(b); };
      if (!std::equal(brick(m_u), brick(m_u) + kBrickVoxels, brick(moved))) {
        changed.push_back(int(b));
      }
    }
    ASSERT_FALSE(changed.empty());
    renderer.update_offsets(m_inversion.update(moved, changed), m_inversion.finder());
    m_u = moved;
  }
  OffsetField offsets() const { return invert(m_u); }

  Renderer renderer;

 private:
  const LiveScene& m_scene;
  Displacement m_u;
  IncrementalInversion m_inversion;
};

/// There, elsewhere, and back to rest.
AnalyticWarp warp_of_step(int step) {
  return bump_warp(kMiddle + Vec3d(4, 0, step == 0 ? 8 : -8), 14, step == 2 ? 0 : 6);
}

TEST(PropertyLiveOffsets, UpdatedBricksGiveThePictureOfAllOffsetsSetAnew) {
  const LiveScene scene;
  FollowedBody live(scene);
  Renderer anew(scene.geometry, scene.density);
  const Image rest = scene.draw(live.renderer);
  for (int step = 0; step < 3; ++step) {
    live.move(warp_of_step(step));
    const OffsetField offsets = live.offsets();
    anew.set_offsets(&offsets);
    const Image picture = scene.draw(live.renderer);
    EXPECT_EQ(picture.rgba, scene.draw(anew).rgba);
    EXPECT_EQ(picture.rgba == rest.rgba, step == 2);
  }
}

std::unique_ptr<ProgressiveRender> refined(std::unique_ptr<ProgressiveRender> picture) {
  while (picture->refine()) {
  }
  return picture;
}

/// A way to look at the body.
struct FollowedView {
  const char* name;
  std::function<void(const LiveScene&, Camera&, TransferFunction&, RenderSettings&)> change;
  bool keeps_pixels = true;  // a drag is seen in a part of the picture
  Interpolation interpolation = Interpolation::linear;
  OffsetResolution resolution = OffsetResolution::full;
  bool has_mesh = false;
};

/// Four pixels per voxel, so that a brick has some tiles of pixels.
void show_near(const LiveScene&, Camera& camera, TransferFunction&, RenderSettings& settings) {
  camera = zoomed(camera, 2);
  settings.width = settings.height = 220;
}

std::vector<FollowedView> followed_views() {
  return {
      {"as it is", [](auto&, auto&, auto&, auto&) {}},
      {"parallel", [](auto&, Camera& camera, auto&, auto&) { camera = front_camera(96); }},
      {"near", show_near},
      {"near, off axis",
       [](auto& scene, Camera& camera, auto& function, auto& settings) {
         show_near(scene, camera, function, settings);
         camera.window_shift = 0.7;
       }},
      {"from within",
       [](auto& scene, Camera& camera, auto&, auto&) {
         camera.position_lps_mm = scene.geometry.world_from_index(kMiddle + Vec3d(-42, 0, 6));
         camera.vertical_fov_degrees = 120;
       }},
      {"cubic", [](auto&, auto&, auto&, auto&) {}, true, Interpolation::cubic},
      {"near, every second offset", show_near, true, Interpolation::linear, OffsetResolution::half},
      {"near, every step",
       [](auto& scene, auto& camera, auto& function, auto& settings) {
         show_near(scene, camera, function, settings);
         settings.stride = 1;
         settings.jitter = true;
       }},
      {"near, pre-integrated",
       [](auto& scene, auto& camera, auto& function, auto& settings) {
         show_near(scene, camera, function, settings);
         settings.classification = Classification::pre_integrated;
       }},
      {"fog", [](auto&, auto&, auto& function, auto&) { function = fog_function(0.02); }},
      {"gradients",
       [](auto&, auto&, auto& function, auto&) {
         function.gradient_opacity = {{0, 0}, {100, 1}};
       }},
      {"maximum", [](auto&, auto&, auto& function, auto&) { function.blend = Blend::maximum; }},
      {"cut open",
       [](auto& scene, auto&, auto&, auto& settings) {
         settings.clips = {{box_region(scene.geometry, Vec3d(0, 45, 0), Vec3d(95)),
                            ClipKeep::inside, ClipSpace::deformed},
                           {box_region(scene.geometry, Vec3d(0), Vec3d(95, 95, 60)),
                            ClipKeep::inside, ClipSpace::source}};
       }},
      {"with a mesh", [](auto&, auto&, auto&, auto&) {}, true, Interpolation::linear,
       OffsetResolution::full, true},
      {"shadows", [](auto&, auto&, auto&, auto& settings) { settings.lighting.shadows = true; },
       false}};
}

/// Upright through the middle of the body, half of it before the body's left.
Surface screen() {
  Surface surface;
  surface.mesh.vertices_lps_mm = {{0, -8, -40}, {40, -8, -40}, {40, -8, 40}, {0, -8, 40}};
  surface.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  surface.opacity = 0.999;
  return surface;
}

TEST(PropertyLiveOffsets, AFollowedPictureHasTheBitsOfAWholeOneAndMarchesLess) {
  const LiveScene scene;
  for (const FollowedView& view : followed_views()) {
    SCOPED_TRACE(view.name);
    FollowedBody live(scene, view.interpolation, view.resolution);
    if (view.has_mesh) live.renderer.set_surfaces({screen()});
    Camera camera = scene.camera;
    TransferFunction function = surface_function();
    RenderSettings settings = small_picture(90, 1.0 / 3);
    settings.auxiliary = true;
    view.change(scene, camera, function, settings);
    auto picture =
        refined(std::make_unique<ProgressiveRender>(live.renderer, camera, function, settings));
    const std::int64_t all = std::int64_t(settings.width) * settings.height;
    EXPECT_EQ(picture->changed_pixels(), all);
    for (int step = 0; step < 3; ++step) {
      live.move(warp_of_step(step));
      picture = refined(picture->follow());
      const FloatImage followed = picture->picture();
      const FloatImage whole = live.renderer.render_float(camera, function, settings);
      EXPECT_TRUE(same_bits(followed.rgba, whole.rgba));
      EXPECT_TRUE(same_bits(followed.depth_mm, whole.depth_mm));
      EXPECT_TRUE(same_bits(followed.normal_lps, whole.normal_lps));
      EXPECT_TRUE(same_bits(followed.offset_mm, whole.offset_mm));
      EXPECT_GT(picture->changed_pixels(), 0);
      EXPECT_EQ(picture->changed_pixels() < all, view.keeps_pixels);
    }
    picture = refined(picture->follow());
    EXPECT_EQ(picture->changed_pixels() == 0, view.keeps_pixels);
    EXPECT_EQ(picture->may_be_followed(), view.keeps_pixels);
  }
}

/// Within 6 voxels of the place.
AnalyticWarp small_dent(const Vec3d& center) {
  AnalyticWarp warp;
  warp.displacement_voxels = [center](const Vec3d& place) {
    const Vec3d from = place - center;
    const double part = std::max(1 - from.dot(from) / 36, 0.0);
    return Vec3d(0, 2 * part * part, 0);
  };
  return warp;
}

// Rays beside the body, and at its edge, pass through without becoming opaque.
TEST(PropertyLiveOffsets, WhatMovesBehindAnOpaqueSurfaceIsNotMarchedAgain) {
  const LiveScene scene;
  const auto changed_from = [&](const std::string& side) {
    FollowedBody live(scene);
    const Camera camera = zoomed(default_camera(scene.geometry, 1, side), 3);
    auto picture = refined(std::make_unique<ProgressiveRender>(
        live.renderer, camera, surface_function(), small_picture(120, 1.0 / 3)));
    const FloatImage rest = picture->picture();
    live.move(small_dent(kMiddle - Vec3d(15, 0, 0)));
    picture = refined(picture->follow());
    EXPECT_EQ(same_bits(picture->picture().rgba, rest.rgba), side == "left");
    return picture->changed_pixels();
  };
  const std::int64_t hidden = changed_from("left"), seen = changed_from("right");
  EXPECT_LT(3 * hidden, seen) << hidden;
}

// Samples of all rays lie elsewhere then; and of offsets set anew nothing is known.
TEST(PropertyLiveOffsets, WhereTheBoxOfRaysOrAllOffsetsChangeEveryPixelIsMarched) {
  const LiveScene scene;
  FollowedBody live(scene);
  const RenderSettings settings = small_picture(64);
  auto picture = refined(std::make_unique<ProgressiveRender>(live.renderer, scene.camera,
                                                             surface_function(), settings));
  live.move(bump_warp(kMiddle, 14, 60));
  picture = refined(picture->follow());
  EXPECT_EQ(picture->changed_pixels(), 64 * 64);
  const auto expect_whole = [&] {
    const FloatImage whole = live.renderer.render_float(scene.camera, surface_function(), settings);
    EXPECT_TRUE(same_bits(picture->picture().rgba, whole.rgba));
  };
  expect_whole();
  live.renderer.set_offsets(nullptr);
  EXPECT_EQ(picture->follow()->changed_pixels(), 64 * 64);
  picture = refined(picture->follow());
  expect_whole();
  live.renderer.set_surfaces({});
  EXPECT_EQ(picture->follow()->changed_pixels(), 64 * 64);
  // An unfinished picture has no pixels to take over.
  EXPECT_EQ(picture->follow()->follow()->changed_pixels(), 64 * 64);
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

}  // namespace
}  // namespace supple

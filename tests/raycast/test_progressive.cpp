// Progressive refinement: coarse first, every pixel once, cancelled at any time.
#include <atomic>
#include <cstring>
#include <thread>

#include <gtest/gtest.h>

#include "raycast/progressive.h"
#include "tests/raycast/scenes.h"

namespace supple {
namespace {

class PropertyProgressive : public testing::Test {
 protected:
  const Geometry m_geometry = cube_geometry(24);
  const Renderer m_renderer{
      m_geometry, grid_of(voxels_of(m_geometry.dims(), everywhere), lobed_body(Vec3d(11.5), 8))};
  const Camera m_camera = default_camera(m_geometry, 1);
};

TEST_F(PropertyProgressive, TheLastPictureIsThatOfOnePassAndNoPixelIsMarchedTwice) {
  RenderSettings settings = small_picture(50);
  settings.height = 37;
  settings.auxiliary = true;
  RenderReport report;
  const FloatImage whole = m_renderer.render_float(m_camera, surface_function(), settings, &report);
  ProgressiveRender render(m_renderer, m_camera, surface_function(), settings);
  EXPECT_EQ(render.spacing(), 0);
  for (const int spacing : {8, 4, 2, 1}) {
    EXPECT_FALSE(render.finished());
    ASSERT_TRUE(render.refine());
    EXPECT_EQ(render.spacing(), spacing);
    const FloatImage picture = render.picture();
    for (int y = 0; y < settings.height; ++y) {
      for (int x = 0; x < settings.width; ++x) {
        const std::size_t n = std::size_t(y) * settings.width + x;
        const std::size_t corner =
            std::size_t(y - y % spacing) * settings.width + (x - x % spacing);
        ASSERT_EQ(std::memcmp(&picture.rgba[4 * n], &whole.rgba[4 * corner], 16), 0);
        ASSERT_EQ(std::memcmp(&picture.depth_mm[n], &whole.depth_mm[corner], 4), 0);
      }
    }
  }
  EXPECT_TRUE(render.finished());
  EXPECT_FALSE(render.refine());
  EXPECT_EQ(render.samples(), report.samples);
  EXPECT_TRUE(same_bits(render.picture().normal_lps, whole.normal_lps));
  EXPECT_TRUE(same_bits(render.picture().offset_mm, whole.offset_mm));
}

TEST_F(PropertyProgressive, PassesMayBeSkippedAndNoPixelIsMarchedTwice) {
  RenderSettings settings = small_picture(50);
  settings.height = 37;
  RenderReport report;
  const FloatImage whole = m_renderer.render_float(m_camera, surface_function(), settings, &report);
  for (const int first : {8, 4, 2, 1}) {
    ProgressiveRender render(m_renderer, m_camera, surface_function(), settings);
    ASSERT_TRUE(render.refine_to(first));
    EXPECT_EQ(render.spacing(), first);
    EXPECT_EQ(render.refine_to(1), first > 1);
    EXPECT_TRUE(render.finished());
    EXPECT_EQ(render.samples(), report.samples);
    EXPECT_TRUE(same_bits(render.picture().rgba, whole.rgba));
  }
}

TEST_F(PropertyProgressive, CancellingFromAnotherThreadEndsAPassAndKeepsTheLastPicture) {
  // The whole picture would take several seconds.
  const RenderSettings settings = small_picture(1024, 0.05);
  ProgressiveRender render(m_renderer, m_camera, surface_function(), settings);
  std::atomic<int> passes{0};
  FloatImage coarse;
  std::thread refining([&] {
    while (render.spacing() != 8 ? render.refine() : (++passes, render.refine())) {
      if (render.spacing() == 8) coarse = render.picture();
    }
  });
  while (passes == 0) std::this_thread::yield();
  render.cancel();
  refining.join();
  EXPECT_EQ(render.spacing(), 8);
  EXPECT_TRUE(same_bits(render.picture().rgba, coarse.rgba));
  EXPECT_FALSE(render.refine());
}

TEST_F(PropertyProgressive, WhatIsCancelledBeforeItBeginsDoesNothing) {
  ProgressiveRender render(m_renderer, m_camera, surface_function(), small_picture(64));
  render.cancel();
  EXPECT_FALSE(render.refine());
  EXPECT_EQ(render.spacing(), 0);
  EXPECT_EQ(render.samples(), 0);
}

}  // namespace
}  // namespace supple

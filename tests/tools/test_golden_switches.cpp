// Parts that make pictures of deformed tissue right, switched off one by one: each time a golden
// image must fail by a wide margin (docs/building.md lists by how much).
#include <gtest/gtest.h>

#include "lib/state/state.h"
#include "raycast/pictures/compare.h"
#include "raycast/render.h"
#include "tests/tools/golden.h"
#include "volumes/field/inversion/invert.h"

using namespace supple;
using namespace supple::test;

namespace {

/// The sheared head as shear.toml draws it, by the library.
class GoldenSwitches : public ::testing::Test {
 protected:
  GoldenSwitches() : m_state(sheared_head()), m_renderer(m_state.geometry, m_state.density) {
    m_camera.position_lps_mm = {420, -220, 60};
    m_camera.target_lps_mm = {0, -20, 0};
    m_camera.vertical_fov_degrees = 27;
    m_settings.width = m_settings.height = 140;
    show(extended_displacement_of(m_state));
  }

  void show(const Displacement& displacement) { show(invert(displacement)); }
  void show(const OffsetField& offsets) { m_renderer.set_offsets(&offsets); }

  Comparison against(const std::string& golden, const std::string& look) const {
    return compare(m_renderer.render(m_camera, preset(look), m_settings), golden_reference(golden),
                   true);
  }
  void expect_golden_within(const std::string& golden, const std::string& look) const {
    const Comparison same = against(golden, look);
    EXPECT_LE(same.rmse, kMaxRmse) << golden;
    EXPECT_GE(same.ssim, kMinSsim) << golden;
  }
  /// Expects a loss of at least five times what is allowed, which is none of rounding.
  void expect_golden_fails(const std::string& golden, const std::string& look) const {
    const Comparison changed = against(golden, look);
    EXPECT_GT(changed.rmse, 5 * kMaxRmse) << golden;
    EXPECT_LT(changed.ssim, 1 - 5 * (1 - kMinSsim)) << golden;
    RecordProperty(golden, std::to_string(changed.ssim));
  }

  State m_state;
  Renderer m_renderer;
  Camera m_camera;
  RenderSettings m_settings;

 private:
  static State sheared_head() {
    const GoldenFolder folder;
    folder.run("shear");
    return read_state(folder / "shear.vdb");
  }
};

}  // namespace

TEST_F(GoldenSwitches, NothingSwitchedOffGivesTheGoldenImages) {
  expect_golden_within("shear_bone.png", "Bone");
  expect_golden_within("shear_skin.png", "Skin");
  m_settings.jitter = true;
  expect_golden_within("shear_jitter.png", "Skin");
}

TEST_F(GoldenSwitches, WithoutTheTransformOfGradientsTheyFail) {
  m_settings.transform_gradient = false;
  expect_golden_fails("shear_bone.png", "Bone");
  expect_golden_fails("shear_skin.png", "Skin");
}

TEST_F(GoldenSwitches, WithoutTheExtensionIntoTheAirTheyFail) {
  Displacement cut_short = extended_displacement_of(m_state);
  const BrickTopology& topology = cut_short.u.topology;
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for_each_active(topology.mask(b), [&](int n) {
      const bool is_element = m_state.elements.is_active(topology.origin(b) + brick_local(n));
      if (!is_element) cut_short.u.vectors.touch(b)[n] = {0, 0, 0};
    });
  }
  show(cut_short);
  expect_golden_fails("shear_bone.png", "Bone");
  expect_golden_fails("shear_skin.png", "Skin");
}

TEST_F(GoldenSwitches, WithoutJitterTheJitteredOneFails) {
  expect_golden_fails("shear_jitter.png", "Skin");
}

TEST_F(GoldenSwitches, WithTheSignOfTheOffsetsFlippedTheyFail) {
  OffsetField offsets = invert(extended_displacement_of(m_state));
  for_each_stored(offsets.o.vectors, [](Vec3f& vector) { vector = -vector; });
  show(offsets);
  expect_golden_fails("shear_bone.png", "Bone");
  expect_golden_fails("shear_skin.png", "Skin");
}

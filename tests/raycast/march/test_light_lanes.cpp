// Sixteen lit samples at once against the formulas in double precision, for every instruction set
// of this machine.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "raycast/march/light_lanes.h"

namespace supple {
namespace {

constexpr int kLanes = SampleBatch::kLanes;

/// One sample by the definition.
struct ExpectedLight {
  double magnitude = 0, trust = 0;
  Vec3d normal{0, 0, 0};
  std::array<double, 2> diffuse, specular;
};

struct LanesScene {
  TransferFunction function;
  Lighting lighting;
  std::array<Vec3f, 3> columns{Vec3f(2, 0.5f, 0), Vec3f(-0.5f, 3, 0.25f), Vec3f(0, 0, 0.7f)};
  Vec3d towards_eye = Vec3d(0.3, -0.8, 0.2).normalized();
  SampleBatch batch;
  LitLanes lit;

  LanesScene(ShadingModel model, double specular_power) {
    function.specular_power = specular_power;
    function.full_shading_gradient = 1;
    lighting.model = model;
    lighting.lights = {{{1, -2, 0.5}, false, {1, 1, 1}, 1}, {{-1, -0.1, 0}, false, {1, 1, 1}, 1}};
    std::mt19937 random(5);
    std::uniform_real_distribution<float> any(-1, 1);
    for (int lane = 0; lane < kLanes; ++lane) {
      const float scale = lane % 5 == 4 ? 0 : 0.5f;
      batch.gx[lane] = scale * any(random);
      batch.gy[lane] = scale * any(random);
      batch.gz[lane] = scale * any(random);
      if (lane % 3 != 0) continue;
      Vec3f face = Vec3f(any(random), any(random), any(random)).normalized();
      if (face.dot(Vec3f(towards_eye)) < 0) face = -face;
      lit.faces |= 1u << lane;
      lit.face.set(lane, face);
      lit.face_share[lane] = lane == 0 ? 1 : 0.5f * (1 + any(random));
    }
  }

  ExpectedLight expected(int lane) const {
    ExpectedLight result;
    const Vec3d gradient = Vec3d(columns[0]) * double(batch.gx[lane]) +
                           Vec3d(columns[1]) * double(batch.gy[lane]) +
                           Vec3d(columns[2]) * double(batch.gz[lane]);
    result.magnitude = gradient.length();
    result.normal = gradient.normalized();
    if (result.normal.dot(towards_eye) < 0) result.normal = -result.normal;
    result.trust = std::min(result.magnitude / function.full_shading_gradient, 1.0);
    if (lit.faces >> lane & 1) {
      const Vec3d face(lit.face.at(lane));
      const double share = lit.face_share[lane];
      const Vec3d from = result.magnitude > 0 ? result.normal : face;
      result.normal = (from * (1 - share) + face * share).normalized();
      result.trust += share * (1 - result.trust);
    } else if (result.magnitude == 0) {
      result.normal = towards_eye;
    }
    for (int n = 0; n < 2; ++n) {
      const Vec3d light = lighting.lights[n].direction.normalized();
      const double cosine = result.normal.dot(light);
      double highlight = result.normal.dot((light + towards_eye).normalized());
      if (lighting.model == ShadingModel::phong) {
        highlight = cosine > 0 ? (result.normal * (2 * cosine) - light).dot(towards_eye) : 0;
      }
      result.diffuse[n] = 1 - result.trust + result.trust * std::max(cosine, 0.0);
      result.specular[n] =
          std::pow(result.trust * std::max(highlight, 0.0), function.specular_power);
    }
    return result;
  }
};

void expect_lit_by_the_formulas(ShadingModel model, double specular_power, std::uint32_t wanted) {
  LanesScene scene(model, specular_power);
  const Shading shading({}, scene.function, scene.lighting);
  const Shading::View view = shading.view({{0, 0, 0}, -scene.towards_eye});
  light_lanes(shading, view, scene.columns, scene.batch, wanted, scene.lit);
  constexpr double kTolerance = 2e-6;
  for (int lane = 0; lane < kLanes; ++lane) {
    if (!(wanted >> lane & 1)) continue;
    SCOPED_TRACE("lane " + std::to_string(lane));
    const ExpectedLight expected = scene.expected(lane);
    EXPECT_NEAR(scene.lit.magnitude[lane], expected.magnitude, kTolerance);
    EXPECT_NEAR(scene.lit.facing(lane).trust, expected.trust, kTolerance);
    EXPECT_LT((Vec3d(scene.lit.facing(lane).normal) - expected.normal).length(), kTolerance);
    for (int n = 0; n < 2; ++n) {
      EXPECT_NEAR(scene.lit.terms(n, lane).diffuse, expected.diffuse[n], kTolerance);
      // A power magnifies the rounding of what it is taken of.
      EXPECT_NEAR(scene.lit.terms(n, lane).specular, expected.specular[n],
                  kTolerance * std::max(1.0, specular_power / 4));
    }
  }
}

TEST(PropertyLightLanes, EveryInstructionSetLightsSamplesByTheFormulas) {
  for (const std::string& set : sampling_instruction_sets()) {
    SCOPED_TRACE(set);
    choose_sampling_instruction_set(set);
    for (const ShadingModel model : {ShadingModel::blinn, ShadingModel::phong}) {
      for (const double specular_power : {1.0, 7.5, 12.0, 100.0}) {
        for (const std::uint32_t wanted : {0xFFFFu, 1u, 0x8001u, 0x5A70u}) {
          expect_lit_by_the_formulas(model, specular_power, wanted);
        }
      }
    }
  }
  choose_sampling_instruction_set("");
}

}  // namespace
}  // namespace supple

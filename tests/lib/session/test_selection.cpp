// Selections of elements against a look at every voxel, and the edges around them.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "lib/body/cut.h"
#include "lib/session/handles/selection.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/errors.h"
#include "volumes/base/json.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A random block with its densities as a grid.
struct DenseBody {
  explicit DenseBody(unsigned seed) : random(seed), block(random_block(random, {14, 12, 10})) {
    body = body_of(block);
    std::vector<float> values(slot_count(body.elements), 0);
    for (int n = 0; n < block.size(); ++n) {
      Slot slot;
      if (slot_of(body.elements, block.voxel(n), slot)) values[slot] = float(block.density[n]);
    }
    density = make_density_grid(body.elements, values, -1000);
  }

  Vec3d some_place() {
    std::uniform_real_distribution<double> beyond(-0.4, 0.4);
    return Vec3d(block.voxel(random_element(random, block))) +
           Vec3d(beyond(random), beyond(random), beyond(random));
  }

  std::mt19937 random;
  Block block;
  Body body;
  DensityGrid density;
};

double distance_mm(const Geometry& geometry, const Vec3i& voxel, const Vec3d& centre) {
  return (geometry.world_from_index(Vec3d(voxel)) - geometry.world_from_index(centre)).length();
}

}  // namespace

TEST(PropertySelection, BallsBoxesAndDensitiesAreWhatEveryVoxelSaysOfItself) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    DenseBody given(seed);
    Selection selection;
    if (seed % 4 != 0) {
      selection.ball_index = given.some_place();
      selection.radius_mm = 0.5 + seed % 7;
    }
    if (seed % 3 == 0) {
      const Vec3i corner = given.block.voxel(random_element(given.random, given.block));
      selection.box = IndexBox{corner - Vec3i(3, 2, 1), corner + Vec3i(2, 4, 3)};
    }
    if (seed % 2 == 0) {
      const double a = given.block.density[std::size_t(random_element(given.random, given.block))];
      const double b = given.block.density[std::size_t(random_element(given.random, given.block))];
      selection.density = NumberPair(std::min(a, b), std::max(a, b));
    }
    if (selection == Selection{}) continue;
    std::int64_t expected = 0;
    const auto is_expected = [&](const Vec3i& voxel) {
      const double value = given.density.at(voxel);
      return (!selection.ball_index || distance_mm(given.body.geometry, voxel,
                                                   *selection.ball_index) <= selection.radius_mm) &&
             (!selection.box || selection.box->contains(voxel)) &&
             (!selection.density ||
              (value >= selection.density->first && value <= selection.density->second));
    };
    SlotSet found;
    const std::string error = input_error([&] {
      found =
          elements_of(given.body, region_of(selection, given.body, given.density, "grab"), "grab");
    });
    for (int n = 0; n < given.block.size(); ++n) {
      const Vec3i voxel = given.block.voxel(n);
      Slot slot;
      if (!slot_of(given.body.elements, voxel, slot)) continue;
      expected += is_expected(voxel);
      ASSERT_EQ(found.contains(slot), is_expected(voxel)) << seed << " " << voxel;
    }
    EXPECT_EQ(std::int64_t(found.size()), expected);
    EXPECT_EQ(error.empty(), expected > 0) << error;
    EXPECT_EQ(selection_of(selection_value(selection), "x"), selection);
  }
}

TEST(UnitSelection, APieceEndsWhereDensitiesDoAndNamesAVoxelThatIsNoneOfIt) {
  // Two walls of density 200 in tissue of 100.
  Block block = full_block({12, 9, 9}, constant_table(1.3, 0.7, 0.3),
                           [](int i, int, int) { return i == 3 || i == 9 ? 200.0 : 100.0; });
  const Body body = body_of(block);
  std::vector<float> values(slot_count(body.elements), 0);
  for (int n = 0; n < block.size(); ++n) {
    Slot slot;
    if (slot_of(body.elements, block.voxel(n), slot)) values[slot] = float(block.density[n]);
  }
  const DensityGrid density = make_density_grid(body.elements, values, 0);
  Selection wall;
  wall.density = NumberPair(150, 250);
  EXPECT_EQ(elements_of(body, region_of(wall, body, density, "fix"), "fix").size(), 162u);
  wall.piece_at = Vec3i(9, 4, 4);
  EXPECT_EQ(elements_of(body, region_of(wall, body, density, "fix"), "fix").size(), 81u);
  wall.piece_at = Vec3i(5, 4, 4);
  const std::string error = input_error([&] { region_of(wall, body, density, "fix"); });
  EXPECT_NE(error.find("5,4,4 of density 100"), std::string::npos) << error;
}

TEST(PropertySelection, PartsOfAnEdgeFollowHermitesCubicOfTheDistance) {
  for (unsigned seed = 100; seed < 130; ++seed) {
    DenseBody given(seed);
    Selection ball;
    ball.ball_index = given.some_place();
    ball.radius_mm = 0.3 + seed % 3;
    const double width = 1 + seed % 5;
    const SoftEdge edge = soft_edge(ball, width, given.body, given.body.cuts, given.density);
    std::size_t n = 0, expected = 0;
    edge.slots.for_each([&](Slot slot) {
      const Vec3i voxel = voxel_of(given.body.elements, slot);
      const double t =
          (distance_mm(given.body.geometry, voxel, *ball.ball_index) - ball.radius_mm) / width;
      ASSERT_NEAR(edge.parts[n++], (1 - t) * (1 - t) * (1 + 2 * t), 1e-9);
    });
    EXPECT_EQ(n, edge.parts.size());
    for (int at = 0; at < given.block.size(); ++at) {
      const Vec3i voxel = given.block.voxel(at);
      const double beyond =
          distance_mm(given.body.geometry, voxel, *ball.ball_index) - ball.radius_mm;
      expected += given.body.elements.is_active(voxel) && beyond > 0 && beyond < width;
    }
    EXPECT_EQ(n, expected);
  }
}

TEST(UnitSelection, AnEdgeDoesNotReachAcrossACut) {
  Body body = body_of(homogeneous({20, 15, 15}, 1.3, 0.7, 0.3));
  const DensityGrid density =
      make_density_grid(body.elements, std::vector<float>(slot_count(body.elements), 100), 0);
  Selection ball, box;
  ball.ball_index = Vec3d(6.8, 4.1, 7.2);
  ball.radius_mm = 1.6;
  box.box = IndexBox{{5, 2, 6}, {7, 4, 8}};
  constexpr double kWidth = 9, kAt = 9.5, kEnd = 7.5;  // the plane i = kAt, as far as j = kEnd
  const SlotSet whole_ball = soft_edge(ball, kWidth, body, body.cuts, density).slots;
  const SlotSet whole_box = soft_edge(box, kWidth, body, body.cuts, density).slots;
  const Geometry& geometry = body.geometry;
  cut(body, PlanePatch{geometry.world_from_index({kAt, -1, -1}),
                       geometry.world_vector_from_index({0, kEnd + 1, 0}),
                       geometry.world_vector_from_index({0, 0, 17})});
  int parted = 0, beyond_its_end = 0;
  for (const bool is_ball : {true, false}) {
    const Selection& selection = is_ball ? ball : box;
    const SlotSet& whole = is_ball ? whole_ball : whole_box;
    const SoftEdge edge = soft_edge(selection, kWidth, body, body.cuts, density);
    EXPECT_EQ(edge.parts.size(), edge.slots.size());
    whole.for_each([&](Slot slot) {
      const Vec3d at(voxel_of(body.elements, slot));
      Vec3d to = is_ball ? *ball.ball_index : at;
      for (int c = 0; !is_ball && c < 3; ++c) {
        to[c] = std::clamp(to[c], double(box.box->lo[c]), double(box.box->hi[c]));
      }
      if (at.x < kAt) {
        EXPECT_TRUE(edge.slots.contains(slot)) << at;
        return;
      }
      const double crossed_at = at.y + (to.y - at.y) * (at.x - kAt) / (at.x - to.x);
      if (std::abs(crossed_at - kEnd) < 1) return;
      EXPECT_EQ(edge.slots.contains(slot), crossed_at > kEnd) << at;
      (crossed_at > kEnd ? beyond_its_end : parted) += 1;
    });
  }
  EXPECT_GT(parted, 500);
  EXPECT_GT(beyond_its_end, 20);
}

TEST(UnitSelection, AForgedSelectionIsRefused) {
  for (const char* text : {"{}", "[]", "{\"grab_density\":[1]}", "{\"grab_ball\":[1,2,3]}",
                           "{\"piece_at\":[1,2,1e300]}", "{\"grab_box\":\"all\"}"}) {
    EXPECT_NE(input_error([&] { selection_of(parse_json(text), "x.vdb"); }).find("x.vdb"),
              std::string::npos)
        << text;
  }
}

// Diagonal links (docs/models/ecm.md): their slack, where they exist, and the shape of what a
// handle moves. That drags are exact is tested in test_ecm_brute_force.cpp and
// test_block_engine.cpp.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "lib/body/diagonals.h"
#include "lib/body/link_masks.h"
#include "lib/chainmail/ecm.h"
#include "lib/chainmail/tighten.h"
#include "lib/material/material.h"
#include "lib/model/relax_model.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

TEST(UnitLinks, SlackOfADiagonalIsTheQuadratureOfThoseOfItsAxesRoundedDown) {
  MaterialTable table = constant_table(1.5, 0.6, 0.3);
  table.links = 26;
  const SlackTable slacks(table, {1, 1, 1});
  const double stretch = 32768, press = 26214, shear = 19660;
  const auto root = [](double a, double b, double c = 0) {
    return std::int32_t(std::floor(std::sqrt(a * a + b * b + c * c)));
  };
  // q_i - q_j along (1, 1, 0): i may follow until j is pressed, across j it shears.
  EXPECT_EQ(slacks.fall(direction_of_step(1, 1, 0), 0, 7, 9), root(press, shear));
  EXPECT_EQ(slacks.fall(direction_of_step(-1, 1, 0), 0, 7, 9), root(stretch, shear));
  EXPECT_EQ(slacks.fall(direction_of_step(-1, 1, 0), 1, 7, 9), root(shear, press));
  EXPECT_EQ(slacks.fall(direction_of_step(0, -1, -1), 0, 7, 9), root(shear, shear));
  EXPECT_EQ(slacks.fall(direction_of_step(1, -1, 1), 1, 7, 9), root(shear, stretch, shear));
  EXPECT_EQ(slacks.fall(direction_of_step(1, 0, 0), 0, 7, 9), 26214);
  EXPECT_EQ(slacks.fall(direction_of_step(-1, 0, 0), 0, 7, 9), 32768);
}

TEST(UnitLinks, ADiagonalOfAnUnlimitedAxisIsUnlimited) {
  MaterialTable table = constant_table(1e9, 0.6, 0.3);
  table.links = 18;
  const SlackTable slacks(table, {1, 1, 1});
  EXPECT_EQ(slacks.fall(direction_of_step(-1, 1, 0), 0, 0, 0), kUnlimitedSlack);
  EXPECT_LT(slacks.fall(direction_of_step(1, 1, 0), 0, 0, 0), kUnlimitedSlack);
}

TEST(UnitLinks, SixLinksTakeNoMemoryForDiagonals) {
  MaterialTable table = constant_table(1.5, 0.6, 0.3);
  const std::size_t six = SlackTable(table, {1, 1, 1}).bytes();
  EXPECT_EQ(six, 2u * 9 * 511 * sizeof(std::int32_t));
  table.links = 18;
  EXPECT_EQ(SlackTable(table, {1, 1, 1}).bytes(), six + 12u * 3 * 511 * sizeof(std::int32_t));
}

TEST(UnitLinks, MaterialFilesNameThemAndRefuseOtherCounts) {
  const std::string text = "max_length = [[0, 1.2]]\nmin_length = [[0, 0.8]]\nshear = [[0, 0.3]]\n";
  EXPECT_EQ(parse_material(text, "a.toml").links, 6);
  const MaterialTable table = parse_material(text + "links = 26\n", "a.toml");
  EXPECT_EQ(table.links, 26);
  EXPECT_EQ(parse_material(material_to_toml(table), "b.toml").links, 26);
  EXPECT_EQ(material_to_toml(parse_material(text, "a.toml")).find("links"), std::string::npos);
  const std::string error = input_error([&] { parse_material(text + "links = 8\n", "a.toml"); });
  EXPECT_NE(error.find("a.toml:4"), std::string::npos) << error;
  EXPECT_NE(error.find("6, 18 or 26"), std::string::npos) << error;
}

namespace {

/// The links of an element by the rule itself: any order of single steps along uncut links.
bool is_joined(const Body& body, Slot from, LinkStep step, Slot& to) {
  if (step == LinkStep{0, 0, 0}) {
    to = from;
    return true;
  }
  for (int axis = 0; axis < 3; ++axis) {
    LinkStep rest = step;
    Slot next;
    if (rest[std::size_t(axis)] == 0) continue;
    const bool positive = rest[std::size_t(axis)] > 0;
    rest[std::size_t(axis)] = 0;
    if (!neighbour_slot(body.elements, body.cuts, from, axis, positive, next)) continue;
    if (is_joined(body, next, rest, to)) return true;
  }
  return false;
}

}  // namespace

TEST(PropertyLinks, DiagonalsExistWhereAMonotonePathOfUncutLinksJoinsTheirEnds) {
  std::mt19937 random(31);
  std::int64_t diagonals = 0, missing = 0;
  for (int n = 0; n < 41; ++n) {
    Block block = random_block(random, {20, 18, 19});
    if (n % 2) cut_randomly(random, block);
    if (n == 40) {  // whole bricks, with a cut that is near to some of them
      block = homogeneous({40, 24, 24}, 1.5, 0.6, 0.3);
      block.cut.assign(std::size_t(block.size()), 0);
      block.cut[std::size_t(block.index(15, 12, 12))] = 1;
    }
    const Body body = body_of(block);
    for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
      LinkMasks masks;
      find_links(body.elements, body.cuts, 26, neighbours_of(body.elements, b), masks);
      for_each_active(body.elements.mask(b), [&](int offset) {
        const Slot from = Slot(b * kBrickVoxels + std::size_t(offset));
        std::array<Slot, kDirections> ends;
        ends.fill(~Slot(0));
        for_each_linked(body.elements, body.cuts, 26, from,
                        [&](int direction, Slot to) { ends[std::size_t(direction)] = to; });
        for (int direction = 0; direction < kDirections; ++direction) {
          if (direction == kNoStep) continue;
          Slot to = 0;
          const bool expected = is_joined(body, from, step_of_direction(direction), to);
          ASSERT_EQ(mask_test(masks[std::size_t(direction)], offset), expected);
          ASSERT_EQ(ends[std::size_t(direction)], expected ? to : ~Slot(0));
          (expected ? diagonals : missing) += is_diagonal(direction);
        }
      });
    }
  }
  EXPECT_GT(diagonals, 100000);
  EXPECT_GT(missing, 100000);
}

namespace {

/// Distance beyond its surface to which a ball of radius 3, moved by 4 voxels along k, takes tissue
/// with it by at least a tenth of that: in voxels, along i and along the diagonal of the cell.
struct Reach {
  double axis, diagonal;
};
Reach reach_of_a_ball(int links) {
  constexpr int kMiddle = 24, kRadius = 3;
  MaterialTable table = constant_table(1.2, 0.8, 0.2);
  table.links = links;
  Body body = body_of(full_block(Vec3i(2 * kMiddle + 1), table, [](int, int, int) { return 0.0; }));
  std::vector<Handle> handles;
  for (int n = 0; n < 7 * 7 * 7; ++n) {
    const Vec3i from_middle = Vec3i(n / 49, n / 7 % 7, n % 7) - Vec3i(kRadius);
    if (from_middle.length2() > kRadius * kRadius) continue;
    handles.push_back({Vec3i(kMiddle) + from_middle, {0, 0, 4 * kVoxel}});
  }
  EcmSolver(body).drag(handles, {});
  const auto until = [&](const Vec3i& step) {
    const double level = 0.4 * kVoxel;
    double before = 4.0 * kVoxel;
    for (int n = 1; n < kMiddle; ++n) {
      const double here = body.offset(Vec3i(kMiddle) + step * n, 2);
      // Between voxels the offset is linear.
      if (here < level) {
        const double steps = n - 1 + (before - level) / (before - here);
        return steps * Vec3d(step).length() - kRadius;
      }
      before = here;
    }
    return 1e9;
  };
  return {until({1, 0, 0}), until({1, 1, 1})};
}

}  // namespace

TEST(UnitLinks, TheBumpOfABallIsRoundWith26LinksAndAnOctahedronWith6) {
  const Reach six = reach_of_a_ball(6), all = reach_of_a_ball(26);
  std::printf("reach of a ball, axis / diagonal: %.2f / %.2f with 6 links, %.2f / %.2f with 26\n",
              six.axis, six.diagonal, all.axis, all.diagonal);
  EXPECT_NEAR(six.axis, all.axis, 0.01);
  EXPECT_NEAR(six.axis / six.diagonal, std::sqrt(3), 0.05);
  EXPECT_LT(std::max(all.axis / all.diagonal, all.diagonal / all.axis), 1.15);
}

TEST(PropertyLinks, SlackToAnyVoxelIsAtMost13PercentMoreThanThatOfABall) {
  // The worst direction of the metric is (1, sqrt(2) - 1, sqrt(3) - sqrt(2)).
  const double worst26 = std::hypot(1, std::sqrt(2) - 1, std::sqrt(3) - std::sqrt(2));
  MaterialTable table = constant_table(1.25, 0.75, 0.25);
  table.links = 26;
  constexpr int kMiddle = 16;
  Body body = body_of(full_block(Vec3i(2 * kMiddle + 1), table, [](int, int, int) { return 0.0; }));
  const std::int32_t by = 20 * kVoxel;
  EcmSolver(body).drag({{Vec3i(kMiddle), {by, 0, 0}}}, {});
  double largest = 0;
  for_each_element(body.elements, [&](Slot slot) {
    const double distance = Vec3d(voxel_of(body.elements, slot) - Vec3i(kMiddle)).length();
    if (distance == 0) return;
    const double ratio = (by - body.q[0].at(slot)) / (0.25 * kVoxel * distance);
    ASSERT_GE(ratio, 0.9999);  // slack is rounded down to 2^-16 voxel
    largest = std::max(largest, ratio);
  });
  EXPECT_NEAR(largest, worst26, 0.002);
}

namespace {

/// A soft bar with diagonals, its middle pulled across it.
Body pulled_bar(std::vector<Region>& fixed, Holds& holds) {
  MaterialTable table = linear_table(1.5, 0.6, 0.4);
  table.links = 26;
  Body body = body_of(full_block({24, 11, 9}, table, [](int i, int j, int k) {
    return 120.0 + (7 * i + 3 * j + 5 * k) % 120;
  }));
  fixed = {IndexBox{{0, 0, 0}, {0, 10, 8}}};
  EcmSolver(body).drag({{IndexBox{{11, 4, 3}, {13, 6, 5}}, {kVoxel, 2 * kVoxel, -3 * kVoxel}}},
                       fixed, holds);
  return body;
}

}  // namespace

TEST(PropertyLinks, RelaxationThatConservesVolumeLeavesAValidConfigurationOfAllLinks) {
  for (const RelaxMethod method : {RelaxMethod::red_black, RelaxMethod::accelerated}) {
    std::vector<Region> fixed;
    Holds holds;
    Body body = pulled_bar(fixed, holds);
    const Body before = body;
    ASSERT_EQ(check_links(body).violated, 0);
    RelaxParams params;
    params.method = method;
    params.passes = 7;
    params.bulk_modulus_kpa = 10;
    const RelaxReport report = relax(body, fixed, holds, params);
    EXPECT_GT(report.diagonal_links, 0) << "nothing was moved back: the case shows nothing";
    EXPECT_EQ(check_links(body).violated, 0);
    EXPECT_FALSE(same_offsets(body, before));
    for (int j = 0; j < 11; ++j) EXPECT_EQ(body.offset({0, j, 4}, 2), 0);
    EXPECT_EQ(body.offset({12, 5, 4}, 2), -3 * kVoxel);
    // The energy is that of the state that is left, not of the one before diagonals moved it back.
    RelaxParams none = params;
    none.passes = 0;
    EXPECT_DOUBLE_EQ(report.energy_after, relax(body, fixed, holds, none).energy_after);
  }
}

TEST(PropertyLinks, BrokenDiagonalsAreCountedAndProjected) {
  std::mt19937 random(53);
  std::int64_t only_diagonals = 0;
  for (int n = 0; n < 30; ++n) {
    Block block = random_block(random, {18, 17, 10});
    block.table.links = n % 3 ? 26 : 18;
    if (n % 2) cut_randomly(random, block);
    Body body = body_of(block);
    for (BrickValues& q : body.q) {
      q.resize(body.elements.brick_count());
      for_each_element(body.elements, [&](Slot slot) {
        if (random() % 4 == 0) q.set(slot, std::int32_t(random() % 20000) - 10000);
      });
    }
    body.links_known_valid = false;
    std::int64_t links = 0, broken = 0;
    double worst = 0;
    for_each_element(body.elements, [&](Slot from) {
      for_each_linked(body.elements, body.cuts, block.table.links, from, [&](int d, Slot to) {
        if (d < kNoStep) return;
        std::int64_t excess = 0;
        for (int c = 0; c < 3; ++c) {
          const std::int64_t rise = std::int64_t(body.q[c].at(to)) - body.q[c].at(from);
          const int falling = rise > 0 ? opposite_direction(d) : d;
          const std::int32_t most =
              body.slacks.fall(falling, c, body.classes[from], body.classes[to]);
          excess = std::max(excess, std::abs(rise) - most);
        }
        ++links;
        broken += excess > 0;
        only_diagonals += excess > 0 && is_diagonal(d);
        worst = std::max(worst, double(excess) / kVoxel);
      });
    });
    const LinkCheck check = check_links(body);
    EXPECT_EQ(check.links, links);
    EXPECT_EQ(check.violated, broken);
    EXPECT_EQ(check.worst_excess_voxels, worst);
    const ProjectionReport report = project(body, {}, {});
    EXPECT_EQ(report.violated_links, broken);
    EXPECT_EQ(check_links(body).violated, 0);
  }
  EXPECT_GT(only_diagonals, 5000);
}

TEST(UnitLinks, TighteningKeepsTheLimitsOfDiagonals) {
  std::vector<Region> fixed;
  Holds holds;
  Body body = pulled_bar(fixed, holds);
  const TightenReport report = tighten(body, fixed, holds);
  EXPECT_EQ(report.projected_links, 0);
  EXPECT_GT(report.moved, 0);
  EXPECT_LT(report.excess_voxels, report.excess_before_voxels);
  EXPECT_EQ(check_links(body).violated, 0);
}

// Relaxation that conserves volume: exact volumes, valid and downhill after every pass, and to the
// right place.
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "lib/body/slot_set.h"
#include "lib/chainmail/ecm.h"
#include "lib/relax/cell_moduli.h"
#include "tests/lib/relaxed_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr RelaxMethod kMethods[] = {RelaxMethod::red_black, RelaxMethod::accelerated};

/// Parameters with that modulus; none: those that follow from the material.
RelaxParams with_bulk_modulus(std::optional<double> kpa, int passes = 20) {
  RelaxParams params;
  params.bulk_modulus_kpa = kpa.value_or(0);
  params.poisson = !kpa;
  params.passes = passes;
  return params;
}

Hexahedron random_corners(std::mt19937& random, double by) {
  std::uniform_real_distribution<double> way(-by, by);
  Hexahedron corners;
  for (int n = 0; n < 8; ++n) {
    for (int c = 0; c < 3; ++c) corners[std::size_t(n)][c] = (n >> (2 - c) & 1) + way(random);
  }
  return corners;
}

/// A ball that just fits into that many voxels.
Body soft_ball(int diameter) {
  Block block = homogeneous({diameter, diameter, diameter}, 3, 0.2, 2);
  for (int n = 0; n < block.size(); ++n) {
    double square = 0;
    for (int c = 0; c < 3; ++c) {
      const double from_middle = block.voxel(n)[c] - (diameter - 1) / 2.0;
      square += from_middle * from_middle;
    }
    block.element[std::size_t(n)] = square <= diameter * diameter / 4.0;
  }
  return body_of(block);
}

/// Two plates without friction push that many layers at both ends along k together, by so much of
/// the height between them in all.
Holds press(Body& body, double part, int layers = 1) {
  const IndexBox& box = body.elements.active_bounds();
  const int low_z = box.lo.z + layers - 1, high_z = box.hi.z - layers + 1;
  const auto by = std::int32_t(part / 2 * (high_z - low_z) * kVoxel);
  const Region low(box.lo, {box.hi.x, box.hi.y, low_z});
  const Region high({box.lo.x, box.lo.y, high_z}, box.hi);
  Holds holds;
  drag(body, {{low, {0, 0, by}, HandleKind::push}, {high, {0, 0, -by}, HandleKind::push}}, {},
       holds);
  return holds;
}

double largest_offset(const Body& body) {
  double largest = 0;
  for (const BrickValues& q : body.q) {
    for_each_element(body.elements, [&](Slot slot) {
      largest = std::max(largest, std::abs(q.at(slot) / kFixedOne));
    });
  }
  return largest;
}

double total_energy(const Body& body, std::optional<double> kpa) {
  return spring_energy(body) + cell_energy(body, kpa);
}

/// Moves an element, or those of its rigid part, by 1/1024 voxel both ways: how much less energy
/// there is, and how much more.
std::pair<double, double> energy_beside(Body& body, const std::vector<Slot>& slots, std::size_t c,
                                        std::optional<double> kpa) {
  const double energy = total_energy(body, kpa);
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const int by : {64, -128, 64}) {
    for (const Slot slot : slots) body.q[c].set(slot, body.q[c].at(slot) + by);
    if (by == 64 && most != -HUGE_VAL) break;
    least = std::min(least, total_energy(body, kpa) - energy);
    most = std::max(most, total_energy(body, kpa) - energy);
  }
  return {least, most};
}

/// A pull relaxed to its end, where no element has less energy beside its place.
void expect_least_energy(const Block& block, std::optional<double> kpa) {
  Body body = body_of(block);
  const Region near({4, 5, 6}, {4, 10, 10}), far({12, 5, 6}, {12, 10, 10});
  Holds holds;
  drag(body, {{far, {3 * kVoxel, kVoxel, 0}}}, {near}, holds);
  RelaxParams params = with_bulk_modulus(kpa, 4000);
  params.tolerance_voxels = 1e-9;
  const RelaxReport report = relax(body, {near}, holds, params);
  EXPECT_TRUE(report.converged);
  EXPECT_NEAR(report.energy_after, total_energy(body, kpa), 1e-6 * report.energy_after);
  EXPECT_NE(body.offset({8, 5, 6}, 2), 0);
  std::mt19937 random(9);
  for (int n = 0; n < 40; ++n) {
    const Vec3i voxel(5 + int(random() % 7), 5 + int(random() % 6), 6 + int(random() % 5));
    Slot slot;
    ASSERT_TRUE(slot_of(body.elements, voxel, slot));
    const auto [least, most] = energy_beside(body, {slot}, random() % 3, kpa);
    EXPECT_GT(least, 0);
    EXPECT_LT(most, 1.3 * least);  // both ways alike
  }
}

}  // namespace

TEST(UnitCellVolume, IsTheIntegralOfTheJacobian) {
  std::mt19937 random(1);
  for (int n = 0; n < 100; ++n) {
    const Hexahedron corners = random_corners(random, n < 50 ? 0.3 : 2);
    EXPECT_NEAR(hexahedron_volume(corners), integrated_volume(corners), 1e-12);
  }
}

TEST(UnitCellVolume, IsLinearInEachCornerWithTheGradientAsSlope) {
  std::mt19937 random(2);
  for (int n = 0; n < cases(50); ++n) {
    const Hexahedron corners = random_corners(random, 0.5);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d gradient = hexahedron_gradient(corners, corner);
      for (int c = 0; c < 3; ++c) {
        for (const double by : {-2.0, 0.5}) {
          Hexahedron moved = corners;
          moved[std::size_t(corner)][c] += by;
          EXPECT_NEAR(integrated_volume(moved) - integrated_volume(corners), gradient[c] * by,
                      1e-12);
        }
      }
    }
  }
}

TEST(UnitCellVolume, OfABodyCountsTheCellsThatNoCutOpens) {
  Block block = homogeneous({5, 4, 3}, 3, 0.2, 2);
  block.origin = {6, -2, 7};  // across bricks
  block.spacing_mm = {0.5, 2, 3};
  EXPECT_EQ(cell_volumes(body_of(block)).cells, 4 * 3 * 2);
  EXPECT_DOUBLE_EQ(cell_volumes(body_of(block)).total_mm3, 4 * 3 * 2 * 3);
  // A link inside takes its four cells away, one on an edge only one.
  block.cut.assign(std::size_t(block.size()), 0);
  block.cut[std::size_t(block.index(1, 1, 1))] = 1;
  block.cut[std::size_t(block.index(4, 3, 0))] = 4;
  Body body = body_of(block);
  EXPECT_EQ(cell_volumes(body).cells, 24 - 4 - 1);
  // The last layer along i goes out by half a voxel: its cells, of which one has a cut, grow by
  // half.
  drag(body, {{Region({10, -2, 7}, {10, 1, 9}), {kVoxel / 2, 0, 0}}}, {});
  const CellVolumes volumes = cell_volumes(body);
  EXPECT_DOUBLE_EQ(volumes.rest_mm3, 19 * 3);
  EXPECT_DOUBLE_EQ(volumes.total_mm3, (19 + 5 * 0.5) * 3);
  EXPECT_DOUBLE_EQ(volumes.largest, 1.5);
  EXPECT_DOUBLE_EQ(volumes.smallest, 1);
}

TEST(PropertyVolumeRelaxation, EveryPassLeavesAValidBodyOfNoMoreEnergy) {
  std::mt19937 random(3);
  int moved = 0;
  for (int n = 0; n < cases(50); ++n) {
    Dragged start = dragged(random, {13, 11, 9});
    if (n % 4 == 0) start.body.material.yield_strain = Curve{{{0, 0.1}}};
    std::optional<double> kpa;
    if (n % 4 != 3) kpa = n % 3 == 0 ? 0.5 : n % 3 == 1 ? 30 : 1000;
    start.body.material.poisson = Curve{{{0, 0.1}, {255, 0.495}}};
    const Dragged before = start;
    const double first = total_energy(start.body, kpa);
    for (const RelaxMethod method : kMethods) {
      start = before;
      RelaxParams params = with_bulk_modulus(kpa);
      params.method = method;
      Relaxation relaxation = relaxation_of(start, params);
      ASSERT_NEAR(relaxation.energy(), first, 1e-6 * first + 1e-12);  // stiffness is a float
      double energy = HUGE_VAL;
      for (int pass = 0; pass < 12; ++pass) {
        moved += relaxation.pass() > 0;
        ASSERT_LE(relaxation.energy_before_pass(), energy * (1 + 1e-12)) << name_of(method);
        energy = relaxation.energy_before_pass();
        relaxation.store();
        ASSERT_EQ(check_links(start.body).violated, 0) << name_of(method) << " pass " << pass;
      }
      EXPECT_NEAR(relaxation.energy(), total_energy(start.body, kpa), 1e-3 * first + 1e-9);
    }
  }
  EXPECT_GT(moved, cases(800));
}

TEST(PropertyVolumeRelaxation, WhatIsHeldStays) {
  std::mt19937 random(5);
  int at_bound = 0;
  for (int n = 0; n < 40; ++n) {
    at_bound += expect_held_through(dragged(random, {9, 9, 7}), with_bulk_modulus(50, 15));
  }
  EXPECT_GT(at_bound, 5);
}

TEST(PropertyVolumeRelaxation, TheResultDoesNotDependOnTheNumberOfThreads) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(7);
  for (int n = 0; n < 4; ++n) {
    Dragged body = dragged(random, {30, 28, 26});
    body.body.material.poisson = Curve{{{0, 0.1}, {255, 0.495}}};
    expect_same_on_any_threads(body, with_bulk_modulus(100));
    expect_same_on_any_threads(body, with_bulk_modulus({}));
  }
}

TEST(PropertyVolumeRelaxation, ItEndsWhereTheEnergyIsLeast) {
  LEFT_OUT_WHEN_SANITIZED();
  // Across bricks, with anisotropic spacing and two stiffnesses.
  Block block = homogeneous({9, 6, 5}, 3, 0.2, 2);
  block.origin = {4, 5, 6};
  block.spacing_mm = {0.7, 1.1, 1.6};
  block.table.stiffness = Curve{{{0, 1}, {9, 1}, {10, 4}}};
  for (int n = 0; n < block.size(); ++n) {
    if (block.voxel(n).y > 7) block.density[std::size_t(n)] = 10;
  }
  block.table.poisson = Curve{{{0, 0.45}, {9, 0.45}, {10, 0.2}}};
  expect_least_energy(block, 20);
  expect_least_energy(block, {});
}

TEST(PropertyVolumeRelaxation, CellsHaveTheHarmonicMeanOfTheModuliOutsideOfPieces) {
  std::mt19937 random(13);
  int cells_of_pieces = 0;
  for (int n = 0; n < 20; ++n) {
    Body body = dragged(random, {13, 18, 9}).body;
    body.material.stiffness = Curve{{{0, 1}, {255, 50}}};
    body.material.poisson = Curve{{{0, 0.1}, {255, 0.495}}};
    BrickValues numbers(body.elements.brick_count());
    for_each_element(body.elements, [&](Slot slot) {
      if (n % 2 == 0 && random() % 3 == 0) numbers.set(slot, 1);
    });
    if (n % 2 == 0) body.rigid.number_of = std::make_shared<const BrickValues>(numbers);
    const CellModuli moduli = moduli_by_poisson(body);
    const MaterialClasses classes(body.material);
    const BrickArray<double> at_rest(body.elements.brick_count());
    for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
      const BricksAround around = bricks_around(body.elements, b);
      CellBrick brick;
      fill_cells({at_rest, at_rest, at_rest}, around, find_cells(body, around), brick);
      find_shares(body, moduli, around, brick);
      for_each_cell(find_cells(body, around), [&](const Vec3i& low) {
        double compliance = 0;
        int count = 0;
        for (int corner = 0; corner < 8; ++corner) {
          const Slot slot = slot_around(around, low.x + (corner >> 2), low.y + (corner >> 1 & 1),
                                        low.z + (corner & 1));
          if (body.rigid.at(slot) >= 0) continue;
          const int of = body.classes[slot];
          compliance +=
              (1 - 2 * classes.poisson_of_class(of)) / classes.physics(of, of).stiffness_kpa;
          ++count;
        }
        cells_of_pieces += count < 8;
        const double root =
            brick.root_share[CellBrick::cell_row(low.x, low.y) + CellBrick::place(low.z)];
        const double kpa = count > 0 ? count / compliance : moduli.kpa;
        EXPECT_NEAR(moduli.kpa * root * root, kpa, 1e-9 * kpa);
      });
    }
  }
  EXPECT_GT(cells_of_pieces, 100);
}

TEST(PropertyVolumeRelaxation, ARigidPartMovesAsOneToWhereTheEnergyIsLeast) {
  // A rigid bar in soft tissue that is pressed beside it.
  MaterialTable table = constant_table(3, 0.2, 2);
  table.max_length.keys = {{0, 1}, {1, 1}, {9, 3}};
  table.min_length.keys = {{0, 1}, {1, 1}, {9, 0.2}};
  table.shear1.keys = table.shear2.keys = {{0, 0}, {1, 0}, {9, 2}};
  const auto is_bar = [](const Vec3i& v) {
    return v.x >= 5 && v.x <= 7 && v.y >= 6 && v.y <= 9 && v.z == 3;
  };
  Block block = full_block({14, 12, 8}, table, [&](int i, int j, int k) {
    return is_bar({i, j, k}) ? 0.0 : 9.0;
  });
  block.table.active_lo = 0;
  block.table.poisson = Curve{{{0, 0.3}, {1, 0.3}, {9, 0.48}}};
  for (const std::optional<double> kpa : {std::optional<double>(20), std::optional<double>()}) {
    Body body = body_of(block);
    const Region base({0, 0, 0}, {13, 0, 7});
    Holds holds;
    drag(body, {{Region({9, 11, 2}, {11, 11, 5}), {0, -2 * kVoxel, 0}}}, {base}, holds);
    RelaxParams params = with_bulk_modulus(kpa, 4000);
    params.tolerance_voxels = 1e-9;
    EXPECT_TRUE(relax(body, {base}, holds, params).converged);
    std::vector<Slot> bar;
    for (int n = 0; n < block.size(); ++n) {
      Slot slot;
      if (is_bar(block.voxel(n)) && slot_of(body.elements, block.voxel(n), slot))
        bar.push_back(slot);
    }
    ASSERT_EQ(bar.size(), 12u);
    for (std::size_t c = 0; c < 3; ++c) {
      for (const Slot slot : bar) EXPECT_EQ(body.q[c].at(slot), body.q[c].at(bar[0]));
      EXPECT_GT(std::abs(body.q[c].at(bar[0])), 100);
      const auto [least, most] = energy_beside(body, bar, c, kpa);
      EXPECT_GT(least, 0);
      EXPECT_LT(most, 1.3 * least);
    }
  }
}

TEST(ConvergenceVolumeRelaxation, ABlockThatIsPressedKeepsItsVolumeOnlyWithConservation) {
  const Body rest = body_of(homogeneous({9, 9, 11}, 3, 0.2, 2));
  Body off = rest, on = rest;
  // Nothing couples the coordinates without it: nothing moves sideways, and the volume lost is the
  // strain, 30 % everywhere.
  RelaxParams params = with_bulk_modulus(0, 1000);
  params.tolerance_voxels = 1e-6;
  EXPECT_TRUE(relax(off, {}, press(off, 0.3), params).converged);
  EXPECT_TRUE(off.q[0].empty() && off.q[1].empty());
  EXPECT_NEAR(cell_volumes(off).ratio(), 0.7, 1e-4);
  const RelaxReport report = relax(on, {}, press(on, 0.3), with_bulk_modulus(100, 500));
  EXPECT_NEAR(report.volumes_before->ratio(), 0.7, 0.1);
  EXPECT_NEAR(report.volumes_after->ratio(), 1, 0.01);
  // Free of friction, the block widens alike on both axes, everywhere but near its surface.
  const double wider = (on.offset({8, 4, 5}, 0) - on.offset({0, 4, 5}, 0)) / kFixedOne / 8;
  EXPECT_NEAR(wider, std::sqrt(report.volumes_after->ratio() / 0.7) - 1, 0.02);
}

TEST(ConvergenceVolumeRelaxation, ABallThatIsPressedKeepsItsVolumeOnlyWithConservation) {
  LEFT_OUT_WHEN_SANITIZED();
  const Body rest = soft_ball(24);
  Body off = rest, on = rest;
  relax(off, {}, press(off, 0.3, 2), with_bulk_modulus(0, 300));
  EXPECT_TRUE(off.q[0].empty() && off.q[1].empty());
  // A cell between upright links loses the mean of what its four lose: so does the body, a link
  // counting a quarter for each of its cells.
  double lost = 0;
  std::int64_t cells = 0;
  for (std::size_t b = 0; b < rest.elements.brick_count(); ++b) {
    for_each_link(rest.elements, rest.cuts, b, [&](int axis, Slot low, Slot high) {
      if (axis != 2) return;
      const Vec3i voxel = voxel_of(rest.elements, low);
      for (const int i : {-1, 0}) {
        for (const int j : {-1, 0}) {
          bool is_cell = true;
          for (int n = 0; n < 8; ++n) {
            is_cell = is_cell &&
                      rest.elements.is_active(voxel + Vec3i(i + (n >> 2), j + (n >> 1 & 1), n & 1));
          }
          lost += is_cell * (off.q[2].at(low) - off.q[2].at(high)) / kFixedOne / 4;
          cells += is_cell && i == 0 && j == 0;
        }
      }
    });
  }
  const CellVolumes without = cell_volumes(off);
  EXPECT_EQ(without.cells, cells);
  EXPECT_NEAR(without.rest_mm3 - without.total_mm3, lost, 1e-6 * lost);
  EXPECT_LT(without.ratio(), 0.85);

  const RelaxReport report = relax(on, {}, press(on, 0.3, 2), with_bulk_modulus(100, 300));
  EXPECT_NEAR(report.volumes_after->ratio(), 1, 0.01);
  EXPECT_LT(report.energy_after, report.energy_before);
  EXPECT_EQ(check_links(on).violated, 0);
}

TEST(ConvergenceVolumeRelaxation, LetGoABodyReturnsToItsShape) {
  LEFT_OUT_WHEN_SANITIZED();
  Body body = soft_ball(12);
  RelaxParams params = with_bulk_modulus(20, 30);
  relax(body, {}, press(body, 0.3), params);
  EXPECT_GT(largest_offset(body), 1);
  params.passes = 6000;
  params.tolerance_voxels = 1e-7;
  const RelaxReport report = relax(body, {Region({6, 6, 6})}, {}, params);
  EXPECT_TRUE(report.converged);
  // All elements have gone as far as the one that is held.
  for (std::size_t c = 0; c < 3; ++c) {
    const double held = body.offset({6, 6, 6}, int(c)) / kFixedOne;
    for_each_element(body.elements,
                     [&](Slot slot) { EXPECT_NEAR(body.q[c].at(slot) / kFixedOne, held, 1e-3); });
  }
}

TEST(PropertyVolumeRelaxation, OnlyBricksThatItReachesHaveMemory) {
  Body body = body_of(homogeneous({400, 3, 3}, 3, 0.2, 2));
  Holds holds;
  drag(body, {{{399, 1, 1}, {kVoxel, 0, 0}}}, {}, holds);
  EXPECT_EQ(body.q[0].stored_bricks(), 1u);
  EXPECT_TRUE(body.q[1].empty());
  relax(body, {}, holds, with_bulk_modulus(10, 2));
  EXPECT_LE(body.q[0].stored_bricks(), 4u);
  EXPECT_LE(body.q[1].stored_bricks(), 4u);
  EXPECT_FALSE(body.q[1].empty());
}

TEST(PropertyVolumeRelaxation, ABodyAtRestStaysThere) {
  Body body = soft_ball(9);
  const RelaxReport report = relax(body, {}, {}, with_bulk_modulus(100));
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.energy_after, 0);
  for (const BrickValues& q : body.q) EXPECT_TRUE(q.empty());
}

TEST(PropertyVolumeRelaxation, WithoutItNothingIsMeasured) {
  Body body = soft_ball(9);
  const RelaxReport report = relax(body, {}, press(body, 0.2), with_bulk_modulus(0));
  EXPECT_FALSE(report.volumes_before || report.volumes_after);
}

TEST(PropertyVolumeRelaxation, BadParametersAreErrors) {
  Body body = soft_ball(5);
  for (const double kpa : {-1.0, 2e9, double(NAN)}) {
    EXPECT_NE(
        input_error([&] { relax(body, {}, {}, with_bulk_modulus(kpa)); }).find("bulk_modulus"),
        std::string::npos)
        << kpa;
  }
  RelaxParams params = with_bulk_modulus(1);
  params.method = RelaxMethod::jacobi;
  EXPECT_NE(input_error([&] { relax(body, {}, {}, params); }).find("method jacobi"),
            std::string::npos);
}

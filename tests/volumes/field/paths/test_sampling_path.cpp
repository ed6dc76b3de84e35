// Laws of procedural sampling paths (thesis sections 3.3.1 and 3.3.5).
#include <map>

#include <gtest/gtest.h>

#include "tests/support/field_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/field/paths/path_functions.h"
#include "volumes/field/procedural.h"
#include "volumes/field/split_offsets.h"

namespace supple::test {
namespace {

using Function = std::shared_ptr<const PathFunction>;

/// 24^3 voxels, oblique, left-handed and unequal along the axes; the centre is at (5, -3, 8) mm.
Geometry oblique_cube() {
  const std::array<Vec3d, 3> axes = {Vec3d(1.1, 0.2, 0), {0.1, -0.9, 0.1}, {0, 0.1, 1.4}};
  const Vec3d half = (axes[0] + axes[1] + axes[2]) * 11.5;
  return {{24, 24, 24}, Vec3d(5, -3, 8) - half, axes};
}

const Vec3d kCentre(5, -3, 8);
const AxisRange kRange{kCentre, {0.3, -0.2, 1}, -6, 9};

Function bend(double angle = 50, double end_mm = 30) {
  AxisRange range = kRange;
  range.end_mm = end_mm;
  return make_bend({range, {1, 0.5, 0}, angle});
}
Function twist() {
  return make_twist({kRange, 70});
}
Function taper() {
  return make_taper({kRange, 0.4});
}
Function slide(double gap = 5) {
  return make_cut_open({kCentre, {1, 0.3, -0.2}, gap});
}
Function swing() {
  return make_cut_open({kCentre, {1, 0, 0}, 0, 40, kCentre + Vec3d(3, 15, 0), {0, 0, 1}});
}
Function explode(const Geometry& geometry) {
  return make_explode({{2, 3, 2}, Vec3d(-0.5), Vec3d(23.5), 4}, geometry);
}
LatticeParams lattice_params() {
  LatticeParams params{{4, 3, 5}, {2, 3, 1}, {20, 21, 22}, {}};
  params.moves = {
      {"", {1, 1, 2}, {6, -5, 8}}, {"", {3, 2, 4}, {1, 2, -2}}, {"", {0, 0, 0}, {2, 0, 1}}};
  return params;
}

struct NamedFunction {
  std::string name;
  Function function;
};

std::vector<NamedFunction> all_functions(const Geometry& geometry) {
  return {{"bend", bend()},
          {"bend with a straight end", bend(30, 4)},
          {"bend back", bend(-120, 70)},
          {"twist", twist()},
          {"taper", taper()},
          {"slide", slide()},
          {"swing", swing()},
          {"explode", explode(geometry)},
          {"lattice", make_lattice(lattice_params(), geometry)}};
}

BrickTopology body_of(const Geometry& geometry) {
  return topology_where(Vec3i(0), geometry.dims() - Vec3i(1),
                        [](const Vec3i& v) { return (Vec3d(v) - Vec3d(11.5)).length() < 9; });
}

Vec3d place_near_centre(std::mt19937& random) {
  const Vec3f v = random_vector(random, 9);
  return kCentre + Vec3d(v);
}

/// Index space; voxels are hit exactly.
Vec3d snapped(Vec3d x) {
  for (int a = 0; a < 3; ++a) {
    if (std::abs(x[a] - std::round(x[a])) < 1e-9) x[a] = std::round(x[a]);
  }
  return x;
}

int piece_of(const PathFunction& function, const Vec3d& from) {
  int piece = 0;
  while (function.depth_mm(from, piece) < 0) ++piece;
  return piece;
}

TEST(PropertyPath, WhatAFunctionMovesItsInverseBringsBack) {
  const Geometry geometry = oblique_cube();
  std::mt19937 random(3);
  for (const NamedFunction& named : all_functions(geometry)) {
    const std::string& name = named.name;
    const Function& function = named.function;
    double moved = 0;
    for (int n = 0; n < 500; ++n) {
      const Vec3d from = place_near_centre(random);
      const int piece = piece_of(*function, from);
      const Vec3d now = function->forward(from, piece);
      moved = std::max(moved, (now - from).length());
      EXPECT_LT((function->backward(now, piece) - from).length(), 1e-7) << name;
    }
    EXPECT_GT(moved, 0.9) << name;
  }
}

TEST(PropertyPath, OffsetsLeadFromWhereTheBodyIsSeenToWhereItWas) {
  const Geometry geometry = oblique_cube();
  const BrickTopology body = body_of(geometry);
  for (const NamedFunction& named : all_functions(geometry)) {
    const std::string& name = named.name;
    const Function& function = named.function;
    const OffsetField field = follow_path({function}, geometry, body);
    // Every voxel of the body is seen once, at its place.
    int count = 0;
    double worst = 0;
    for_each_slot(body, [&](const Vec3i& voxel, std::size_t) {
      const Vec3d from = geometry.world_from_index(Vec3d(voxel));
      const int piece = piece_of(*function, from);
      if (function->depth_mm(from, piece) < 1e-6) return;
      const Vec3d x = snapped(geometry.index_from_world(function->forward(from, piece)));
      Vec3d offset;
      ASSERT_TRUE(field.sample(x, offset)) << name;
      worst = std::max(worst, (x + offset - Vec3d(voxel)).length());
      ++count;
    });
    EXPECT_GT(count, 2500) << name;
    // Pieces are rigid, the rest is trilinear but for the ends of ranges, where slopes jump.
    const bool is_rigid = function->pieces() > 1;
    EXPECT_LT(worst, is_rigid ? 1e-5 : 0.25) << name;
  }
}

TEST(PropertyPath, NodesHoldTheExactPath) {
  const Geometry geometry = oblique_cube();
  const BrickTopology body = body_of(geometry);
  for (const NamedFunction& named : all_functions(geometry)) {
    const std::string& name = named.name;
    const Function& function = named.function;
    const OffsetField field = follow_path({function}, geometry, body);
    for_each_slot(field.o.topology, [&](const Vec3i& node, std::size_t slot) {
      const Vec3d at = geometry.world_from_index(Vec3d(node));
      double nearest = HUGE_VAL;
      for (int piece = 0; piece < function->pieces(); ++piece) {
        const Vec3d o = geometry.index_vector_from_world(function->backward(at, piece) - at);
        nearest = std::min(nearest, (o - Vec3d(field.o.vectors.at(slot))).length());
      }
      EXPECT_LT(nearest, 1e-5) << name;
    });
    EXPECT_GT(field.o.topology.active_count(), 1000) << name;
  }
}

TEST(PropertyPath, FunctionsOneAfterAnotherAreOneFunctionOfTheOther) {
  const Geometry geometry = oblique_cube();
  const SamplingPath path = {swing(), twist(), bend()};
  const OffsetField field = follow_path(path, geometry, body_of(geometry));
  ASSERT_NE(field.split, nullptr);
  std::mt19937 random(5);
  int seen = 0;
  double worst = 0, sum = 0;
  for (int n = 0; n < 400; ++n) {
    const Vec3d from = place_near_centre(random);
    Vec3d now = from;
    for (const Function& function : path) now = function->forward(now, piece_of(*function, now));
    const Vec3d x = geometry.index_from_world(now);
    Vec3d offset;
    if (!field.sample(x, offset)) continue;
    ++seen;
    const double error = (x + offset - geometry.index_from_world(from)).length();
    worst = std::max(worst, error);
    sum += error;
  }
  EXPECT_GT(seen, 200);
  EXPECT_LT(worst, 0.4);
  EXPECT_LT(sum / seen, 0.02);
}

TEST(PropertyPath, ABodyThatHasMovedIsFollowedFromWhereThePathLeads) {
  const Geometry geometry = oblique_cube();
  const AnalyticWarp bump = bump_warp({11.5, 11.5, 11.5}, 10, 3);
  const OffsetField moved = sample_offsets(bump, geometry, dilate(body_of(geometry), 3));
  for (const NamedFunction& named : all_functions(geometry)) {
    const std::string& name = named.name;
    const Function& function = named.function;
    const OffsetField field = follow_path({function}, moved);
    double worst = 0;
    int count = 0;
    for_each_slot(body_of(geometry), [&](const Vec3i& voxel, std::size_t) {
      const Vec3d between = Vec3d(voxel) + bump.displacement_voxels(Vec3d(voxel));
      const Vec3d between_mm = geometry.world_from_index(between);
      const int piece = piece_of(*function, between_mm);
      const Vec3d x = geometry.index_from_world(function->forward(between_mm, piece));
      Vec3d offset;
      if (!field.sample(x, offset)) return;
      worst = std::max(worst, (x + offset - Vec3d(voxel)).length());
      ++count;
    });
    EXPECT_GT(count, 2500) << name;
    EXPECT_LT(worst, 0.3) << name;
  }
}

TEST(PropertyPath, WhereAPathIsStraightTheMovedBodyKeepsItsOffsetsExactly) {
  const Geometry geometry = unit_geometry({24, 24, 24});
  const OffsetField moved =
      sample_offsets(bump_warp({11.5, 11.5, 11.5}, 10, 3), geometry, body_of(geometry));
  const Function far = make_twist({{{0, 0, 0}, {0, 0, 1}, 100, 200}, 90});
  const OffsetField field = follow_path({far}, moved);
  EXPECT_TRUE(field.o.topology == moved.o.topology);
  EXPECT_EQ(to_map(field.o), to_map(moved.o));
  const OffsetField rest = follow_path({far}, geometry, body_of(geometry));
  EXPECT_TRUE(rest.o.topology == body_of(geometry));
  for (const Vec3f& o : rest.o.vectors.all()) EXPECT_EQ(o, Vec3f(0));
}

TEST(PropertyPath, AnExplodedBoxKeepsEveryVoxelOnceAndLeavesItsGapsEmpty) {
  const Geometry geometry = unit_geometry({16, 16, 16});
  const BrickTopology box = box_topology(Vec3i(0), Vec3i(15));
  const Function function = make_explode({{2, 4, 1}, Vec3d(-0.5), Vec3d(15.5), 4}, geometry);
  const OffsetField field = follow_path({function}, geometry, box);
  VoxelField read;
  int count = 0, in_gaps = 0;
  for (int x = -8; x < 24; ++x) {
    for (int y = -12; y < 28; ++y) {
      for (int z = -2; z < 18; ++z) {
        const bool in_gap = (x > 5 && x < 10) || ((y + 6) % 8 >= 4 && y > -2 && y < 18);
        Vec3d offset;
        if (!field.sample(Vec3d(x, y, z), offset)) continue;
        in_gaps += in_gap;
        const Vec3d from = Vec3d(x, y, z) + offset;
        const Vec3i voxel(int(std::lround(from.x)), int(std::lround(from.y)),
                          int(std::lround(from.z)));
        if (!box.is_active(voxel)) continue;
        EXPECT_LT((Vec3d(voxel) - from).length(), 1e-6);
        EXPECT_TRUE(read.emplace(key(voxel), Vec3f(0)).second) << "read twice";
        ++count;
      }
    }
  }
  EXPECT_EQ(count, 16 * 16 * 16);
  EXPECT_EQ(in_gaps, 0);
}

TEST(PropertyPath, FacesOfPiecesAreSharpWhereverTheyAreCut) {
  // Along a line across the gap nothing is found in it and everything just beside it.
  const Geometry geometry = unit_geometry({24, 24, 24});
  const Vec3d normal = Vec3d(1, 0.3, -0.2).normalized(), point(11.3, 11.6, 11.9);
  for (const double gap : {0.3, 2.0, 7.5}) {
    const Function function = make_cut_open({point, normal, gap});
    const OffsetField field = follow_path({function}, geometry, body_of(geometry));
    const Vec3d across = normal.cross(Vec3d(0, 0, 1)).normalized();
    for (double along = -4; along < 4; along += 0.37) {
      const Vec3d base = point + across * along;
      for (const double side : {-1.0, 1.0}) {
        Vec3d offset;
        EXPECT_FALSE(field.sample(base + normal * (side * (gap / 2 - 1e-4)), offset));
        ASSERT_TRUE(field.sample(base + normal * (side * (gap / 2 + 1e-4)), offset));
        EXPECT_LT((offset + normal * (side * gap / 2)).length(), 1e-6);
      }
    }
  }
}

TEST(PropertyPath, SplitBricksKnowTheFaceAndTheGradientOfEachPiece) {
  const Geometry geometry = oblique_cube();
  const SamplingPath path = {slide(), twist()};
  const OffsetField field = follow_path(path, geometry, body_of(geometry));
  const SplitOffsets& split = *field.split;
  const Vec3d x = geometry.index_from_world(kCentre + Vec3d(4, 1, 1));
  const double h = 1e-3;
  for (int piece = 0; piece < 2; ++piece) {
    const Vec3d g(0.3, -0.7, 0.2), normal = split.face_normal(piece, x);
    for (int a = 0; a < 3; ++a) {
      Vec3d step(0), above, below;
      step[a] = h;
      ASSERT_TRUE(split.offset_of(piece, x + step, above) &&
                  split.offset_of(piece, x - step, below));
      EXPECT_NEAR(split.pull_back(piece, x, x, g)[a], g[a] + (above - below).dot(g) / (2 * h),
                  1e-4);
      EXPECT_NEAR(split.depth_mm(piece, x + step) - split.depth_mm(piece, x), normal[a] * h, 1e-6);
    }
  }
}

TEST(PropertyPath, MaterialMovesAgainstItsSamplingPath) {
  const Geometry geometry = oblique_cube();
  const AnalyticWarp bump = bump_warp({11.5, 11.5, 11.5}, 10, 2);
  const Displacement start = sample_displacement(bump, geometry, body_of(geometry));
  const OffsetField moved = sample_offsets(bump, geometry, dilate(body_of(geometry), 3));
  for (const SamplingPath& path : {SamplingPath{twist(), bend()}, SamplingPath{swing()}}) {
    const Displacement now = move_along(path, start);
    const OffsetField field = follow_path(path, moved);
    int count = 0;
    for_each_slot(now.u.topology, [&](const Vec3i& voxel, std::size_t slot) {
      const Vec3d x = Vec3d(voxel) + Vec3d(now.u.vectors.at(slot));
      Vec3d offset;
      if (!field.sample(x, offset)) return;
      EXPECT_LT((x + offset - Vec3d(voxel)).length(), 0.25);
      ++count;
    });
    EXPECT_GT(count, 2500);
  }
}

TEST(UnitPath, ABendOfAQuarterPutsTheFarEndAcross) {
  // An arc of 20 mm over a quarter of a turn: radius 12.732, then 5 mm straight on.
  const Function function = make_bend({{{0, 0, 0}, {0, 0, 1}, 0, 20}, {0, 1, 0}, 90});
  const double r = 40 / M_PI;
  EXPECT_LT((function->forward({3, 0, 25}, 0) - Vec3d(3, r + 5, r)).length(), 1e-12);
  EXPECT_LT((function->forward({0, 2, 20}, 0) - Vec3d(0, r, r - 2)).length(), 1e-12);
  EXPECT_EQ(function->forward({1, 2, -3}, 0), Vec3d(1, 2, -3));
}

TEST(UnitPath, ABendOfMoreThanAQuarterComesBackBesideWhatStays) {
  const Function function = make_bend({{{0, 0, 0}, {0, 0, 1}, 0, 40}, {0, 1, 0}, 180});
  const double r = 40 / M_PI;
  EXPECT_LT((function->forward({1, 2, 50}, 0) - Vec3d(1, 2 * r - 2, -10)).length(), 1e-12);
  for (const Vec3d& from : {Vec3d(1, 2, 50), Vec3d(0, -3, 30), Vec3d(0, 3, -7), Vec3d(2, 0, 41)}) {
    EXPECT_LT((function->backward(function->forward(from, 0), 0) - from).length(), 1e-12);
  }
}

TEST(UnitPath, ATwistTurnsByItsWholeAngleAtTheEndOfTheRange) {
  const Function function = make_twist({{{1, 1, 0}, {0, 0, 2}, 10, 20}, 90});
  EXPECT_LT((function->forward({2, 1, 25}, 0) - Vec3d(1, 2, 25)).length(), 1e-12);
  const double half = std::sqrt(0.5);
  EXPECT_LT((function->forward({2, 1, 15}, 0) - Vec3d(1 + half, 1 + half, 15)).length(), 1e-12);
  EXPECT_EQ(function->backward({2, 1, 9}, 0), Vec3d(2, 1, 9));
}

TEST(UnitPath, AMovedCornerOfALatticeOfTwoMovesTheCentreByAnEighth) {
  const Geometry geometry = unit_geometry({11, 11, 11});
  LatticeParams params{{2, 2, 2}, Vec3d(0), Vec3d(10), {{"", {1, 1, 1}, {4, 0, 0}}}};
  const Function function = make_lattice(params, geometry);
  EXPECT_LT((function->forward(Vec3d(5), 0) - Vec3d(5.5, 5, 5)).length(), 1e-12);
  EXPECT_EQ(function->forward({-3, 5, 5}, 0), Vec3d(-3, 5, 5));
  EXPECT_LT((function->forward({15, 10, 10}, 0) - Vec3d(19, 10, 10)).length(), 1e-12);
}

TEST(UnitPath, ParametersThatMoveNothingGiveNoFunction) {
  const Geometry geometry = unit_geometry({8, 8, 8});
  EXPECT_EQ(make_bend({kRange, {1, 0, 0}, 0}), nullptr);
  EXPECT_EQ(make_twist({kRange, 0}), nullptr);
  EXPECT_EQ(make_taper({kRange, 1}), nullptr);
  EXPECT_EQ(slide(0), nullptr);
  EXPECT_EQ(make_explode({{2, 2, 2}, Vec3d(0), Vec3d(7), 0}, geometry), nullptr);
  EXPECT_EQ(make_lattice({{2, 2, 2}, Vec3d(0), Vec3d(7), {{"", {0, 0, 0}, {0, 0, 0}}}}, geometry),
            nullptr);
}

template <class Make>
std::string field_refused(const Make& make) {
  try {
    make();
  } catch (const InputError& error) {
    return error.problem().field;
  }
  return "nothing";
}

TEST(UnitPath, BadParametersAreNamed) {
  const double nan = std::nan("");
  const Geometry geometry = unit_geometry({8, 8, 8});
  const auto bent = [](const AxisRange& range, const Vec3d& towards, double angle) {
    return field_refused([&] { make_bend({range, towards, angle}); });
  };
  EXPECT_EQ(bent({{nan, 0, 0}, {0, 0, 1}, 0, 9}, {1, 0, 0}, 9), "point");
  EXPECT_EQ(bent({{0, 0, 0}, {0, 0, 0}, 0, 9}, {1, 0, 0}, 9), "axis");
  EXPECT_EQ(bent({{0, 0, 0}, {0, 0, 1}, 9, 9}, {1, 0, 0}, 9), "range");
  EXPECT_EQ(bent({{0, 0, 0}, {0, 0, 1}, 0, 9}, {0, 0, 2}, 9), "towards");
  EXPECT_EQ(bent({{0, 0, 0}, {0, 0, 1}, 0, 9}, {1, 0, 0}, 181), "angle");
  EXPECT_EQ(field_refused([&] { make_twist({kRange, nan}); }), "angle");
  EXPECT_EQ(field_refused([&] { make_taper({kRange, 0}); }), "factor");
  const auto cut = [](const CutOpenParams& params) {
    return field_refused([&] { make_cut_open(params); });
  };
  EXPECT_EQ(cut({{0, 0, 0}, {0, 0, 0}, 3}), "normal");
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, -3}), "gap");
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, 3, 3}), "gap");
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, 0, 30, {0, 0, 0}, {0, 0, 1}}), "hinge");
  EXPECT_EQ(cut({{0, 0, 0}, {1, 0, 0}, 0, 30, {0, 9, 0}, {1, 0, 0}}), "axis");
  const auto exploded = [&](const ExplodeParams& params) {
    return field_refused([&] { make_explode(params, geometry); });
  };
  EXPECT_EQ(exploded({{0, 2, 2}, Vec3d(0), Vec3d(7), 1}), "grid");
  EXPECT_EQ(exploded({{100, 100, 2}, Vec3d(0), Vec3d(7), 1}), "grid");
  EXPECT_EQ(exploded({{2, 2, 2}, Vec3d(0), {7, 7, 0}, 1}), "box");
  const auto lattice = [&](const LatticeParams& params) {
    return field_refused([&] { make_lattice(params, geometry); });
  };
  EXPECT_EQ(lattice({{1, 2, 2}, Vec3d(0), Vec3d(7), {}}), "lattice");
  EXPECT_EQ(lattice({{2, 2, 2}, Vec3d(0), Vec3d(7), {{"", {0, 0, 2}, {1, 0, 0}}}}), "move");
  EXPECT_EQ(lattice({{2, 2, 2}, Vec3d(0), Vec3d(7), {{"", {0, 0, 0}, {20, 0, 0}}}}), "move");
}

TEST(UnitPath, ABodyThatWouldBeTurnedInsideOutIsRefused) {
  const Geometry geometry = unit_geometry({24, 24, 24});
  const Function function = make_bend({{{12, 12, 0}, {0, 0, 1}, 10, 12}, {0, 1, 0}, 90});
  EXPECT_EQ(field_refused([&] { follow_path({function}, geometry, body_of(geometry)); }), "bend");
  const Function far = make_explode({{2, 1, 1}, Vec3d(-0.5), Vec3d(23.5), 1e5}, geometry);
  EXPECT_EQ(field_refused([&] {
              follow_path({far},
                          Geometry({24, 24, 24}, {0, 0, 0},
                                   {Vec3d(0.01, 0, 0), {0, 0.01, 0}, {0, 0, 0.01}}),
                          body_of(geometry));
            }),
            "offset");
}

}  // namespace
}  // namespace supple::test

// The block engine: threads, engines, bodies of many bricks, and domains split between solvers.
#include <algorithm>

#include <gtest/gtest.h>

#include "lib/chainmail/brick_kernel.h"
#include "lib/chainmail/ecm.h"
#include "lib/chainmail/reference/thesis_ecm.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Soft noise with rigid shells, holes and a rough surface, in a few hundred bricks.
Block shells(const Vec3i& dims, unsigned seed) {
  std::mt19937 random(seed);
  Block block = full_block(dims, linear_table(1.5, 0.6, 0.7), [&](int i, int j, int k) {
    const bool rigid = (i * i + j * j + 2 * k * k) / 300 % 4 == 0;
    return rigid ? 0.0 : double(random() % 256);
  });
  for (char& element : block.element) element = random() % 20 != 0;
  block.origin = {-3, 5, -11};
  return block;
}

/// The offsets after three drags of a body, by so many threads.
std::array<BrickValues, 3> dragged(const Body& rest, Engine engine, int threads,
                                   std::int64_t* visited = nullptr) {
  return on_threads(threads, [&] {
    Body body = rest;
    EcmSolver solver(body, engine);
    const IndexBox& box = rest.elements.active_bounds();
    const Vec3i middle = (box.lo + box.hi) / 2;
    Vec3i grabbed;
    nearest_element(rest, middle, grabbed);
    std::int64_t visits = 0;
    for (const int sign : {1, -1, 1}) {
      visits += solver.drag({{grabbed, {sign * 40 * kVoxel, -sign * 17 * kVoxel, 5}}}, {}).visited;
    }
    if (visited != nullptr) *visited = visits;
    return body.q;
  });
}

}  // namespace

TEST(PropertyBlockEngine, ResultAndVisitsDoNotDependOnTheNumberOfThreads) {
  LEFT_OUT_WHEN_SANITIZED();
  const Body body = body_of(shells({70, 60, 50}, 5));
  std::int64_t visits_of_one = 0;
  const auto expected = dragged(body, Engine::block, 1, &visits_of_one);
  for (const int threads : {2, 3, 8}) {
    std::int64_t visits = 0;
    const auto found = dragged(body, Engine::block, threads, &visits);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(found[c], expected[c]) << threads << " threads";
    EXPECT_EQ(visits, visits_of_one) << threads << " threads";
  }
}

TEST(PropertyBlockEngine, EqualsTheFlatEngineOnBodiesOfManyBricks) {
  LEFT_OUT_WHEN_SANITIZED();
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Body body = body_of(shells({45, 37, 50}, seed));
    const auto block = dragged(body, Engine::block, 2);
    const auto flat = dragged(body, Engine::flat, 1);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(block[c], flat[c]) << "axis " << c;
  }
}

TEST(PropertyBlockEngine, EqualsTheThesisAlgorithmOnBodiesOfManyBricks) {
  LEFT_OUT_WHEN_SANITIZED();
  const Block block = shells({33, 26, 30}, 9);
  Body body = body_of(block);
  const reference::ReferenceLattice lattice = reference::lattice_of(body);
  reference::ThesisEcm<std::int64_t> thesis(lattice, lattice.at_rest());
  EcmSolver solver(body, Engine::block);
  std::mt19937 random(4);
  for (int n = 0; n < 6; ++n) {
    const Vec3i voxel = block.voxel(random_element(random, block));
    const std::array<std::int32_t, 3> by{n % 2 ? -30 * kVoxel : 20 * kVoxel, n * kVoxel / 3, -7};
    solver.drag({{voxel, by}}, {});
    thesis.move(voxel - lattice.origin, by);
    const reference::Offsets mine = reference::offsets_of(body, lattice);
    const reference::Offsets expected = thesis.offsets();
    for (int c = 0; c < 3; ++c) ASSERT_EQ(mine[c], expected[c]) << "drag " << n << " axis " << c;
  }
}

TEST(PropertyBlockEngine, TheEngineIsChosenByHowFullTheBricksAre) {
  LEFT_OUT_WHEN_SANITIZED();
  const auto engine_of = [](const Vec3i& dims) {
    Body body = body_of(soft_block(dims));
    return EcmSolver(body).drag({{{0, 0, 0}, {kVoxel, 0, 0}}}, {}).engine;
  };
  EXPECT_EQ(engine_of({40, 40, 40}), Engine::block);
  EXPECT_EQ(engine_of({100, 100, 10}), Engine::block);
  EXPECT_EQ(engine_of({1, 1, 300}), Engine::flat);
}

TEST(PropertyBlockEngine, WithDiagonalsResultAndVisitsDependNeitherOnThreadsNorOnTheEngine) {
  LEFT_OUT_WHEN_SANITIZED();
  for (const int links : {18, 26}) {
    Block block = shells({37, 30, 41}, unsigned(links));
    block.table.links = links;
    std::mt19937 random(7);
    cut_randomly(random, block);
    const Body body = body_of(block);
    std::int64_t visits_of_one = 0, visits = 0;
    const auto expected = dragged(body, Engine::flat, 1);
    const auto one = dragged(body, Engine::block, 1, &visits_of_one);
    const auto two = dragged(body, Engine::block, 2, &visits);
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(one[c], expected[c]) << links << " links, axis " << c;
      EXPECT_EQ(two[c], expected[c]) << links << " links, axis " << c;
    }
    EXPECT_EQ(visits, visits_of_one) << links << " links";
  }
}

namespace {

/// Half of a block with the layer of voxels beyond its border, whose values the other half owns.
struct HalfDomain {
  Body body;
  BrickValues values;
  std::vector<Vec3i> ghosts;

  HalfDomain(const Block& whole, bool upper, int border) {
    Block part = whole;
    for (int n = 0; n < whole.size(); ++n) {
      const int i = whole.voxel(n).x - whole.origin.x;
      const bool owned = upper == (i >= border);
      const bool ghost = i == (upper ? border - 1 : border);
      if (!owned && !ghost) part.element[n] = 0;
      if (ghost && whole.element[n]) ghosts.push_back(whole.voxel(n));
    }
    body = body_of(part);
    values.resize(body.elements.brick_count());
  }
  std::int32_t at(const Vec3i& voxel) const {
    Slot slot = 0;
    return slot_of(body.elements, voxel, slot) ? values.at(slot) : 0;
  }
  /// Halo in: what the other half says of this half's ghosts, where it goes further.
  std::vector<Seed> halo_in(const HalfDomain& other, Direction direction) const {
    std::vector<Seed> seeds;
    for (const Vec3i& voxel : ghosts) {
      Slot slot = 0;
      slot_of(body.elements, voxel, slot);
      const std::int32_t owners = other.at(voxel), mine = values.at(slot);
      if (direction == Direction::raise ? owners > mine : owners < mine) {
        seeds.push_back({slot, owners});
      }
    }
    return seeds;
  }
};

}  // namespace

TEST(PropertyBlockEngine, TwoHalfDomainsThatExchangeHaloValuesGiveTheBitsOfOneSolver) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(12);
  int exchanges = 0;
  for (const int border : {16, 8, 13, 1}) {
    const Block block = shells({30, 20, 20}, unsigned(border));
    const Body whole = body_of(block);
    Propagator solver(whole, Engine::block);
    BrickValues expected(whole.elements.brick_count());
    HalfDomain low(block, false, border), high(block, true, border);
    Propagator low_solver(low.body, Engine::block), high_solver(high.body, Engine::block);
    for (int n = 0; n < 4; ++n) {
      const Direction direction = n % 2 ? Direction::lower : Direction::raise;
      const int c = 0;
      const Vec3i voxel = block.voxel(random_element(random, block));
      const std::int32_t target = (n % 2 ? -1 : 1) * 25 * kVoxel + n;
      Slot slot = 0;
      slot_of(whole.elements, voxel, slot);
      solver.run({c, direction, expected}, {{slot, target}});

      const bool in_low = voxel.x - block.origin.x < border;
      HalfDomain& owner = in_low ? low : high;
      slot_of(owner.body.elements, voxel, slot);
      (in_low ? low_solver : high_solver).run({c, direction, owner.values}, {{slot, target}});
      for (bool changed = true; changed;) {
        const auto into_low = low.halo_in(high, direction);
        low_solver.run({c, direction, low.values}, into_low);
        const auto into_high = high.halo_in(low, direction);
        high_solver.run({c, direction, high.values}, into_high);
        changed = !into_low.empty() || !into_high.empty();
        exchanges += changed;
      }
      for_each_element(whole.elements, [&](Slot at) {
        const Vec3i where = voxel_of(whole.elements, at);
        const HalfDomain& half = where.x - block.origin.x < border ? low : high;
        ASSERT_EQ(half.at(where), expected.at(at)) << "border " << border << " run " << n;
      });
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(exchanges, 20);
}

TEST(UnitBrickKernel, ClosureEqualsRepeatedRelaxationOfEveryLink) {
  std::mt19937 random(21);
  for (int n = 0; n < 200; ++n) {
    const Block source = random_block(random, {8, 8, 8});
    const SlackTable slacks(source.table, source.spacing_mm);
    const int coordinate = n % 3;
    const Direction direction = n % 2 ? Direction::lower : Direction::raise;
    const LinkCosts costs(slacks, coordinate, direction);
    std::array<std::uint8_t, kBrickVoxels> classes;
    BrickMask elements{};
    alignas(64) std::array<Level, kBrickVoxels> levels;
    for (int v = 0; v < kBrickVoxels; ++v) {
      classes[v] = std::uint8_t(random());
      if (random() % 8 != 0) mask_set(elements, v);
      levels[v] = kLevelBias + Level(random() % (1u << (n % 30)));
    }
    const BrickLinks links = links_inside(elements, nullptr);
    std::array<Level, kBrickVoxels> expected = levels;
    for (bool changed = true; changed;) {
      changed = false;
      const int stride[3] = {64, 8, 1};
      for (int axis = 0; axis < 3; ++axis) {
        for (int v = 0; v < kBrickVoxels; ++v) {
          if (!mask_test(links[axis], v)) continue;
          const int w = v + stride[axis];
          const std::size_t entry = std::size_t(classes[v]) * costs.stride() + classes[w];
          const auto relax = [&](Level from, Level cost, Level& to) {
            if (cost >= kNoLink || std::int64_t(from) - cost <= std::int64_t(to)) return;
            to = from - cost;
            changed = true;
          };
          relax(expected[v], costs.row(axis, true).levels[entry], expected[w]);
          relax(expected[w], costs.row(axis, false).levels[entry], expected[v]);
        }
      }
    }
    BrickCosts brick_costs;
    look_up_costs(costs, classes.data(), links, brick_costs);
    close_brick(brick_costs, levels.data());
    ASSERT_EQ(levels, expected) << "case " << n;
  }
}

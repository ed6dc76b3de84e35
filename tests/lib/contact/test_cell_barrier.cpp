// The barrier that keeps cells of voxels the right way round.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "lib/model/spring_models.h"
#include "lib/springs/integrators.h"
#include "lib/springs/lattice_springs.h"
#include "lib/springs/minimise.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

/// The body of a block in a volume that is no larger.
Body body_alone(const Block& block) {
  Body body = body_of(block);
  body.geometry = Geometry(block.dims, Vec3d(0.0), body.geometry.axes_mm());
  return body;
}

Block soft_of(const Vec3i& dims) {
  Block block = soft_block(dims);
  block.spacing_mm = {0.5, 0.7, 0.6};
  return block;
}

/// Springs of a soft block, of one slice or more.
struct Lattice {
  explicit Lattice(const Block& block) : body(body_alone(block)) {
    springs = make_springs(body, material_springs(body));
  }
  explicit Lattice(const Vec3i& dims) : Lattice(soft_of(dims)) {}
  SpringSystem& system() { return springs.system; }
  int node(const Vec3i& voxel) const {
    Slot slot = 0;
    return slot_of(body.elements, voxel, slot) ? springs.node_of(slot) : -1;
  }
  /// The smallest det F of all corners of cells.
  double least_ratio(const std::vector<Vec3d>& pos) const {
    const Vec3i& dims = body.geometry.dims();
    double least = HUGE_VAL;
    for (int n = 0; n < dims.x * dims.y * dims.z; ++n) {
      const Vec3i at(n % dims.x, n / dims.x % dims.y, n / dims.x / dims.y);
      for (int sides = 0; sides < 8; ++sides) {
        Vec3d f[3];
        bool has_all = true;
        for (int axis = 0; axis < 3; ++axis) {
          Vec3i next = at;
          const int side = (sides >> axis & 1) != 0 ? -1 : 1;
          next[axis] += side;
          const double mm = body.geometry.spacing_mm()[axis];
          f[axis] = Vec3d(0.0);
          f[axis][axis] = 1;
          if (dims[axis] == 1) continue;
          has_all = has_all && next[axis] >= 0 && next[axis] < dims[axis];
          if (has_all) f[axis] = (pos[node(next)] - pos[node(at)]) * (side / mm);
        }
        if (has_all) least = std::min(least, f[0].dot(f[1].cross(f[2])));
      }
    }
    return least;
  }

  Body body;
  LatticeSprings springs;
};

void shake(SpringSystem& system, std::mt19937& random, double mm) {
  for (Vec3d& pos : system.pos_mm) {
    for (int c = 0; c < 3; ++c) pos[c] += pick(random, -mm, mm);
  }
}

/// A lattice shaken until corners are inside out, free to find back.
Lattice crumpled(const Vec3i& dims, double mm, unsigned seed) {
  Lattice lattice(dims);
  std::mt19937 random(seed);
  shake(lattice.system(), random, mm);
  if (dims.z == 1) {
    for (Vec3d& pos : lattice.system().pos_mm) pos.z = 0;
  }
  return lattice;
}

Vec3d sum_of(const std::vector<Vec3d>& vectors) {
  Vec3d sum(0.0);
  for (const Vec3d& v : vectors) sum += v;
  return sum;
}

}  // namespace

TEST(UnitCellBarrier, ItsFunctionIsZeroFromOneOnAndItsDerivativesAreThoseOfItsDifferences) {
  EXPECT_DOUBLE_EQ(inversion_barrier(0.5), 0.25 * std::log(2));
  for (const double s : {1.0, 1.5}) {
    EXPECT_EQ(inversion_barrier(s), 0);
    EXPECT_EQ(inversion_barrier_first(s), 0);
    EXPECT_EQ(inversion_barrier_second(s), 0);
  }
  constexpr double kStep = 1e-5;
  for (const double s : {0.99999, 0.7, 0.3, 0.1, -2.0}) {
    const double first =
        (inversion_barrier(s + kStep) - inversion_barrier(s - kStep)) / (2 * kStep);
    const double second =
        (inversion_barrier_first(s + kStep) - inversion_barrier_first(s - kStep)) / (2 * kStep);
    EXPECT_NEAR(inversion_barrier_first(s), first, 1e-4 * (1 + std::abs(first))) << s;
    EXPECT_NEAR(inversion_barrier_second(s), second, 1e-2 * (1 + std::abs(second))) << s;
  }
}

TEST(PropertyCellBarrier, ForcesAreTheGradientOfTheEnergyAndLeaveMomentumAlone) {
  for (const Vec3i& dims : {Vec3i(3, 2, 4), Vec3i(4, 3, 1)}) {
    Lattice lattice = crumpled(dims, 0.4, 5);
    SpringSystem& system = lattice.system();
    system.springs.clear();
    system.barrier.wake(system.pos_mm);
    ASSERT_GT(system.barrier.awake().size(), 5u);
    std::vector<Vec3d> force;
    forces_mn(system, force, Damping::without);
    double largest = 0;
    for (const Vec3d& f : force) largest = std::max(largest, f.length());
    for (std::size_t n = 0; n < force.size(); ++n) {
      for (int c = 0; c < 3; ++c) {
        constexpr double kMm = 1e-6;
        double& place = system.pos_mm[n][c];
        const double here = place;
        place = here + kMm;
        const double above = system.barrier.energy_uj(system.pos_mm);
        place = here - kMm;
        const double below = system.barrier.energy_uj(system.pos_mm);
        place = here;
        EXPECT_NEAR(force[n][c], -(above - below) / (2 * kMm), 1e-5 * largest) << n;
      }
    }
    EXPECT_LT(sum_of(force).length(), 1e-12 * largest);
    if (dims.z == 1) continue;
    Vec3d torque(0.0);
    for (std::size_t n = 0; n < force.size(); ++n) torque += system.pos_mm[n].cross(force[n]);
    EXPECT_LT(torque.length(), 1e-11 * largest);
  }
}

TEST(PropertyCellBarrier, ItSleepsUntilACornerIsBelowAFifthOfItsVolume) {
  Lattice lattice({3, 3, 3});
  SpringSystem& system = lattice.system();
  for (Vec3d& pos : system.pos_mm) pos.x *= 0.21;
  system.barrier.wake(system.pos_mm);
  EXPECT_TRUE(system.barrier.awake().empty());
  for (Vec3d& pos : system.pos_mm) pos.x *= 0.19 / 0.21;
  system.barrier.wake(system.pos_mm);
  EXPECT_EQ(system.barrier.awake().size(), 64u);
  system.barrier.wake(system.pos_mm);
  EXPECT_EQ(system.barrier.awake().size(), 64u);
  EXPECT_GT(system.barrier.energy_uj(system.pos_mm), 0);
}

TEST(PropertyCellBarrier, CutCellsAndVolumesOfOneRowHaveNone) {
  Block block = soft_block({2, 2, 2});
  block.cut.assign(8, 0);
  block.cut[block.index(0, 1, 1)] = 1;  // one link of twelve
  const Body cut = body_of(block);
  for (const Body& body : {cut, body_alone(soft_of({5, 1, 1}))}) {
    LatticeSprings springs = make_springs(body, material_springs(body));
    for (Vec3d& pos : springs.system.pos_mm) pos.x = -pos.x;
    springs.system.barrier.wake(springs.system.pos_mm);
    EXPECT_TRUE(springs.system.barrier.awake().empty());
  }
}

TEST(PropertyCellBarrier, NothingIsInsideOutWhereAHandleGoesThroughItsNeighbours) {
  for (const Vec3i& dims : {Vec3i(9, 9, 1), Vec3i(5, 5, 3)}) {
    for (const bool has_barrier : {true, false}) {
      for (int kind = 0; kind < 4; ++kind) {
        Lattice lattice(dims);
        SpringSystem& system = lattice.system();
        if (!has_barrier) system.barrier = {};
        for (int j = 0; j < dims.y; ++j) {
          for (int k = 0; k < dims.z; ++k) hold(system, lattice.node({0, j, k}));
        }
        const int pulled = lattice.node({3, dims.y / 2, dims.z / 2});
        const Vec3d start = system.pos_mm[pulled];
        hold(system, pulled);
        system.mass_damping_per_s = 50;
        const SpringMethod methods[] = {SpringMethod::symplectic, SpringMethod::implicit,
                                        SpringMethod::xpbd};
        if (kind < 3) {
          const auto integrator = make_integrator(methods[kind], system);
          for (int step = 1; step <= 20; ++step) {
            drive(system, pulled, start - Vec3d(0.055 * step, 0, 0));  // 2.2 voxels in all
            integrator->step(0.005);
          }
        } else {
          for (int step = 1; step <= 20; ++step) {
            drive(system, pulled, start - Vec3d(0.055 * step, 0, 0));
            minimise(system);
          }
        }
        const double least = lattice.least_ratio(system.pos_mm);
        if (has_barrier) {
          EXPECT_GT(least, 0) << kind << " of " << dims.z;
        } else {
          EXPECT_LT(least, 0) << kind << " of " << dims.z;
        }
      }
    }
  }
}

TEST(PropertyCellBarrier, BodiesThatBeginInsideOutFindBackWithoutMomentumOrEnergyFromNothing) {
  const SpringMethod methods[] = {SpringMethod::symplectic, SpringMethod::implicit,
                                  SpringMethod::xpbd};
  for (const SpringMethod method : methods) {
    Lattice lattice = crumpled({4, 4, 3}, 0.35, 7);
    SpringSystem& system = lattice.system();
    ASSERT_LT(lattice.least_ratio(system.pos_mm), 0);
    system.barrier.wake(system.pos_mm);
    const double start = energy(system).total_j();
    run_steps(*make_integrator(method, system), 0.002, 30);
    if (method != SpringMethod::symplectic) {  // which swings on
      EXPECT_GT(lattice.least_ratio(system.pos_mm), 0) << name_of(method);
    }
    EXPECT_LT(energy(system).total_j(), 1.25 * start) << name_of(method);
    Vec3d momentum(0.0);
    double size = 0;
    for (std::size_t n = 0; n < system.node_count(); ++n) {
      momentum += system.velocity_mm_s[n] * system.mass_kg[n];
      size += system.velocity_mm_s[n].length() * system.mass_kg[n];
    }
    EXPECT_LT(momentum.length(), 1e-6 * size) << name_of(method);
  }
}

TEST(PropertyCellBarrier, TissueBetweenARigidTAndABallIsPressedAndNotInsideOut) {
  Block block = t_shape(26);
  block.table.stiffness = Curve{{{0, 100}, {255, 5}}};
  Lattice lattice(block);
  std::vector<Region> anchors = {Region(IndexBox{{0, 0, 0}, {0, 25, 0}})};
  Holds holds;
  MotionParams params;
  params.step_s = 0.005;
  DrivenCollider ball;
  ball.collider = {SphereShape{{30.5, 13, 0}, 4.5}, 0.5, 0.3};
  ball.by_mm = {-6.5, 0, 0};
  params.colliders = {ball};
  VoxelSpringModel model({lattice.body, anchors, holds}, material_springs(lattice.body), params);
  model.move({}, 20, nullptr);
  for (int step = 0; step < 20; ++step) model.step();
  EXPECT_GT(lattice.least_ratio(model.system().pos_mm), 0);
  EXPECT_GT(model.system().barrier.awake().size(), 10u);
}

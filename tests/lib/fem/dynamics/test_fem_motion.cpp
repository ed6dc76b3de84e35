// Motion in time by Newmark's method against its closed form, a dense solver and laws.
#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "lib/fem/dynamics/modes.h"
#include "lib/fem/dynamics/newmark.h"
#include "lib/fem/voxel/loose_islands.h"
#include "lib/model/fem_motion.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/support/sanitized.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr double kDensity = 1100;

Body short_bar() {
  return fem_body(6, [](const Vec3i& v) { return v.x > 1 || v.y > 2 ? -1 : 0; });
}

std::vector<HeldElements> held_end(const Body& body, std::function<Vec3d(const Vec3d&)> to = {}) {
  return {hold_where(
      body, [](const Vec3d& x) { return x.z < -0.49; }, std::move(to))};
}

NodalLoads loads_on(const FemModel& model, const std::vector<HeldElements>& held,
                    const Vec3d& gravity_m_s2 = Vec3d(0)) {
  FemLoads loads;
  loads.held = held;
  loads.gravity_m_s2 = gravity_m_s2;
  loads.mass_density.fill(kDensity);
  return nodal_loads(model.mesh(), model.material(), loads);
}

NewmarkParams exact_steps(double step_s) {
  NewmarkParams params;
  params.step_s = step_s;
  params.tolerance = 1e-11;
  return params;
}

double norm(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), Eigen::Index(x.size())).norm();
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> off(a.size());
  for (std::size_t n = 0; n < a.size(); ++n) off[n] = a[n] - b[n];
  return norm(off);
}

std::vector<double> scaled(std::vector<double> x, double factor) {
  for (double& of : x) of *= factor;
  return x;
}

double stored_mj(const MotionEnergy& energy) {
  return energy.elastic_mj + energy.kinetic_mj;
}

/// Newmark's equations as Newmark wrote them, by a dense matrix: the next acceleration from
/// M a + D v + K u = f with v = v0 + h (a0 + a) / 2, u = u0 + h v0 + h^2 (a0 + a) / 4.
class DenseNewmark {
 public:
  DenseNewmark(Eigen::MatrixXd stiffness, Eigen::MatrixXd mass, Eigen::MatrixXd damping,
               HeldBits held, double step_s)
      : m_k(std::move(stiffness)),
        m_m(std::move(mass)),
        m_d(std::move(damping)),
        m_held(std::move(held)),
        m_h(step_s) {}

  Eigen::VectorXd u, v, a, f;

  void start() {
    a = Eigen::VectorXd::Zero(u.size());
    solve(m_m, f - m_k * u - m_d * v, a);
  }
  /// `u1`, `v1`, `a1`: of held components.
  void step(const Eigen::VectorXd& u1, const Eigen::VectorXd& v1, const Eigen::VectorXd& a1) {
    Eigen::VectorXd next = a1;
    Eigen::VectorXd u_free = u + m_h * v + m_h * m_h / 4 * a, v_free = v + m_h / 2 * a;
    for (Eigen::Index n = 0; n < u.size(); ++n) {
      if (!is_held(n)) continue;
      u_free[n] = u1[n] - m_h * m_h / 4 * a1[n];
      v_free[n] = v1[n] - m_h / 2 * a1[n];
    }
    solve(m_m + m_h / 2 * m_d + m_h * m_h / 4 * m_k, f - m_k * u_free - m_d * v_free, next);
    u = u_free + m_h * m_h / 4 * next;
    v = v_free + m_h / 2 * next;
    a = next;
  }

 private:
  bool is_held(Eigen::Index n) const { return (m_held[std::size_t(n / 3)] >> n % 3 & 1) != 0; }
  /// A x = b at free components, x being given at the others.
  void solve(const Eigen::MatrixXd& matrix, Eigen::VectorXd b, Eigen::VectorXd& x) const {
    Eigen::VectorXd given = Eigen::VectorXd::Zero(x.size());
    std::vector<Eigen::Index> free;
    for (Eigen::Index n = 0; n < x.size(); ++n) {
      if (is_held(n)) {
        given[n] = x[n];
      } else {
        free.push_back(n);
      }
    }
    b -= matrix * given;
    Eigen::VectorXd part(Eigen::Index(free.size()));
    for (std::size_t n = 0; n < free.size(); ++n) part[Eigen::Index(n)] = b[free[n]];
    part = free_part(matrix, m_held).ldlt().solve(part);
    for (std::size_t n = 0; n < free.size(); ++n) x[free[n]] = part[Eigen::Index(n)];
  }

  Eigen::MatrixXd m_k, m_m, m_d;
  HeldBits m_held;
  double m_h;
};

Eigen::VectorXd as_vector(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), Eigen::Index(x.size()));
}

}  // namespace

TEST(PropertyFemMotion, EveryStepIsThatOfADenseSolverOnRandomBodies) {
  std::mt19937 random(41);
  for (int round = 0; round < 3; ++round) {
    const Body body = random_fem_body(random, Vec3i(5, 5, 6));
    const ElasticTable elastic = random_elastic(random);
    const FemModel model(body, elastic);
    MassDensities density;
    for (double& of : density) of = pick(random, 300, 2000);
    RayleighDamping damping;
    damping.mass_per_s = round == 0 ? 0 : pick(random, 1, 30);
    for (double& of : damping.stiffness_s) of = round == 2 ? 0 : pick(random, 0, 5e-3);
    // Held at random places, along some axes, and going somewhere.
    const Vec3d wave(pick(random, 1, 3), pick(random, 1, 3), pick(random, 1, 3));
    FemLoads given;
    given.held = {hold_where(
        body, [wave](const Vec3d& x) { return std::sin(wave.dot(x)) > 0.6; },
        [wave](const Vec3d& x) { return Vec3d(0.3, -0.1 * x.x, 0.2) + 0.05 * wave; })};
    given.held[0].axes = {true, round != 1, true};
    given.gravity_m_s2 = Vec3d(3, -9.81, 1);
    given.mass_density = density;
    const NodalLoads loads = nodal_loads(model.mesh(), model.material(), given);
    const double h = 3e-3;
    Newmark motion(model, density, damping, loads, exact_steps(h));
    std::vector<double> u = random_values(random, loads.u_mm.size());
    std::vector<double> v = random_values(random, loads.u_mm.size());
    motion.start(u, v);
    const Eigen::MatrixXd k = assembled_stiffness(body, model.mesh(), elastic, Dilatation::mean);
    const Eigen::MatrixXd m = assembled_mass(model, density);
    // Damping by classes: that of the stiffness with the moduli of D.
    ElasticTable damped = elastic;
    for (std::size_t n = 0; n < damping.stiffness_s.size(); ++n) {
      damped.young_kpa[n] *= std::max(1e-12, damping.stiffness_s[n]);
    }
    const Eigen::MatrixXd d =
        damping.mass_per_s * m +
        Eigen::MatrixXd(assembled_stiffness(body, model.mesh(), damped, Dilatation::mean));
    DenseNewmark dense(k, m, d, loads.held, h);
    dense.u = as_vector(u);
    dense.v = as_vector(motion.v_mm_s());
    dense.f = as_vector(loads.force_mn);
    dense.start();
    EXPECT_LT((dense.a - as_vector(motion.a_mm_s2())).norm(), 1e-6 * dense.a.norm());
    const Eigen::VectorXd from = dense.u, way = as_vector(loads.u_mm) - from;
    for (int n = 1; n <= 8; ++n) {
      const WayPart part = smooth_way(n * h, 5 * h);
      motion.step(part);
      dense.step(from + part.part * way, part.per_s * way, part.per_s2 * way);
      EXPECT_LT((dense.u - as_vector(motion.u_mm())).norm(), 1e-6 * dense.u.norm()) << n;
      EXPECT_LT((dense.v - as_vector(motion.v_mm_s())).norm(), 1e-6 * dense.v.norm()) << n;
      EXPECT_LT((dense.a - as_vector(motion.a_mm_s2())).norm(), 1e-6 * dense.a.norm()) << n;
      const Eigen::VectorXd left = dense.f - k * dense.u - d * dense.v - m * dense.a;
      EXPECT_LT((left - as_vector(motion.reaction_mn())).norm(), 1e-6 * left.norm()) << n;
      const MotionEnergy energy = motion.energy();
      EXPECT_NEAR(energy.elastic_mj, 5e-4 * dense.u.dot(k * dense.u), 1e-6 * energy.elastic_mj);
      EXPECT_NEAR(energy.kinetic_mj, 5e-4 * dense.v.dot(m * dense.v), 1e-6 * energy.kinetic_mj);
    }
  }
}

TEST(PropertyFemMotion, AModeSwingsAsItsClosedFormSays) {
  // u'' + 2 d u' + omega^2 u = 0 by average acceleration: with b = h (d + i omega_d) of the exact
  // roots replaced by the map (1 + s h / 2) / (1 - s h / 2) of each root s.
  const Body body = short_bar();
  const FemModel model(body, ElasticTable::uniform(6, 0.3));
  ModeParams modes;
  modes.count = 2;
  const VibrationMode mode =
      lowest_modes(model, even_density(kDensity), held_bits(model.mesh(), held_end(body)), modes)
          .modes[1];
  const double omega = std::sqrt(mode.eigenvalue_per_s2), h = 0.3 / omega;
  for (const double alpha : {0.0, 0.2 * omega}) {
    RayleighDamping damping;
    damping.mass_per_s = alpha;
    damping.stiffness_s.fill(alpha > 0 ? 0.05 / omega : 0);
    const double d = (alpha + damping.stiffness_s[0] * omega * omega) / 2;
    Newmark motion(model, even_density(kDensity), damping, loads_on(model, held_end(body)),
                   exact_steps(h));
    motion.start(mode.shape, scaled(mode.shape, 0));
    const std::complex<double> root(-d, std::sqrt(omega * omega - d * d));
    const std::complex<double> growth = (1.0 + root * (h / 2)) / (1.0 - root * (h / 2));
    std::complex<double> part = 1;
    for (int n = 1; n <= 50; ++n) {
      motion.step({});
      part *= growth;
      // u = Re(c part) with u = 1 and u' = 0 at the start.
      const double expected = part.real() - root.real() / root.imag() * part.imag();
      ASSERT_LT(distance(motion.u_mm(), scaled(mode.shape, expected)), 1e-6 * norm(mode.shape))
          << n;
    }
  }
}

TEST(ConvergenceFemMotion, TheErrorFallsWithTheSquareOfTheStep) {
  LEFT_OUT_WHEN_SANITIZED();
  const Body body = short_bar();
  const FemModel model(body, ElasticTable::uniform(6, 0.3));
  const double lowest_hz =
      lowest_modes(model, even_density(kDensity), held_bits(model.mesh(), held_end(body)), {1})
          .modes[0]
          .frequency_hz;
  RayleighDamping damping;
  damping.stiffness_s.fill(0.02 / lowest_hz);
  // The end is moved aside over half a swing, under gravity that acts at once.
  const double time_s = 1 / lowest_hz, ramp_s = time_s / 2;
  const auto end_of = [&](int steps) {
    const auto held = held_end(body, [](const Vec3d&) { return Vec3d(1, 0.5, 0); });
    Newmark motion(model, even_density(kDensity), damping, loads_on(model, held, Vec3d(2, 0, 0)),
                   exact_steps(time_s / steps));
    motion.start(std::vector<double>(loads_on(model, held).u_mm.size(), 0.0),
                 std::vector<double>(loads_on(model, held).u_mm.size(), 0.0));
    for (int n = 1; n <= steps; ++n) motion.step(smooth_way(n * time_s / steps, ramp_s));
    return motion.u_mm();
  };
  const std::vector<double> exact = end_of(1280);
  std::vector<double> errors;
  for (const int steps : {40, 80, 160}) {
    errors.push_back(distance(end_of(steps), exact) / norm(exact));
  }
  EXPECT_LT(errors.back(), 2e-3);
  for (const double order : orders_of(errors)) EXPECT_NEAR(order, 2, 0.1);
}

TEST(PropertyFemMotion, EnergyIsKeptAndDampingTakesWhatItSays) {
  std::mt19937 random(43);
  const Body body = random_fem_body(random, Vec3i(6, 6, 6));
  const FemModel model(body, random_elastic(random));
  const std::vector<HeldElements> held{
      hold_where(body, [](const Vec3d& x) { return std::sin(2 * x.y) > 0.7; })};
  for (const bool is_damped : {false, true}) {
    RayleighDamping damping;
    damping.mass_per_s = is_damped ? 5 : 0;
    damping.stiffness_s.fill(is_damped ? 1e-3 : 0);
    NodalLoads loads = loads_on(model, held, Vec3d(0, 5, -9.81));
    NewmarkParams params = exact_steps(2e-3);
    params.tolerance = 1e-9;
    Newmark motion(model, even_density(kDensity), damping, loads, params);
    // Held where it starts.
    std::vector<double> u = loads.u_mm, v = random_values(random, u.size());
    motion.start(u, v);
    const double first = stored_mj(motion.energy());
    double last = first;
    for (int n = 0; n < 200; ++n) {
      motion.step({});
      const MotionEnergy now = motion.energy();
      const double all = stored_mj(now) + now.dissipated_mj;
      EXPECT_NEAR(all - now.work_mj, first, 1e-7 * all) << n;
      if (is_damped) {
        EXPECT_LT(stored_mj(now) - now.work_mj, last) << n;
      }
      last = stored_mj(now) - now.work_mj;
    }
    EXPECT_EQ(motion.energy().dissipated_mj > 0, is_damped);
    // No step is too long: energy is kept for one of many swings, too.
    Newmark coarse(model, even_density(kDensity), damping, loads, exact_steps(0.5));
    coarse.start(u, v);
    for (int n = 0; n < 5; ++n) coarse.step({});
    const MotionEnergy now = coarse.energy();
    EXPECT_NEAR(stored_mj(now) + now.dissipated_mj - now.work_mj, first,
                1e-6 * (stored_mj(now) + now.dissipated_mj));
  }
}

TEST(PropertyFemMotion, AFreeBodyFallsAsGalileiSays) {
  const Body body = short_bar();
  const FemModel model(body, ElasticTable::uniform(6, 0.3));
  Newmark motion(model, even_density(kDensity), {}, loads_on(model, {}, Vec3d(0, 0, -9.81)),
                 exact_steps(0.01));
  const std::size_t size = loads_on(model, {}).u_mm.size();
  motion.start(std::vector<double>(size, 0.0), std::vector<double>(size, 0.0));
  for (int n = 0; n < 10; ++n) motion.step({});
  for (std::size_t n = 0; n < size; ++n) {
    EXPECT_NEAR(motion.u_mm()[n], n % 3 == 2 ? -9.81e3 * 0.01 / 2 : 0, 1e-5);
  }
  EXPECT_NEAR(motion.energy().work_mj, motion.energy().kinetic_mj, 1e-8);
}

TEST(PropertyFemMotion, WithDampingItComesToRestInEquilibrium) {
  Body body = short_bar();
  std::vector<Region> anchors{IndexBox{{0, 0, 0}, {1, 2, 0}}};
  Holds holds;
  FemMotionParams params;
  params.elastic = ElasticTable::uniform(6, 0.3);
  params.density = even_density(kDensity);
  params.damping.mass_per_s = 300;
  // Quick swings that gravity starts at once fade slowly in steps that are longer than they are.
  params.newmark = exact_steps(1e-3);
  params.loads.gravity_m_s2 = Vec3d(9.81, 0, 0);
  params.loads.mass_density.fill(kDensity);
  VoxelFemMotion moving({body, anchors, holds}, params);
  moving.move({}, 0, nullptr);
  for (int n = 0; n < 1500; ++n) moving.step();
  FemLoads loads = params.loads;
  loads.held.emplace_back().elements = elements_in(body, {{0, 0, 0}, {1, 2, 0}});
  FemParams static_params;
  static_params.tolerance = 1e-10;
  const FemSolution rest = moving.solid().solve(loads, static_params);
  EXPECT_LT(distance(moving.motion().u_mm(), rest.u_mm), 1e-6 * norm(rest.u_mm));
  const Vec3d pull = moving.anchor_reaction().force_n;
  EXPECT_LT((pull - rest.reactions[0].force_n).length(), 1e-6 * pull.length());
  moving.store();
  EXPECT_GT(body.offset(Vec3i(0, 0, 5), 0), 0);
}

TEST(PropertyFemMotion, AMotionThatIsStoredGoesOnAsIfItHadNotBeen) {
  FemMotionParams params;
  params.elastic = ElasticTable::uniform(6, 0.3);
  params.density = even_density(kDensity);
  params.newmark = exact_steps(2e-3);
  const std::vector<Region> anchors{IndexBox{{0, 0, 0}, {1, 2, 0}}};
  const Handle pull(Region(IndexBox{{0, 0, 5}, {1, 2, 5}}), {int(0.4 * kFixedOne), 0, 0});
  Body one = short_bar(), two = short_bar();
  Holds held_one, held_two;
  VoxelFemMotion whole({one, anchors, held_one}, params);
  whole.move({pull}, 20, nullptr);
  for (int n = 0; n < 20; ++n) whole.step();
  for (int n = 0; n < 20; ++n) whole.step();
  const double scale = norm(whole.motion().u_mm());
  for (const bool with_nodes : {true, false}) {
    two = short_bar();
    held_two = {};
    VoxelFemMotion first({two, anchors, held_two}, params);
    first.move({pull}, 20, nullptr);
    for (int n = 0; n < 20; ++n) first.step();
    first.store();
    VoxelFemMotion second({two, anchors, held_two}, params);
    FemNodes nodes{first.motion().u_mm(), first.motion().v_mm_s(),
                   element_displacements(first.solid().mesh(), two)};
    if (!with_nodes) nodes.elements_mm[0].x += 1e-9;  // of another body
    second.start_from(nodes);
    second.move({}, 0, nullptr);
    for (int n = 0; n < 20; ++n) second.step();
    const double off = distance(second.motion().u_mm(), whole.motion().u_mm());
    // The nodes between elements are known to the order of the mesh alone.
    EXPECT_LT(off, (with_nodes ? 1e-5 : 0.1) * scale);
    if (!with_nodes) {
      EXPECT_GT(off, 1e-4 * scale);
    }
  }
}

TEST(PropertyFemMotion, LoosePiecesRestBesideWhatIsHeldAndFallWhereNothingIs) {
  // Two plates with a gap.
  Body body = fem_body(5, [](const Vec3i& v) { return v.x == 2 ? -1 : 0; });
  FemMotionParams params;
  params.elastic = ElasticTable::uniform(6, 0.3);
  params.density = even_density(kDensity);
  params.loads.gravity_m_s2 = Vec3d(0, 0, -9.81);
  params.loads.mass_density.fill(kDensity);
  params.newmark = exact_steps(0.01);
  const auto moved_after = [&](const std::vector<Region>& anchors) {
    Body falling = body;
    Holds holds;
    VoxelFemMotion motion({falling, anchors, holds}, params);
    motion.move({}, 0, nullptr);
    for (int n = 0; n < 5; ++n) motion.step();
    motion.store();
    EXPECT_EQ(motion.loose().loose_islands, anchors.empty() ? 2 : 1);
    EXPECT_EQ(motion.held_islands(), anchors.empty() ? 0 : 1);
    return falling;
  };
  const std::vector<Region> foot{IndexBox{{0, 0, 0}, {1, 4, 0}}};
  const Body held = moved_after(foot);
  EXPECT_LT(held.offset({0, 2, 4}, 2), 0);
  EXPECT_EQ(held.offset({4, 2, 4}, 2), 0);
  const Body free = moved_after({});
  EXPECT_NEAR(free.offset({0, 2, 4}, 2) / kFixedOne, -9.81e3 * 0.05 * 0.05 / 2, 1e-3);
  EXPECT_NEAR(free.velocity_mm_s[2].at(Slot(0)), -9.81e3 * 0.05, 1e-3);
  params.loose = LooseIslands::refuse;
  Holds holds;
  VoxelFemMotion refused({body, foot, holds}, params);
  EXPECT_THROW(refused.move({}, 0, nullptr), InputError);
}

TEST(PropertyFemMotion, NodesAreExactWhereElementsAreLinearInSpace) {
  std::mt19937 random(47);
  const Body body = fem_body(5, [](const Vec3i& v) { return v == Vec3i(2) ? -1 : 0; });
  const HexMesh mesh = hex_mesh(body);
  const Vec3d slope(pick(random, -1, 1), pick(random, -1, 1), pick(random, -1, 1));
  std::vector<Vec3d> of_element;
  for (std::size_t b = 0; b < mesh.block_count(); ++b) {
    for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
      const Vec3i voxel = mesh.origin[b] + brick_local(mesh.offset[std::size_t(e)]);
      of_element.push_back(slope * Vec3d(voxel).dot(Vec3d(1, -2, 0.5)));
    }
  }
  // Every element has a neighbour along each axis.
  const std::vector<double> nodes = at_nodes(mesh, body, of_element);
  const std::vector<Vec3d> places = node_positions(mesh);
  std::size_t exact = 0;
  for (std::size_t n = 0; n < places.size(); ++n) {
    const Vec3d expected = slope * places[n].dot(Vec3d(1, -2, 0.5));
    const Vec3d found(nodes[3 * n], nodes[3 * n + 1], nodes[3 * n + 2]);
    exact += (found - expected).length() < 1e-9;
  }
  EXPECT_EQ(exact, places.size());
}

TEST(PropertyFemMotion, ResultsHaveTheSameBitsOnAnyNumberOfThreads) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(44);
  const Body body = random_fem_body(random, Vec3i(14, 14, 14));
  const FemModel model(body, random_elastic(random));
  const std::vector<HeldElements> held{hold_where(
      body, [](const Vec3d& x) { return std::sin(x.y) > 0.9; },
      [](const Vec3d&) { return Vec3d(0.5, 0, 0); })};
  RayleighDamping damping;
  damping.stiffness_s.fill(1e-3);
  const auto run = [&] {
    Newmark motion(model, even_density(900), damping, loads_on(model, held), {});
    const std::size_t size = loads_on(model, held).u_mm.size();
    motion.start(std::vector<double>(size, 0.0), std::vector<double>(size, 0.0));
    for (int n = 1; n <= 4; ++n) motion.step(smooth_way(n * 1e-3, 3e-3));
    return std::make_pair(motion.u_mm(), motion.energy().dissipated_mj);
  };
  EXPECT_EQ(on_threads(3, run), on_threads(1, run));
}

TEST(UnitFemMotion, TheWayOfHandlesStartsAndStopsGently) {
  EXPECT_EQ(smooth_way(0, 2).part, 0);
  EXPECT_EQ(smooth_way(0, 2).per_s, 0);
  EXPECT_NEAR(smooth_way(1, 2).part, 0.5, 1e-15);
  EXPECT_EQ(smooth_way(2, 2).part, 1);
  EXPECT_EQ(smooth_way(0.1, 0).part, 1);
  for (const double t : {0.3, 0.9, 1.7}) {
    const double e = 1e-5;
    const WayPart before = smooth_way(t - e, 2), after = smooth_way(t + e, 2);
    EXPECT_NEAR(smooth_way(t, 2).per_s, (after.part - before.part) / (2 * e), 1e-8);
    EXPECT_NEAR(smooth_way(t, 2).per_s2, (after.per_s - before.per_s) / (2 * e), 1e-8);
  }
}

TEST(UnitFemMotion, BadValuesAreErrors) {
  const Body body = short_bar();
  const FemModel model(body, ElasticTable::uniform(6, 0.3));
  const NodalLoads loads = loads_on(model, held_end(body));
  const auto make = [&](const MassDensities& density, const RayleighDamping& damping,
                        const NewmarkParams& params) {
    Newmark(model, density, damping, loads, params);
  };
  RayleighDamping negative;
  negative.mass_per_s = -1;
  NewmarkParams no_step;
  no_step.step_s = 0;
  EXPECT_NO_THROW(make(even_density(1000), {}, {}));
  EXPECT_THROW(make(even_density(0), {}, {}), InputError);
  EXPECT_THROW(make(even_density(1000), negative, {}), InputError);
  EXPECT_THROW(make(even_density(1000), {}, no_step), InputError);
  NewmarkParams few;
  few.max_iterations = 1;
  few.tolerance = 1e-12;
  Newmark motion(model, even_density(1000), {}, loads_on(model, held_end(body), Vec3d(9, 0, 0)),
                 few);
  EXPECT_THROW(motion.start(loads.u_mm, loads.u_mm), NotConverged);
}

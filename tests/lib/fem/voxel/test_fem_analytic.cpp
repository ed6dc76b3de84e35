// Voxel finite elements against analytic solutions, with the order that each of them reaches.
//
// Bodies with flat faces along the grid reach order 2. Round ones are staircases of whole voxels,
// which leave out and add slivers of half a voxel: order 1, whatever the elements inside.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/lib/fem_fixtures.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

using VectorField = std::function<Vec3d(const Vec3d&)>;

/// Agreement of displacements with a formula.
struct Agreement {
  double error;      // root mean square over that of the formula
  double amplitude;  // the factor of the formula that comes nearest
};

/// Compares the nodes for which `counts` says so. `origin` is added to positions; `known` is taken
/// away from displacements and formula.
Agreement agreement(const FemModel& model, const FemSolution& solution, const Vec3d& origin,
                    const VectorField& exact, const VectorField& known = nullptr,
                    const std::function<bool(const Vec3d&)>& counts = nullptr) {
  const std::vector<Vec3d> positions = node_positions(model.mesh());
  double error = 0, size = 0, common = 0;
  for (std::size_t n = 0; n < positions.size(); ++n) {
    const Vec3d at = positions[n] + origin;
    if (counts && !counts(at)) continue;
    const double* u = &solution.u_mm[3 * n];
    const Vec3d base = known ? known(at) : Vec3d(0.0);
    const Vec3d want = exact(at) - base, found = Vec3d(u[0], u[1], u[2]) - base;
    error += (found - want).length2();
    size += want.length2();
    common += found.dot(want);
  }
  return {std::sqrt(error / size), common / size};
}

/// Order of errors at three sizes of the voxel; they must fall from one to the next.
double reached_order(const std::array<double, 3>& errors, double refinement) {
  EXPECT_LT(errors[1], errors[0]);
  EXPECT_LT(errors[2], errors[1]);
  return std::log(errors[0] / errors[2]) / std::log(refinement);
}
double reached_order(const std::array<Agreement, 3>& found, double refinement) {
  return reached_order(std::array<double, 3>{found[0].error, found[1].error, found[2].error},
                       refinement);
}

/// Limit of an amplitude of order 1: a line through those of voxels of half and full size.
double limit_of(const std::array<Agreement, 3>& found) {
  return 2 * found[2].amplitude - found[1].amplitude;
}

/// The planes of symmetry of the octant x, y, z >= 0 of a body whose first voxel lies at 0.
void hold_symmetry(const Body& body, double h, FemLoads& loads) {
  for (int a = 0; a < 3; ++a) {
    loads.held.push_back(hold_where(body, [a, h](const Vec3d& x) { return x[a] + h / 2 < h / 4; }));
    loads.held.back().axes = {a == 0, a == 1, a == 2};
  }
}

Vec3d voxel_centre(const Vec3i& voxel, double h) {
  return (Vec3d(voxel) + Vec3d(0.5)) * h;
}

/// A shell between radii 1/2 and 1 mm under a pressure of 1 kPa inside, of 2 kPa (Lame; Timoshenko
/// and Goodier, Theory of Elasticity, art. 142).
Agreement thick_sphere(int n, double poisson) {
  const double young = 2, inner = 0.5, h = 1.0 / n;
  const Body body = fem_body(
      n,
      [&](const Vec3i& voxel) {
        const double r = voxel_centre(voxel, h).length();
        return r > inner && r < 1 ? 0 : -1;
      },
      h);
  const double a3 = inner * inner * inner;
  const VectorField exact = [=](const Vec3d& x) {
    const double r = x.length();
    return x * (a3 / (young * (1 - a3)) * (1 - 2 * poisson + (1 + poisson) / (2 * r * r * r)));
  };
  FemLoads loads;
  hold_symmetry(body, h, loads);
  loads.face_pressures.push_back({slots_in_mask(body.elements, body.elements), 1,
                                  [=](const Vec3d& centre, const Vec3d& normal) {
                                    const Vec3d at = centre + Vec3d(h / 2);
                                    return at.length() < 0.75 && at.dot(normal) < -h / 4;
                                  }});
  const FemModel model(body, ElasticTable::uniform(young, poisson));
  return agreement(model, model.solve(loads), Vec3d(h / 2), exact);
}

/// A ball of radius 1/2 mm in a cube of 1 kPa that is stretched alike in all directions (the
/// hydrostatic case of Eshelby's inclusion; Goodier 1933): how it disturbs the even stretch.
Agreement inclusion(int n, double young_inside) {
  const double h = 1.0 / n, radius = 0.5, strain = 0.01;
  ElasticTable elastic = ElasticTable::uniform(1, 0.3);
  elastic.young_kpa[1] = young_inside;
  const ElasticModuli outside = elastic_moduli(elastic.young_kpa[0], elastic.poisson[0]);
  const ElasticModuli inside = elastic_moduli(elastic.young_kpa[1], elastic.poisson[1]);
  // u = strain (1 + b (R / r)^3) x outside: the tractions of both sides are alike.
  const double b =
      3 * (outside.bulk_kpa - inside.bulk_kpa) / (3 * inside.bulk_kpa + 4 * outside.shear_kpa);
  const VectorField exact = [=](const Vec3d& x) {
    const double ratio = radius / std::max(x.length(), radius);
    return x * (strain * (1 + b * ratio * ratio * ratio));
  };
  const Body body = fem_body(
      n, [&](const Vec3i& voxel) { return voxel_centre(voxel, h).length() < radius ? 1 : 0; }, h);
  FemLoads loads;
  loads.held.push_back(hold_where(
      body,
      [h](const Vec3d& x) {
        return std::max({x.x, x.y, x.z}) + h / 2 > 1 - h / 4;
      },
      [&](const Vec3d& x) { return exact(x + Vec3d(h / 2)); }));
  hold_symmetry(body, h, loads);
  const FemModel model(body, elastic);
  const VectorField far = [=](const Vec3d& x) { return x * strain; };
  return agreement(model, model.solve(loads), Vec3d(h / 2), exact, far);
}

/// A beam of 4 x 1 x 1/4 mm bent by a force at its end (Timoshenko and Goodier, art. 21, whose
/// displacements are exact for nu = 0): the part of the force that is wrong.
double cantilever_error(int n) {
  const double young = 12, length = 4, depth = 1, width = 0.25, force_mn = 0.01, h = depth / n;
  Block block = homogeneous({4 * n, n, n / 4}, 1.5, 0.5, 0.5);
  block.spacing_mm = Vec3d(h);
  const Body body = body_of(block);
  const double factor = force_mn / (6 * young * width * depth * depth * depth / 12);
  const VectorField exact = [=](const Vec3d& at) {
    const double x = at.x, y = at.y - depth / 2;
    return Vec3d(-y * ((6 * length - 3 * x) * x + 2 * (y * y - depth * depth / 4)),
                 depth * depth * x + (3 * length - x) * x * x, 0) *
           factor;
  };
  const Vec3d origin(h / 2);
  const VectorField at_rest = [=](const Vec3d& x) { return exact(x + origin); };
  FemLoads loads;
  loads.held.push_back(hold_where(
      body, [h](const Vec3d& x) { return x.x + h / 2 < h / 4; }, at_rest));
  loads.held.push_back(hold_where(
      body, [=](const Vec3d& x) { return x.x + h / 2 > length - h / 4; }, at_rest));
  loads.held.back().axes = {false, true, false};
  const FemModel model(body, ElasticTable::uniform(young, 0));
  const FemSolution solution = model.solve(loads);
  return std::abs(solution.reactions.back().force_n.y + force_mn * 1e-3) / (force_mn * 1e-3);
}

/// A force at the middle of a cube, whose faces go where they would inside of endless material
/// (Kelvin; Love, A Treatise on the Mathematical Theory of Elasticity, art. 130).
Agreement point_force(int n, double poisson) {
  const double young = 3, h = 1.0 / n, force_mn = 0.2, pi = std::acos(-1.0);
  const ElasticModuli moduli = elastic_moduli(young, poisson);
  const Vec3d force = Vec3d(1, 2, -2) / 3.0 * force_mn;
  const VectorField exact = [=](const Vec3d& x) {
    const double r = x.length();
    return (force * (3 - 4 * poisson) + x * (force.dot(x) / (r * r))) /
           (16 * pi * moduli.shear_kpa * (1 - poisson) * r);
  };
  const Vec3d origin(h / 2 - 0.5);
  const Body body = fem_cube(n, h);
  FemLoads loads;
  loads.held.push_back(hold_where(
      body,
      [=](const Vec3d& x) {
        const Vec3d at = x + origin;
        return std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) > 0.5 - h / 4;
      },
      [=](const Vec3d& x) { return exact(x + origin); }));
  const Vec3i middle(n / 2);
  loads.forces.push_back({elements_in(body, {middle, middle}), force * 1e-3});
  const FemModel model(body, ElasticTable::uniform(young, poisson));
  return agreement(model, model.solve(loads), origin, exact, nullptr,
                   [](const Vec3d& x) { return x.length() > 0.25; });
}

}  // namespace

TEST(UnitFemLoads, AForceIsSharedByVolumeSoThatABarIsPulledEvenly) {
  // Each of its nodes an equal share drew the edges of its end 1.8 % further than the middle.
  const int n = 6;
  const double young = 6, force_n = 1e-6;
  const Body body = fem_cube(n);
  FemLoads loads;
  loads.held.push_back(hold_where(body, [](const Vec3d& at) { return at.x < 0; }));
  ForceOnElements& pull = loads.forces.emplace_back();
  pull.elements = elements_in(body, {{n - 1, 0, 0}, Vec3i(n - 1)});
  pull.force_n = {force_n, 0, 0};
  const FemModel model(body, ElasticTable::uniform(young, 0));
  const FemSolution solution = model.solve(loads);
  const double of_stretch = force_n * 1e3 / (young * n * n);
  const std::vector<Vec3d> positions = node_positions(model.mesh());
  for (std::size_t node = 0; node < positions.size(); ++node) {
    const double x = positions[node].x + 0.5;  // from the face that is held
    if (x > n - 0.9) continue;                 // beyond what the force passes through
    EXPECT_NEAR(solution.u_mm[3 * node], x * of_stretch, 1e-5 * n * of_stretch) << positions[node];
  }
}

TEST(ConvergenceFem, AThickSphereUnderPressureWidensAsLameSays) {
  LEFT_OUT_WHEN_SANITIZED();
  for (const double poisson : {0.3, 0.49}) {
    const std::array<Agreement, 3> found{thick_sphere(8, poisson), thick_sphere(16, poisson),
                                         thick_sphere(32, poisson)};
    EXPECT_GE(reached_order(found, 4), 1) << poisson;
    EXPECT_LT(found[2].error, 0.05) << poisson;
    EXPECT_NEAR(limit_of(found), 1, 0.006) << poisson;
  }
}

TEST(ConvergenceFem, AStiffAndASoftBallInAStretchedCubeDisturbItAsGoodierSays) {
  LEFT_OUT_WHEN_SANITIZED();
  for (const double young : {10.0, 0.1}) {
    const std::array<Agreement, 3> found{inclusion(8, young), inclusion(16, young),
                                         inclusion(32, young)};
    EXPECT_GE(reached_order(found, 4), 1) << young;
    EXPECT_LT(found[2].error, 0.03) << young;
    EXPECT_NEAR(limit_of(found), 1, 0.006) << young;
  }
}

TEST(ConvergenceFem, ACantileverPullsAtItsEndAsTimoshenkoSays) {
  LEFT_OUT_WHEN_SANITIZED();
  const std::array<double, 3> errors{cantilever_error(4), cantilever_error(8),
                                     cantilever_error(16)};
  EXPECT_GE(reached_order(errors, 4), 1.9);
  EXPECT_LT(errors[2], 0.001);
}

TEST(ConvergenceFem, APointForceMovesFarPlacesAsKelvinSays) {
  LEFT_OUT_WHEN_SANITIZED();
  for (const double poisson : {0.3, 0.49}) {
    const std::array<Agreement, 3> found{point_force(9, poisson), point_force(17, poisson),
                                         point_force(33, poisson)};
    EXPECT_GE(reached_order(found, 33.0 / 9), 1.9) << poisson;
    EXPECT_LT(found[2].error, 0.002) << poisson;
  }
}

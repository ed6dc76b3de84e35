// Laws of single elements and of patches of them: constant strain, rigid motions, swelling, loads.
#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "tests/lib/fem/tet/tet_fixtures.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/lib/test_bodies.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

SolidMesh perturbed_block(double young_kpa, double poisson) {
  SolidMesh mesh = tet_block(Vec3i(3, 4, 2), Vec3d(30, 36, 18), 0.2);
  set_material(mesh, young_kpa, poisson);
  return mesh;
}

const Matrix9 kSlope{0.01, -0.02, 0.005, 0.03, -0.015, 0.01, 0.02, 0.01, 0.02};
Vec3d linear_field(const Vec3d& x) {
  const Matrix9& g = kSlope;
  return {g[0] * x.x + g[1] * x.y + g[2] * x.z + 0.1, g[3] * x.x + g[4] * x.y + g[5] * x.z,
          g[6] * x.x + g[7] * x.y + g[8] * x.z - 0.2};
}

bool is_on_border(const Vec3d& x) {
  return x.x == 0 || x.x == 30 || x.y == 0 || x.y == 36 || x.z == 0 || x.z == 18;
}

/// Stress of the strain of kSlope.
SymmetricTensor slope_stress(const TetModuli& moduli) {
  const Matrix9& g = kSlope;
  const double mu = moduli.shear_kpa, mean = moduli.lambda_kpa() * (g[0] + g[4] + g[8]);
  return {2 * mu * g[0] + mean, 2 * mu * g[4] + mean, 2 * mu * g[8] + mean,
          mu * (g[1] + g[3]),   mu * (g[5] + g[7]),   mu * (g[2] + g[6])};
}

/// Energy of a displacement, u K u / 2.
double energy_of(const TetModel& model, const std::vector<double>& u) {
  std::vector<double> force(u.size());
  model.stiffness().add(u.data(), force.data());
  double sum = 0;
  for (std::size_t n = 0; n < u.size(); ++n) sum += u[n] * force[n] / 2;
  return sum;
}

double largest_force(const TetModel& model, const std::vector<double>& u) {
  std::vector<double> force(u.size());
  model.stiffness().add(u.data(), force.data());
  double most = 0;
  for (const double of : force) most = std::max(most, std::abs(of));
  return most;
}

}  // namespace

TEST(PropertyTetElements, APatchTakesTheConstantStrainOfItsBorder) {
  for (const TetElement element : kTetElements) {
    for (const double poisson : {-0.2, 0.0, 0.3, 0.499}) {
      const TetModel model(perturbed_block(6, poisson), element);
      TetLoads loads;
      loads.held.push_back(held_where(model, is_on_border, linear_field));
      const TetSolution solution = model.solve(loads, exact_params());
      EXPECT_LE(largest_difference(model, solution, linear_field), kRounding);
      const SymmetricTensor wanted = slope_stress(model.moduli()[0]);
      for (const ElementState& state : model.states(solution, loads)) {
        for (std::size_t n = 0; n < 6; ++n) {
          EXPECT_NEAR(state.stress_kpa[n], wanted[n], 1e-11 * model.moduli()[0].bulk_kpa);
        }
      }
    }
  }
}

TEST(PropertyTetElements, RigidMotionsAndNoOthersCostNothing) {
  for (const TetElement element : kTetElements) {
    SolidMesh mesh = tet_block(Vec3i(2, 1, 1), Vec3d(20, 12, 11), 0);
    mesh.nodes_lps_mm[3] += Vec3d(1, -2, 0.5);
    const TetModel model(mesh, element);
    const Eigen::Index count = 3 * model.node_count();
    Eigen::MatrixXd dense(count, count);
    for (Eigen::Index n = 0; n < count; ++n) {
      std::vector<double> unit(std::size_t(count), 0.0), column(std::size_t(count), 0.0);
      unit[std::size_t(n)] = 1;
      model.stiffness().add(unit.data(), column.data());
      dense.col(n) = Eigen::Map<Eigen::VectorXd>(column.data(), count);
    }
    EXPECT_EQ(dense, dense.transpose());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(dense);
    const double largest = modes.eigenvalues()[count - 1];
    EXPECT_LE(std::abs(modes.eigenvalues()[0]), kRounding * largest);
    EXPECT_LE(std::abs(modes.eigenvalues()[5]), kRounding * largest);
    EXPECT_GT(modes.eigenvalues()[6], 1e-4 * largest);
    std::vector<double> turned;
    for (const Vec3d& x : model.node_positions()) {
      const Vec3d u = Vec3d(0.3, -0.2, 0.5).cross(x) + Vec3d(1, 2, 3);
      turned.insert(turned.end(), {u.x, u.y, u.z});
    }
    EXPECT_LE(largest_force(model, turned), kRounding * largest * 20);
  }
}

TEST(UnitTetElements, EnergyIsThatOfTheStrainTimesTheVolume) {
  for (const TetElement element : kTetElements) {
    const TetModel model(perturbed_block(6, 0.4), element);
    std::vector<double> u;
    for (const Vec3d& x : model.node_positions()) {
      const Vec3d of = linear_field(x);
      u.insert(u.end(), {of.x, of.y, of.z});
    }
    const SymmetricTensor stress = slope_stress(model.moduli()[0]);
    const Matrix9& g = kSlope;
    const double density =
        (stress[0] * g[0] + stress[1] * g[4] + stress[2] * g[8] + stress[3] * (g[1] + g[3]) +
         stress[4] * (g[5] + g[7]) + stress[5] * (g[2] + g[6])) /
        2;
    EXPECT_NEAR(energy_of(model, u) / (density * 30 * 36 * 18), 1, kRounding);
    const Matrix9 f{1.01, -0.02, 0.005, 0.03, 0.985, 0.01, 0.02, 0.01, 1.02};
    const double det_f = determinant_of(f, cofactors(f));
    EXPECT_NEAR(model.volumes().displaced_volume_mm3(u) / (det_f * 30 * 36 * 18), 1, kRounding);
    EXPECT_NEAR(model.volumes().least_det_f(u), det_f, kRounding);
  }
}

TEST(UnitTetElements, AFreeBodySwellsByPressureOverBulkModulusWithoutStress) {
  for (const TetElement element : kTetElements) {
    const TetModel model(perturbed_block(6, 0.45), element);
    TetLoads loads;
    const auto at_corner = [](const Vec3d& x) { return x == Vec3d(0); };
    const auto along_x = [](const Vec3d& x) { return x == Vec3d(30, 0, 0); };
    const auto along_y = [](const Vec3d& x) { return x == Vec3d(0, 36, 0); };
    loads.held = {held_where(model, at_corner), held_where(model, along_x),
                  held_where(model, along_y)};
    loads.held[1].components = 6;
    loads.held[2].components = 4;
    loads.swelling_kpa.assign(model.volumes().element_count(), 2);
    const double stretch = 2 / model.moduli()[0].bulk_kpa / 3;
    const TetSolution solution = model.solve(loads, exact_params());
    EXPECT_LE(largest_difference(model, solution, [&](const Vec3d& x) { return x * stretch; }),
              1e-11);
    for (const ElementState& state : model.states(solution, loads)) {
      EXPECT_NEAR(state.volume_strain, 3 * stretch, 1e-12);
      for (const double of : state.stress_kpa) EXPECT_NEAR(of, 0, 1e-10);
    }
  }
}

// A gradient of pressure is a body force of minus that gradient, held by walls that let it slide.
TEST(UnitTetElements, APressureThatGrowsAlongABoxMovesItAsTheBarOfThatLoad) {
  for (const TetElement element : kTetElements) {
    SolidMesh mesh = tet_block(Vec3i(12, 2, 2), Vec3d(60, 10, 10));
    set_material(mesh, 6, 0);
    const TetModel model(mesh, element);
    TetLoads loads;
    for (const auto& tet : mesh.tets) {
      double x = 0;
      for (const std::int32_t node : tet) x += mesh.nodes_lps_mm[std::size_t(node)].x / 4;
      loads.swelling_kpa.push_back(0.01 * x);
    }
    loads.held.push_back(held_where(model, [](const Vec3d& x) { return x.x == 0; }));
    loads.held.back().components = 1;
    loads.held.push_back(held_where(model, [](const Vec3d&) { return true; }));
    loads.held.back().components = 6;
    const TetSolution solution = model.solve(loads, exact_params());
    // E u' = p(x): u(60) = 0.01 * 60^2 / 2 / E.
    double end = 0, count = 0;
    for (const NodeIndex node : model.nodes_of_faces("x+")) {
      end += solution.u_mm[3 * std::size_t(node)];
      ++count;
    }
    EXPECT_NEAR(end / count, 3, 0.005);
  }
}

// Ten nodes have the parabola of its displacement.
TEST(UnitTetElements, AColumnHangsUnderItsOwnWeight) {
  for (const TetElement element : kTetElements) {
    SolidMesh mesh = tet_block(Vec3i(1, 1, 8), Vec3d(10, 10, 80));
    set_material(mesh, 6, 0);
    const TetModel model(mesh, element);
    TetLoads loads;
    loads.held.push_back(held_where(model, [](const Vec3d& x) { return x.z == 80; }));
    loads.held.push_back(held_where(model, [](const Vec3d&) { return true; }));
    loads.held.back().components = 3;
    loads.gravity_m_s2 = Vec3d(0, 0, -9.81);
    loads.density_kg_m3 = {1000};
    const TetSolution solution = model.solve(loads, exact_params());
    const auto hung = [](const Vec3d& x) {
      const double z = 80 - x.z;
      return Vec3d(0, 0, -1e-6 * 9810 / 6 * (80 * z - z * z / 2));
    };
    const double allowed = element == TetElement::quadratic ? 1e-10 : 0.02;
    EXPECT_LE(largest_difference(model, solution, hung), allowed);
  }
}

TEST(UnitTetElements, LoadsOnFacesAndInBodiesAddUpAndBalanceReactions) {
  for (const TetElement element : kTetElements) {
    const TetModel model(perturbed_block(6, 0.3), element);
    EXPECT_NEAR(model.area_of_faces("surface"), 2 * (30 * 36 + 36 * 18 + 18 * 30), 1e-9);
    TetLoads loads;
    TetHeld held;
    held.nodes = model.nodes_of_faces("z-");
    loads.held.push_back(held);
    loads.pressures.push_back({"z+", 2});
    loads.gravity_m_s2 = Vec3d(0, 9.81, 0);
    loads.density_kg_m3 = {1040};
    loads.forces.push_back({model.nodes_of_faces("z+").front(), Vec3d(5, 0, 0)});
    const TetSolution solution = model.solve(loads);
    const double weight_mn = 1040e-9 * 30 * 36 * 18 * 9810;
    const Vec3d& reaction = solution.reactions[0].force_n;
    EXPECT_NEAR(reaction.x, 5e-3, 1e-7);
    EXPECT_NEAR(reaction.y, weight_mn * 1e-3, 1e-6);
    EXPECT_NEAR(reaction.z, -2 * 30 * 36 * 1e-3, 1e-6);
    EXPECT_LE(solution.report.force_balance, 1e-7);
    EXPECT_LE(solution.report.energy_identity, 1e-7);
  }
}

TEST(PropertyTetElements, ConjugateGradientsAndFactorsAgreeOnAnyNumberOfThreads) {
  for (const TetElement element : kTetElements) {
    SolidMesh mesh = tet_ball(4, 70);
    set_material(mesh, 6, 0.45);
    TetLoads loads;
    loads.swelling_kpa.assign(mesh.tets.size(), 1);
    const ElasticSheet dura{"surface", SheetKind::both, 2500, 0.48, 0.6};
    std::vector<TetSolution> solutions;
    for (const int threads : {1, 2, 5}) {
      on_threads(threads, [&] {
        const TetModel model(mesh, element, {dura});
        loads.held = {held_where(model, [](const Vec3d& x) { return x.z < -40; })};
        TetParams params;
        params.tolerance = 1e-10;
        params.reaction_tolerance = 1e-8;
        solutions.push_back(model.solve(loads, params));
        solutions.push_back(model.solve(loads, exact_params()));
      });
    }
    for (std::size_t n = 2; n < solutions.size(); ++n) {
      EXPECT_EQ(solutions[n].u_mm, solutions[n % 2].u_mm);
    }
    double most = 0, off = 0;
    for (std::size_t n = 0; n < solutions[0].u_mm.size(); ++n) {
      most = std::max(most, std::abs(solutions[0].u_mm[n]));
      off = std::max(off, std::abs(solutions[0].u_mm[n] - solutions[1].u_mm[n]));
    }
    EXPECT_LE(off, 1e-7 * most);
  }
}

TEST(FaultTetElements, MeshesAndLoadsThatCannotBeUsedAreRefused) {
  const SolidMesh good = tet_block(Vec3i(1), Vec3d(1));
  const auto refuses = [](SolidMesh mesh, const std::string& part) {
    try {
      const TetModel model(mesh, TetElement::linear, {{"z+", SheetKind::both, 2500, 0.48, 0.6}});
      TetLoads loads;
      loads.pressures.push_back({"z+", 1});
      model.solve(loads);
      ADD_FAILURE() << part;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  SolidMesh mesh = good;
  std::swap(mesh.tets[2][0], mesh.tets[2][1]);
  refuses(mesh, "tetrahedron 2: found -0.166667 mm³, expected a volume above 0");
  mesh = good;
  mesh.tets[1][3] = 8;
  refuses(mesh, "tetrahedron 1: found node 8, expected 0 to 7");
  mesh = good;
  mesh.hexes.push_back({0, 1, 3, 2, 4, 5, 7, 6});
  refuses(mesh, "1 hexahedra, expected tetrahedra alone");
  mesh = good;
  mesh.materials[0].poisson = 0.5;
  refuses(mesh, "material tissue, poisson: found 0.5");
  mesh = good;
  mesh.material_of = {0, 0, 0, 0, 0, 1};
  refuses(mesh, "material 1, expected 0 to 0");
  mesh = good;
  mesh.nodes_lps_mm.emplace_back(5, 5, 5);
  refuses(mesh, "node 8 of no element or sheet");
  mesh = good;
  mesh.faces.erase(mesh.faces.begin() + 5);
  refuses(mesh, "faces: found z+, expected x-, x+, y-, y+, z-, surface");
  refuses(good, "1 pieces of 6 elements that nothing holds");
}

TEST(FaultTetElements, LoadsThatAreNoNumbersAreRefused) {
  const TetModel model(tet_block(Vec3i(1), Vec3d(1)), TetElement::linear);
  TetLoads loads;
  loads.held.push_back({model.nodes_of_faces("z-")});
  loads.forces.push_back({7, Vec3d(std::nan(""), 0, 0)});
  EXPECT_THROW(model.solve(loads), InputError);
  loads.forces.clear();
  loads.held.front().displacement_mm = {Vec3d(0, 0, INFINITY)};
  EXPECT_THROW(model.solve(loads), InputError);
}

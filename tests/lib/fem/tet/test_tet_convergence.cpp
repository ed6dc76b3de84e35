// Orders of convergence of tetrahedra to smooth solutions.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/lib/fem/tet/tet_fixtures.h"
#include "tests/lib/fem_fixtures.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A displacement of a unit cube with curl and, unless nu is close to 1/2, divergence, that is 0
/// nowhere on the border; and its body force by the moduli.
struct SmoothField {
  double mu, lambda;

  static constexpr double kWave = 2.1;
  /// u = (sin kx cos ky + c, ...) of two parts: free of divergence, and with 1/lambda.
  Vec3d at(const Vec3d& x) const {
    const double k = kWave, s = 1 / (1 + lambda);
    return {std::sin(k * x.y) * std::cos(k * x.z) + s * std::sin(k * x.x),
            std::sin(k * x.z) * std::cos(k * x.x) + s * std::sin(k * x.y),
            std::sin(k * x.x) * std::cos(k * x.y) + s * std::sin(k * x.z)};
  }
  /// -div sigma. The first part is free of divergence and has -laplace u = 2 k^2 u; the second is a
  /// gradient: -div sigma = (lambda + 2 mu) k^2 u.
  Vec3d force_at(const Vec3d& x) const {
    const double k = kWave, s = 1 / (1 + lambda);
    const Vec3d pulled(s * std::sin(k * x.x), s * std::sin(k * x.y), s * std::sin(k * x.z));
    return (at(x) - pulled) * (2 * mu * k * k) + pulled * ((lambda + 2 * mu) * k * k);
  }
};

/// Points and weights of degree 5 on a tetrahedron (Keast 1986, 15 points).
struct PointRule {
  std::vector<std::array<double, 4>> points;
  std::vector<double> weights;

  PointRule() {
    add4(0.25, 0.030283678097089 * 6);
    add4(0.0, 0.006026785714286 * 6);
    add4(0.090909090909091, 0.011645249086029 * 6);
    const double b = 0.066550153573664, c = 0.5 - b;
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        std::array<double, 4> point{c, c, c, c};
        point[std::size_t(i)] = point[std::size_t(j)] = b;
        points.push_back(point);
        weights.push_back(0.010949141561386 * 6);
      }
    }
  }

 private:
  /// 0.25: the centre; 0: (1/3, 1/3, 1/3, 0); else (a, a, a, 1 - 3 a).
  void add4(double a, double weight) {
    if (a == 0.25) {
      points.push_back({a, a, a, a});
      weights.push_back(weight);
      return;
    }
    for (std::size_t n = 0; n < 4; ++n) {
      const double three = a == 0 ? 1.0 / 3 : a;
      std::array<double, 4> point{three, three, three, three};
      point[n] = 1 - 3 * three;
      points.push_back(point);
      weights.push_back(weight);
    }
  }
};

std::vector<double> shapes_of(std::size_t count, const std::array<double, 4>& at) {
  if (count == 4) return {at.begin(), at.end()};
  std::vector<double> out;
  for (const double l : at) out.push_back(l * (2 * l - 1));
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a + 1; b < 4; ++b) out.push_back(4 * at[a] * at[b]);
  }
  return out;
}

/// L2 norm of the error, with loads and errors by numerical integration.
double error_of(TetElement element, int n, double poisson) {
  SolidMesh mesh = tet_block(Vec3i(n), Vec3d(1), 0.15);
  set_material(mesh, 1, poisson);
  const TetModel model(mesh, element);
  const SmoothField field{model.moduli()[0].shear_kpa, model.moduli()[0].lambda_kpa()};
  static const PointRule rule;
  const auto visit = [&](const auto& at_point) {
    for (std::size_t e = 0; e < model.volumes().element_count(); ++e) {
      const std::size_t count = model.volumes().elements().count(e);
      const NodeIndex* nodes = model.volumes().elements().nodes(e);
      for (std::size_t p = 0; p < rule.points.size(); ++p) {
        Vec3d x(0);
        for (std::size_t c = 0; c < 4; ++c) {
          x += mesh.nodes_lps_mm[std::size_t(nodes[c])] * rule.points[p][c];
        }
        at_point(nodes, shapes_of(count, rule.points[p]),
                 rule.weights[p] * model.volumes().volume_mm3(e), x);
      }
    }
  };
  std::vector<Vec3d> force(model.place_count(), Vec3d(0));
  visit(
      [&](const NodeIndex* nodes, const std::vector<double>& shape, double weight, const Vec3d& x) {
        for (std::size_t m = 0; m < shape.size(); ++m) {
          force[std::size_t(nodes[m])] += field.force_at(x) * (shape[m] * weight);
        }
      });
  TetLoads loads;
  for (std::size_t m = 0; m < force.size(); ++m) loads.forces.push_back({NodeIndex(m), force[m]});
  loads.held.push_back(held_where(
      model,
      [](const Vec3d& x) {
        return std::min({x.x, x.y, x.z}) == 0 || std::max({x.x, x.y, x.z}) == 1;
      },
      [&](const Vec3d& x) { return field.at(x); }));
  TetParams params;
  params.limits = {180, 10};
  const TetSolution solution = model.solve(loads, params);
  double squares = 0;
  visit(
      [&](const NodeIndex* nodes, const std::vector<double>& shape, double weight, const Vec3d& x) {
        Vec3d u(0);
        for (std::size_t m = 0; m < shape.size(); ++m) {
          u += displacement_at(solution, std::size_t(nodes[m])) * shape[m];
        }
        squares += weight * (u - field.at(x)).length2();
      });
  return std::sqrt(squares);
}

std::vector<double> errors_of(TetElement element, double poisson, const std::vector<int>& sizes) {
  std::vector<double> errors;
  for (const int n : sizes) errors.push_back(error_of(element, n, poisson));
  return errors;
}

}  // namespace

TEST(ConvergenceTet, LinearTetrahedraAreOfSecondOrder) {
  const std::vector<double> orders = orders_of(errors_of(TetElement::linear, 0.3, {3, 6, 12}));
  RecordProperty("orders", ::testing::PrintToString(orders));
  EXPECT_GE(orders.back(), 1.85) << ::testing::PrintToString(orders);
}

TEST(ConvergenceTet, NodalPressureAndTenNodesDoNotLock) {
  const std::vector<double> nodal = errors_of(TetElement::nodal_pressure, 0.4999, {3, 6, 12});
  EXPECT_GE(orders_of(nodal).back(), 1.8) << ::testing::PrintToString(nodal);
  const std::vector<double> ten = errors_of(TetElement::quadratic, 0.4999, {2, 4, 8});
  EXPECT_GE(orders_of(ten).back(), 1.8) << ::testing::PrintToString(ten);
}

/// Sag of a cantilever's end under a force, of a mesh that is so fine.
double sag_of(TetElement element, int n) {
  SolidMesh mesh = tet_block(Vec3i(4 * n, n, n), Vec3d(40, 10, 10));
  set_material(mesh, 6, 0.4999);
  const TetModel model(mesh, element);
  TetLoads loads;
  loads.held.emplace_back().nodes = model.nodes_of_faces("x-");
  loads.pressures.push_back({"z+", 0.001});
  TetParams params = exact_params();
  params.tolerance = 1e-8;
  const TetSolution solution = model.solve(loads, params);
  double lowest = 0;
  for (std::size_t m = 0; m < model.place_count(); ++m) {
    lowest = std::min(lowest, displacement_at(solution, m).z);
  }
  return lowest;
}

TEST(ConvergenceTet, ABentBarLocksTheLinearElementAloneNearNuOfAHalf) {
  const double exact = sag_of(TetElement::quadratic, 4);
  EXPECT_NEAR(sag_of(TetElement::quadratic, 2) / exact, 1, 0.1);
  EXPECT_NEAR(sag_of(TetElement::nodal_pressure, 4) / exact, 1, 0.25);
  EXPECT_LT(sag_of(TetElement::linear, 4) / exact, 0.4);
}

TEST(ConvergenceTet, TenNodesAreOfThirdOrder) {
  const std::vector<double> errors = errors_of(TetElement::quadratic, 0.3, {2, 4, 8});
  EXPECT_GE(orders_of(errors).back(), 2.8) << ::testing::PrintToString(errors);
}

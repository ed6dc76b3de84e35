// Laws of sheets: appendix B as it is printed and as it is right, patches, folds, plates, spheres.
#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/lib/fem/tet/tet_fixtures.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/lib/test_bodies.h"
#include "volumes/base/units.h"

using namespace supple;
using namespace supple::test;

namespace {

using Eigen::MatrixXd;

/// A triangle in the plane of x and y, and the elastic constants of the Dura.
struct FlatTriangle {
  std::array<Vec3d, 3> corners{Vec3d(0.3, 0.2, 0), Vec3d(4.1, 0.9, 0), Vec3d(1.2, 3.6, 0)};
  double young = 2500, nu = 0.48, h = 0.6;

  double area() const {
    return (corners[1] - corners[0]).cross(corners[2] - corners[0]).length() / 2;
  }
  ElasticSheet sheet(SheetKind kind) const { return {"", kind, young, nu, h}; }
};

/// S_V of B.5 by unknowns u_x1, u_y1, u_x2 ...: as printed, or with the factor of plane stress.
MatrixXd membrane_of_appendix(const FlatTriangle& t, bool is_printed) {
  const double nu = t.nu, shear = (1 - nu) / 2;
  const double factor = t.h * t.area() * t.young / ((1 + nu) * (is_printed ? 1 - 2 * nu : 1 - nu));
  MatrixXd s = MatrixXd::Zero(6, 6), inverse = MatrixXd::Zero(6, 6);
  s(1, 1) = s(5, 5) = 1;
  s(1, 5) = s(5, 1) = nu;
  s(2, 2) = s(2, 4) = s(4, 2) = s(4, 4) = shear;
  for (int c = 0; c < 3; ++c) {
    for (int a = 0; a < 2; ++a) {
      inverse(2 * c + a, 3 * a) = 1;
      inverse(2 * c + a, 3 * a + 1) = t.corners[std::size_t(c)].x;
      inverse(2 * c + a, 3 * a + 2) = t.corners[std::size_t(c)].y;
    }
  }
  const MatrixXd a = inverse.inverse();
  return factor * a.transpose() * s * a;
}

/// S_B of B.8 and B.9 by unknowns w_1, w_2, w_3 and dw/dn at the middles of edges 12, 23, 31.
MatrixXd bending_of_appendix(const FlatTriangle& t, bool is_printed_factor, bool is_printed_edge) {
  const double nu = t.nu, h3 = t.h * t.h * t.h;
  const double factor =
      t.area() * t.young *
      (is_printed_factor ? h3 / 3 / ((1 + nu) * (1 - 2 * nu)) : h3 / 12 / ((1 + nu) * (1 - nu)));
  MatrixXd s = MatrixXd::Zero(6, 6), inverse(6, 6);
  s(3, 3) = s(5, 5) = 4;
  s(3, 5) = s(5, 3) = 4 * nu;
  s(4, 4) = 2 * (1 - nu);
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec3d &x = t.corners[c], &next = t.corners[(c + 1) % 3], middle = (x + next) / 2;
    const Vec3d n = (next - x).normalized().cross(Vec3d(0, 0, 1));  // outward
    inverse.row(int(c)) << 1, x.x, x.y, x.x * x.x, x.x * x.y, x.y * x.y;
    inverse.row(3 + int(c)) << 0, n.x, n.y, 2 * middle.x * n.x, middle.x * n.y + middle.y * n.x,
        (is_printed_edge ? 1 : 2) * middle.y * n.y;
  }
  const MatrixXd a = inverse.inverse();
  return factor * a.transpose() * s * a;
}

/// Rows and columns of the element for unknowns as in appendix B.
MatrixXd own_part(const FlatTriangle& t, SheetKind kind) {
  const TriangleMatrix all = triangle_stiffness(t.corners, t.sheet(kind));
  const bool bends = kind == SheetKind::bending;
  // Displacements by corner; of bending along z, and the turns, whose sign is opposite.
  const std::array<std::size_t, 6> at = bends ? std::array<std::size_t, 6>{2, 5, 8, 9, 10, 11}
                                              : std::array<std::size_t, 6>{0, 1, 3, 4, 6, 7};
  MatrixXd out(6, 6);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double sign = bends && (i < 3) != (j < 3) ? -1 : 1;
      out(i, j) = sign * all[at[std::size_t(i)]][at[std::size_t(j)]];
    }
  }
  return out;
}

double relative_difference(const MatrixXd& a, const MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

/// The deflection w = x^2 / 2 in unknowns of appendix B: its energy is F D / 2.
double energy_of_unit_curvature(const FlatTriangle& t, const MatrixXd& stiffness) {
  Eigen::VectorXd w(6);
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec3d &x = t.corners[c], &next = t.corners[(c + 1) % 3], middle = (x + next) / 2;
    const Vec3d n = (next - x).normalized().cross(Vec3d(0, 0, 1));
    w(int(c)) = x.x * x.x / 2;
    w(3 + int(c)) = middle.x * n.x;
  }
  return w.dot(stiffness * w) / 2;
}

SolidMesh irregular_box() {
  return sheet_mesh(tet_block({3, 4, 2}, {30, 36, 18}, 0.25), {"surface"});
}

/// Displacements and turns of u = slope x for a slope that keeps right angles between faces.
std::vector<double> box_motion(const TetModel& model, const Matrix9& slope) {
  const auto at = [&](const Vec3d& x) {
    return Vec3d(slope[0] * x.x + slope[1] * x.y + slope[2] * x.z,
                 slope[3] * x.x + slope[4] * x.y + slope[5] * x.z,
                 slope[6] * x.x + slope[7] * x.y + slope[8] * x.z);
  };
  std::vector<double> u;
  for (std::size_t n = 0; n < model.place_count(); ++n) {
    const Vec3d of = at(model.volumes().positions()[n]);
    u.insert(u.end(), {of.x, of.y, of.z});
  }
  const Vec3d turn(slope[7] - slope[5], slope[2] - slope[6], slope[3] - slope[1]);
  for (const auto& [a, b] : model.shells().edges()) {
    const auto& x = model.volumes().positions();
    const Vec3d along = (x[std::size_t(b)] - x[std::size_t(a)]).normalized();
    u.push_back(turn.dot(along) / 2);
  }
  u.resize(3 * std::size_t(model.node_count()), 0.0);
  return u;
}

std::vector<double> force_of(const TetModel& model, const std::vector<double>& u) {
  std::vector<double> force(u.size());
  model.stiffness().add(u.data(), force.data());
  return force;
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

constexpr SheetKind kKinds[] = {SheetKind::stretch, SheetKind::bending, SheetKind::both};

}  // namespace

TEST(UnitShellTriangles, AppendixBCorrectedIsTheElementAndAsPrintedIsNot) {
  const FlatTriangle t;
  const MatrixXd stretch = own_part(t, SheetKind::stretch), bend = own_part(t, SheetKind::bending);
  EXPECT_LE(relative_difference(stretch, membrane_of_appendix(t, false)), kRounding);
  EXPECT_LE(relative_difference(bend, bending_of_appendix(t, false, false)), 1e-11);
  // B.5 printed is 13 times too stiff at nu = 0.48, B.8 52 times.
  EXPECT_NEAR(relative_difference(membrane_of_appendix(t, true), stretch), 12, 1e-6);
  EXPECT_NEAR(relative_difference(bending_of_appendix(t, true, false), bend), 51, 1e-6);
}

TEST(UnitShellTriangles, AppendixBAsPrintedFailsTheTestsThatTheElementPasses) {
  const FlatTriangle t;
  // A uniaxial stretch e of a strip of width 1: its stress is E e / (1 - nu^2) with its width held.
  Eigen::VectorXd stretch(6);
  for (std::size_t c = 0; c < 3; ++c) {
    stretch(2 * int(c)) = t.corners[c].x;
    stretch(2 * int(c) + 1) = 0;
  }
  const double wanted = t.h * t.area() * t.young / (1 - t.nu * t.nu) / 2;
  const auto energy = [&](const MatrixXd& k) { return stretch.dot(k * stretch) / 2; };
  EXPECT_NEAR(energy(own_part(t, SheetKind::stretch)) / wanted, 1, kRounding);
  EXPECT_NEAR(energy(membrane_of_appendix(t, true)) / wanted, 13, 1e-6);
  // A unit curvature; the last column of B.9 as printed makes even that depend on the triangle.
  const double bent = t.area() * t.young * t.h * t.h * t.h / (12 * (1 - t.nu * t.nu)) / 2;
  EXPECT_NEAR(energy_of_unit_curvature(t, own_part(t, SheetKind::bending)) / bent, 1, 1e-10);
  EXPECT_NEAR(energy_of_unit_curvature(t, bending_of_appendix(t, true, false)) / bent, 52, 1e-6);
  FlatTriangle turned = t;
  for (Vec3d& x : turned.corners) x = Vec3d(-x.y, x.x, 0);
  // Turned by a right angle, the same sheet must have the same eigenvalues.
  const auto eigenvalues = [](const MatrixXd& k) {
    return Eigen::SelfAdjointEigenSolver<MatrixXd>(k).eigenvalues().eval();
  };
  const auto change = [&](bool is_printed_edge) {
    const Eigen::VectorXd a = eigenvalues(bending_of_appendix(t, false, is_printed_edge));
    const Eigen::VectorXd b = eigenvalues(bending_of_appendix(turned, false, is_printed_edge));
    return (a - b).cwiseAbs().maxCoeff() / a.cwiseAbs().maxCoeff();
  };
  EXPECT_LE(change(false), 1e-9);
  EXPECT_GT(change(true), 0.05);
}

TEST(PropertyShellTriangles, RigidMotionsOfAFoldedBoxAndNoOthersCostNothing) {
  for (const SheetKind kind : kKinds) {
    const TetModel model(irregular_box(), TetElement::linear, {{"sheet", kind, 2500, 0.48, 0.6}});
    const Matrix9 turn{0, -0.3, 0.2, 0.3, 0, -0.5, -0.2, 0.5, 0};
    const std::vector<double> u = box_motion(model, turn);
    const std::vector<float> diagonal = model.stiffness().diagonal();
    const double scale = largest(u) * double(*std::max_element(diagonal.begin(), diagonal.end()));
    EXPECT_LE(largest(force_of(model, u)), kRounding * scale);
    if (kind != SheetKind::both) continue;
    std::vector<int> used;  // components that are unknowns
    for (int n = 0; n < int(3 * model.place_count() + model.shells().edges().size()); ++n) {
      used.push_back(n);
    }
    MatrixXd dense(Eigen::Index(used.size()), Eigen::Index(used.size()));
    for (std::size_t n = 0; n < used.size(); ++n) {
      std::vector<double> unit(3 * std::size_t(model.node_count()), 0.0);
      unit[std::size_t(used[n])] = 1;
      const std::vector<double> column = force_of(model, unit);
      dense.col(Eigen::Index(n)) =
          Eigen::Map<const Eigen::VectorXd>(column.data(), Eigen::Index(used.size()));
    }
    const Eigen::VectorXd modes = Eigen::SelfAdjointEigenSolver<MatrixXd>(dense).eigenvalues();
    const double most = modes[modes.size() - 1];
    EXPECT_LE(std::abs(modes[5]), kRounding * most);
    EXPECT_GT(modes[6], 1e3 * kRounding * most);
  }
}

TEST(PropertyShellTriangles, AFoldedClosedSheetTakesTheConstantStrainOfItsEdges) {
  // Stretch along the box's axes, and a turn: right angles stay, every face is in plane stress.
  const Matrix9 slope{0.01, -0.02, 0.005, 0.02, -0.015, -0.01, -0.005, 0.01, 0.02};
  const TetModel model(irregular_box(), TetElement::linear,
                       {{"sheet", SheetKind::both, 2500, 0.48, 0.6}});
  const std::vector<double> wanted = box_motion(model, slope);
  const auto faces_at = [](const Vec3d& x) {
    return (x.x == 0 || x.x == 30) + (x.y == 0 || x.y == 36) + (x.z == 0 || x.z == 18);
  };
  TetLoads loads;
  loads.held.emplace_back().nodes =
      nodes_where(model, [&](const Vec3d& x) { return faces_at(x) > 1; });
  for (const NodeIndex node : loads.held[0].nodes) {
    const double* u = &wanted[3 * std::size_t(node)];
    loads.held[0].displacement_mm.emplace_back(u[0], u[1], u[2]);
  }
  const TetSolution solution = model.solve(loads, exact_params());
  double off = 0;
  for (std::size_t n = 0; n < wanted.size(); ++n) {
    off = std::max(off, std::abs(wanted[n] - solution.u_mm[n]));
  }
  EXPECT_LE(off, kRounding * largest(wanted));
  // Stresses of neighbouring faces balance at nothing but their common edge.
  const std::vector<double> force = force_of(model, wanted);
  for (std::size_t n = 0; n < model.place_count(); ++n) {
    if (faces_at(model.volumes().positions()[n]) > 1) continue;
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(force[3 * n + a], 0, 1e-9);
  }
}

TEST(UnitShellTriangles, ABoxOfSheetsAndTetrahedraTakesAnyConstantStrain) {
  const Matrix9 slope{0.01, -0.02, 0.005, 0.03, -0.015, 0.01, 0.02, 0.01, 0.02};
  for (const TetElement element :
       {TetElement::linear, TetElement::nodal_pressure, TetElement::quadratic}) {
    const TetModel model(tet_block({3, 4, 2}, {30, 36, 18}, 0.25), element,
                         {{"surface", SheetKind::stretch, 2500, 0.48, 0.6}});
    const std::vector<double> wanted = box_motion(model, slope);
    TetLoads loads;
    loads.held.emplace_back().nodes = model.nodes_of_faces("surface");
    for (const NodeIndex node : loads.held[0].nodes) {
      const double* u = &wanted[3 * std::size_t(node)];
      loads.held[0].displacement_mm.emplace_back(u[0], u[1], u[2]);
    }
    const TetSolution solution = model.solve(loads, exact_params());
    double off = 0;
    for (std::size_t n = 0; n < wanted.size(); ++n) {
      off = std::max(off, std::abs(wanted[n] - solution.u_mm[n]));
    }
    EXPECT_LE(off, kRounding * largest(wanted));
  }
}

namespace {

/// Deflection of the middle of a square plate under pressure by that of Kirchhoff's theory.
double plate_ratio(int n, bool is_clamped) {
  const double side = 100, h = 1, young = 1e5, nu = 0.3, pressure = 0.01;
  const SolidMesh mesh = sheet_mesh(tet_block({n, n, 1}, {side, side, 1}), {"z-"});
  const TetModel model(mesh, TetElement::linear, {{"sheet", SheetKind::both, young, nu, h}});
  TetLoads loads;
  loads.held.push_back(held_where(
      model, [&](const Vec3d& x) { return x.x == 0 || x.x == side || x.y == 0 || x.y == side; }));
  loads.held[0].holds_turns = is_clamped;
  loads.pressures.push_back({"sheet", pressure});
  const TetSolution solution = model.solve(loads, exact_params());
  const double stiffness = young * h * h * h / (12 * (1 - nu * nu));
  // Timoshenko & Woinowsky-Krieger, tables 8 and 35.
  const double factor = is_clamped ? 0.00126532 : 0.00406235;
  const auto middle =
      nodes_where(model, [&](const Vec3d& x) { return x.x == side / 2 && x.y == side / 2; });
  const double w = displacement_at(solution, std::size_t(middle.at(0))).z;
  return std::abs(w) / (factor * pressure * std::pow(side, 4) / stiffness);
}

/// Growth of a sphere's radius under pressure from within by p r^2 (1 - nu) / (2 E h).
double sphere_ratio(int n, SheetKind kind) {
  const double radius = 70, h = 0.6, young = 2500, nu = 0.48, pressure = 0.1;
  const SolidMesh mesh = sheet_mesh(tet_ball(n, radius), {"surface"});
  const TetModel model(mesh, TetElement::linear, {{"sheet", kind, young, nu, h}});
  TetLoads loads;
  // One octant's symmetry keeps it from moving as a rigid body.
  for (int a = 0; a < 3; ++a) {
    loads.held.push_back(held_where(model, [&](const Vec3d& x) { return std::abs(x[a]) < 1e-9; }));
    loads.held.back().components = std::uint8_t(1 << a);
  }
  loads.pressures.push_back({"sheet", -pressure});
  const TetSolution solution = model.solve(loads, exact_params());
  double sum = 0;
  for (std::size_t m = 0; m < model.place_count(); ++m) {
    sum += displacement_at(solution, m).dot(mesh.nodes_lps_mm[m].normalized());
  }
  const double wanted = pressure * radius * radius * (1 - nu) / (2 * young * h);
  return sum / double(model.place_count()) / wanted;
}

}  // namespace

TEST(ConvergenceShellTriangles, PlatesBendAsKirchhoffsTheorySays) {
  for (const bool is_clamped : {false, true}) {
    std::vector<double> errors;
    for (const int n : {8, 16, 32}) errors.push_back(plate_ratio(n, is_clamped) - 1);
    EXPECT_LE(std::abs(errors.back()), 0.025) << ::testing::PrintToString(errors);
    EXPECT_GE(orders_of(errors).back(), 1.7) << ::testing::PrintToString(errors);
  }
}

// The mesh has the edges of a cube, along which triangles stay distorted as it gets finer.
TEST(ConvergenceShellTriangles, SpheresUnderPressureGrowAsMembranesDo) {
  for (const SheetKind kind : {SheetKind::stretch, SheetKind::both}) {
    std::vector<double> errors;
    for (const int n : {4, 8, 16}) errors.push_back(sphere_ratio(n, kind) - 1);
    EXPECT_LE(std::abs(errors.back()), 0.01) << ::testing::PrintToString(errors);
    EXPECT_GE(orders_of(errors).back(), 1.4) << ::testing::PrintToString(errors);
  }
}

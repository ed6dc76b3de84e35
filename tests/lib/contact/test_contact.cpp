// Contact of nodes with shapes and meshes.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "lib/contact/mesh_surface.h"
#include "lib/springs/integrators.h"
#include "lib/springs/mesh_springs.h"
#include "tests/lib/spring_fixtures.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

Vec3d random_vector(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> pick(-reach, reach);
  return {pick(random), pick(random), pick(random)};
}

/// An axis-parallel box from -half to half as twelve triangles that face outwards.
TriangleMesh centred_box(const Vec3d& half) {
  TriangleMesh mesh;
  for (int n = 0; n < 8; ++n) {
    mesh.vertices_lps_mm.push_back(half * Vec3d(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1));
  }
  for (const std::array<int, 4>& f : {std::array<int, 4>{0, 4, 6, 2},
                                      {1, 3, 7, 5},
                                      {0, 1, 5, 4},
                                      {2, 6, 7, 3},
                                      {0, 2, 3, 1},
                                      {4, 5, 7, 6}}) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  return mesh;
}

std::unique_ptr<SpringIntegrator> integrator_of(int kind, SpringSystem& system) {
  return make_integrator(SpringMethod(kind), system);
}

}  // namespace

TEST(UnitContact, AShiftedShapeIsTheSameElsewhere) {
  std::mt19937 random(5);
  const auto surface = std::make_shared<MeshSurface>(centred_box({1, 2, 3}));
  const Shape shapes[] = {SphereShape{{1, 0, 0}, 2}, PlaneShape{{0, 0, 3}, {0, 0.6, -0.8}},
                          CapsuleShape{{0, 0, 0}, {4, 1, 0}, 1},
                          BoxShape{{1, 1, 0}, {Vec3d(2, 0, 0), Vec3d(0, 3, 0), Vec3d(0, 0, 1)}},
                          MeshShape{surface, {1, 0, 0}}};
  for (const Shape& shape : shapes) {
    const Vec3d by = random_vector(random, 3), at = random_vector(random, 6);
    const SurfaceDistance before = distance_to(shape, at);
    const SurfaceDistance after = distance_to(shifted(shape, by), at + by);
    EXPECT_NEAR(after.distance_mm, before.distance_mm, 1e-12) << shape.index();
    EXPECT_LT((after.normal - before.normal).length(), 1e-12) << shape.index();
  }
}

TEST(UnitContact, DistancesToShapesAreThoseByHand) {
  const auto is = [](const SurfaceDistance& d, double distance, const Vec3d& normal) {
    EXPECT_NEAR(d.distance_mm, distance, 1e-12);
    EXPECT_LT((d.normal - normal).length(), 1e-12);
  };
  is(distance_to(SphereShape{{1, 0, 0}, 2}, {1, 5, 0}), 3, {0, 1, 0});
  is(distance_to(SphereShape{{1, 0, 0}, 2}, {0, 0, 0}), -1, {-1, 0, 0});
  is(distance_to(PlaneShape{{0, 0, 3}, {0, 0, -1}}, {7, 7, 5}), -2, {0, 0, -1});
  const CapsuleShape capsule{{0, 0, 0}, {10, 0, 0}, 1};
  is(distance_to(capsule, {4, 3, 0}), 2, {0, 1, 0});
  is(distance_to(capsule, {13, 4, 0}), 4, {0.6, 0.8, 0});
  is(distance_to(capsule, {4, 0, -0.5}), -0.5, {0, 0, -1});
  const BoxShape box{{0, 0, 0}, {Vec3d(2, 0, 0), Vec3d(0, 3, 0), Vec3d(0, 0, 4)}};
  is(distance_to(box, {-5, 0, 0}), 3, {-1, 0, 0});
  is(distance_to(box, {5, 7, 0}), 5, {0.6, 0.8, 0});
  is(distance_to(box, {1.5, 0, 0}), -0.5, {1, 0, 0});
}

TEST(PropertyContact, AMeshOfABoxHasTheDistancesOfTheBox) {
  std::mt19937 random(31);
  const BoxShape box{{1, 2, 3}, {Vec3d(2, 0, 0), Vec3d(0, 3, 0), Vec3d(0, 0, 4)}};
  // Corners stored anew for each triangle, as in STL files.
  const TriangleMesh shared = centred_box({2, 3, 4});
  TriangleMesh soup;
  for (const auto& t : shared.triangles) {
    const int first = int(soup.vertices_lps_mm.size());
    for (const int n : t) soup.vertices_lps_mm.push_back(shared.vertices_lps_mm[n]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const MeshShape mesh{std::make_shared<MeshSurface>(soup), {1, 2, 3}};
  for (int n = 0; n < 3000; ++n) {
    const Vec3d p = random_vector(random, n % 2 == 0 ? 8 : 4);
    const SurfaceDistance a = distance_to(box, p), b = distance_to(mesh, p);
    ASSERT_NEAR(a.distance_mm, b.distance_mm, 1e-9);
    ASSERT_LT((a.normal - b.normal).length(), 1e-6);
  }
}

TEST(PropertyContact, AMeshFindsItsNearestTriangleAmongMany) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(37);
  TriangleMesh mesh = sheet(20, 20, 1);
  for (Vec3d& v : mesh.vertices_lps_mm) v.z = std::sin(v.x) * std::cos(v.y);
  const MeshSurface surface(mesh);
  for (int n = 0; n < 300; ++n) {
    const Vec3d p = random_vector(random, 12) + Vec3d(10, 10, 0);
    // Brute force: points sampled on every triangle bound the distance from above.
    double sampled = 1e9;
    for (const auto& t : mesh.triangles) {
      for (int i = 0; i <= 8; ++i) {
        for (int j = 0; i + j <= 8; ++j) {
          const Vec3d& a = mesh.vertices_lps_mm[t[0]];
          const Vec3d q = a + (mesh.vertices_lps_mm[t[1]] - a) * (i / 8.0) +
                          (mesh.vertices_lps_mm[t[2]] - a) * (j / 8.0);
          sampled = std::min(sampled, (p - q).length());
        }
      }
    }
    const double distance = std::abs(surface.distance_to(p).distance_mm);
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_GE(distance, sampled - 0.15);
  }
}

TEST(PropertyContact, NoNodeIsLeftInsideAShape) {
  LEFT_OUT_WHEN_SANITIZED();
  for (int kind = 0; kind < 4; ++kind) {
    MeshSpringParams params;
    params.bending_n_m = 1;
    params.mass_damping_per_s = 2;
    SpringSystem system = make_springs(make_mesh_body(sheet(11, 11, 1)), params);
    system.gravity_m_s2 = {0, 0, -9.81};
    // A sheet falls onto a ball, a rod, a box, a box of triangles and the floor.
    system.colliders = {
        {SphereShape{{2.5, 2.5, -3}, 2}, 0.1, 0.4},
        {CapsuleShape{{9, 0, -2}, {9, 10, -4}, 1}},
        {BoxShape{{5, 9, -5}, {Vec3d(2, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 2)}}},
        {MeshShape{std::make_shared<MeshSurface>(centred_box({1, 1, 1})), {5, 5, -4}}, 0.15, 0.2},
        {PlaneShape{{0, 0, -6}, {0, 0, 1}}, 0.05, 0.3}};
    const std::unique_ptr<SpringIntegrator> integrator = integrator_of(kind, system);
    int contacts = 0;
    for (int frame = 0; frame < 80; ++frame) {
      const SpringStepReport report = integrator->step(0.004);
      contacts += report.contacts;
      for (const Vec3d& p : system.pos_mm) {
        for (const Collider& collider : system.colliders) {
          const double depth = collider.thickness_mm - distance_to(collider.shape, p).distance_mm;
          ASSERT_LE(depth, std::max(1e-8, report.penetration_mm + 1e-9))
              << "integrator " << kind << " frame " << frame;
        }
      }
      ASSERT_LE(report.penetration_mm, 1e-3);
    }
    EXPECT_GT(contacts, 500);
  }
}

TEST(PropertyContact, FrictionHoldsOnGentleSlopesAndSlowsOnSteepOnes) {
  // A slope of 30 degrees: mu below tan 30 = 0.577 slides with g (sin - mu cos), above it rests.
  const double slope = M_PI / 6, g = 9810;
  const Vec3d down(std::cos(slope), 0, -std::sin(slope)), up(std::sin(slope), 0, std::cos(slope));
  for (int kind = 0; kind < 4; ++kind) {
    for (const double mu : {0.0, 0.3, 0.7}) {
      SpringSystem system = oscillator(1e-3, 0, 0, 5, 0);
      system.springs.clear();
      system.pos_mm[1] = Vec3d(0.0);
      hold(system, 0);
      system.gravity_m_s2 = {0, 0, -9.81};
      system.colliders = {{PlaneShape{Vec3d(0.0), up}, 0, mu}};
      const std::unique_ptr<SpringIntegrator> integrator = integrator_of(kind, system);
      run_steps(*integrator, 1e-3, 200);
      const double slides = g * (std::sin(slope) - mu * std::cos(slope)) * 0.2 * 0.2 / 2;
      const double expected = mu > 0.577 ? 0 : slides;
      EXPECT_NEAR(down.dot(system.pos_mm[1]), expected, 0.01 * expected + 1e-9)
          << "integrator " << kind << " mu " << mu;
      EXPECT_NEAR(up.dot(system.pos_mm[1]), 0, 1e-9);
    }
  }
}

TEST(UnitContact, ANodeThatLandsKeepsItsVelocityAlongTheSurfaceOnly) {
  for (int kind = 0; kind < 4; ++kind) {
    SpringSystem system = oscillator(1e-3, 0, 0, 5, 0);
    system.velocity_mm_s[1] = {7, 0, -100};
    system.colliders = {{PlaneShape{{0, 0, -0.25}, {0, 0, 1}}}};
    const std::unique_ptr<SpringIntegrator> integrator = integrator_of(kind, system);
    run_steps(*integrator, 1e-3, 10);
    EXPECT_NEAR(system.pos_mm[1].z, -0.25, 1e-9);
    EXPECT_LT((system.velocity_mm_s[1] - Vec3d(7, 0, 0)).length(), 1e-6) << kind;
  }
}

TEST(UnitContact, ImplicitEulerHandsThePressureOfAShapeOn) {
  // A column between a held end and a plate that comes by 1.6 of its 8 mm: at rest every spring is
  // shorter by a fifth, and the holder feels the plate.
  SpringSystem system = chain(5, 1e-6, 100, 2);
  hold(system, 0);
  system.colliders = {{PlaneShape{{6.4, 0, 0}, {-1, 0, 0}}}};
  const std::unique_ptr<SpringIntegrator> integrator = integrator_of(1, system);
  const SpringStepReport report = integrator->step(10);
  for (int n = 0; n < 5; ++n) EXPECT_NEAR(system.pos_mm[n].x, 1.6 * n, 1e-3) << n;
  EXPECT_NEAR(integrator->reactions_n()[0].x, -100 * 0.4 * 1e-3, 4e-5);
  EXPECT_EQ(report.contacts, 2);  // put out as the step began, and pressed at its end
}

TEST(UnitContact, ABeltTakesAlongWhatLiesOnIt) {
  for (int kind = 0; kind < 4; ++kind) {
    SpringSystem system = oscillator(1e-3, 0, 0, 5, 0);
    system.gravity_m_s2 = {0, 0, -10};
    Collider belt{PlaneShape{Vec3d(0.0), {0, 0, 1}}};
    belt.friction = 0.5;
    belt.velocity_mm_s = {0, 200, 0};
    system.colliders = {belt};
    const std::unique_ptr<SpringIntegrator> integrator = integrator_of(kind, system);
    run_steps(*integrator, 1e-3, 20);  // mu g = 5 m/s^2
    EXPECT_NEAR(system.velocity_mm_s[1].y, 100, 1) << kind;
    run_steps(*integrator, 1e-3, 40);
    EXPECT_NEAR(system.velocity_mm_s[1].y, 200, 1e-6) << kind;
  }
}

TEST(UnitContact, FrictionStretchesAStiffSpringByNoMoreThanItsForce) {
  // A node on a belt that draws it away from a held one: mu m g = k times what it stretches.
  for (int kind = 0; kind < 2; ++kind) {
    SpringSystem system = oscillator(1e-3, 1000, 2, 5, 0);
    hold(system, 0);
    system.gravity_m_s2 = {0, 0, -10};
    Collider belt{PlaneShape{Vec3d(0.0), {0, 0, 1}}};
    belt.friction = 0.5;
    belt.velocity_mm_s = {200, 0, 0};
    system.colliders = {belt};
    run_steps(*integrator_of(kind, system), 0.01, 50);
    EXPECT_NEAR(system.pos_mm[1].x - 5, 0.005, 1e-5) << kind;
  }
}

TEST(UnitContact, ANodeThatStartsInsideIsPutOutWithoutAVelocity) {
  for (int kind = 0; kind < 4; ++kind) {
    SpringSystem system = oscillator(1e-3, 0, 0, 5, 0);
    system.colliders = {{SphereShape{{4, 0, 0}, 3}}};  // the held node at the origin stays
    const std::unique_ptr<SpringIntegrator> integrator = integrator_of(kind, system);
    EXPECT_GT(integrator->step(1e-3).contacts, 0);
    EXPECT_LT((system.pos_mm[1] - Vec3d(7, 0, 0)).length(), 1e-9);
    EXPECT_LT(system.velocity_mm_s[1].length(), 1e-6);
    EXPECT_EQ(system.pos_mm[0], Vec3d(0.0));
  }
}

TEST(UnitContact, ShapesThatAreNoneAreRefused) {
  EXPECT_NE(input_error([] { validate({PlaneShape{{0, 0, 0}, {0, 0, 2}}}); }), "");
  EXPECT_NE(input_error([] { validate({CapsuleShape{{0, 0, 0}, {1, 0, 0}, -1}}); }), "");
  EXPECT_NE(input_error([] { validate({MeshShape{}}); }), "");
  EXPECT_NE(input_error([] { validate({SphereShape{{0, 0, 0}, 1}, -0.1}); }), "");
  EXPECT_NE(input_error([] {
              validate({BoxShape{{0, 0, 0}, {Vec3d(1, 0, 0), Vec3d(1, 1, 0), Vec3d(0, 0, 1)}}});
            }),
            "");
  EXPECT_NE(input_error([] { MeshSurface({{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}}); }), "");
}

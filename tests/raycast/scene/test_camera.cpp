// Cameras: rays by hand, framing, and orientation in the patient's frame.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "raycast/drawings/slice_grid.h"
#include "raycast/scene/camera.h"
#include "raycast/scene/view_volume.h"
#include "volumes/base/error.h"

namespace supple {
namespace {

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-12) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "component " << c;
}

Camera from_anterior() {
  Camera camera;
  camera.position_lps_mm = {0, -100, 0};
  camera.target_lps_mm = {0, 0, 0};
  camera.vertical_fov_degrees = 90;
  camera.height_mm = 20;
  return camera;
}

TEST(UnitCamera, CentralPerspectiveRayLooksAtTheTarget) {
  const Ray ray = camera_ray(from_anterior(), 4, 2, 2, 1);
  expect_near(ray.origin_lps_mm, {0, -100, 0});
  expect_near(ray.direction_lps, {0, 1, 0});
}

TEST(UnitCamera, PerspectiveRayThroughTheTopRightCornerByHand) {
  // 90 degrees: half the height subtends 45 degrees; width twice the height.
  const Ray ray = camera_ray(from_anterior(), 4, 2, 4, 0);
  expect_near(ray.direction_lps, Vec3d(2, 1, 1) / std::sqrt(6.0));
}

TEST(UnitCamera, OrthographicRaysAreParallelAndSpacedByPixels) {
  Camera camera = from_anterior();
  camera.projection = Projection::orthographic;
  const Ray ray = camera_ray(camera, 10, 10, 0.5, 9.5);
  expect_near(ray.origin_lps_mm, {-9, -100, -9});
  expect_near(ray.direction_lps, {0, 1, 0});
}

TEST(UnitCamera, AnteriorViewShowsThePatientsLeftOnThePicturesRightAndSuperiorUp) {
  const Geometry geometry({10, 10, 10}, {-5, -5, -5}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const Camera camera = default_camera(geometry, 1.0);
  double left_x = 0, left_y = 0, top_x = 0, top_y = 0;
  ASSERT_TRUE(project_to_pixel(camera, 100, 100, {3, 0, 0}, left_x, left_y));
  ASSERT_TRUE(project_to_pixel(camera, 100, 100, {0, 0, 3}, top_x, top_y));
  EXPECT_GT(left_x, 55);
  EXPECT_LT(top_y, 45);
  EXPECT_LT(camera.position_lps_mm.y, -5);
}

TEST(UnitCamera, InvalidCamerasAreRejectedByName) {
  const auto field_of = [](const Camera& camera) {
    try {
      camera.validate("c.toml");
    } catch (const InputError& error) {
      return error.problem().field;
    }
    return std::string("valid");
  };
  EXPECT_EQ(field_of(Camera()), "valid");
  Camera camera;
  camera.position_lps_mm = camera.target_lps_mm;
  EXPECT_EQ(field_of(camera), "camera.position");
  camera = Camera();
  camera.up_lps = {0, 2, 0};
  EXPECT_EQ(field_of(camera), "camera.up");
  camera = Camera();
  camera.up_lps = {0, 0, 0};
  EXPECT_EQ(field_of(camera), "camera.up");
  camera = Camera();
  camera.vertical_fov_degrees = 180;
  EXPECT_EQ(field_of(camera), "camera.fov");
  camera = Camera();
  camera.target_lps_mm.x = NAN;
  EXPECT_EQ(field_of(camera), "camera.target");
  EXPECT_THROW(default_camera(Geometry(), 1.0, "oblique"), InputError);
}

TEST(PropertyCamera, ProjectionInvertsTheRays) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    Camera camera;
    camera.projection = projection;
    camera.position_lps_mm = {30, -200, 70};
    camera.target_lps_mm = {-4, 5, 6};
    camera.up_lps = {0.2, 0.1, 1};
    for (const auto& [px, py] : {std::pair(0.5, 0.5), {31.7, 80.2}, {99.0, 12.25}}) {
      const Ray ray = camera_ray(camera, 120, 90, px, py);
      double qx = 0, qy = 0;
      ASSERT_TRUE(
          project_to_pixel(camera, 120, 90, ray.origin_lps_mm + ray.direction_lps * 150.0, qx, qy));
      EXPECT_NEAR(qx, px, 1e-9);
      EXPECT_NEAR(qy, py, 1e-9);
    }
  }
}

TEST(PropertyCamera, EveryNamedViewFramesTheBoxWithItsMargin) {
  const Geometry geometry({40, 30, 20}, {7, -3, 100},
                          {Vec3d(-0.9, 0.1, 0), {0, 1.1, 0.2}, {0.1, 0, 2.5}});
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    for (const std::string& view : view_names()) {
      for (const double aspect : {0.5, 1.0, 2.0}) {
        const int height = 200, width = int(height * aspect);
        const Camera camera = default_camera(geometry, aspect, view, projection);
        EXPECT_NO_THROW(camera.validate(""));
        double tightest = 1e9;
        for (int c = 0; c < 8; ++c) {
          const Vec3d corner((c & 1) ? 39.5 : -0.5, (c & 2) ? 29.5 : -0.5, (c & 4) ? 19.5 : -0.5);
          double px = 0, py = 0;
          ASSERT_TRUE(
              project_to_pixel(camera, width, height, geometry.world_from_index(corner), px, py));
          tightest = std::min({tightest, px / width, 1 - px / width, py / height, 1 - py / height});
        }
        EXPECT_NEAR(tightest, 0.05, 1e-9) << view << ", aspect " << aspect;
      }
    }
  }
}

/// A sheared, left-handed grid and a camera somewhere around it, of either kind.
struct RandomView {
  explicit RandomView(std::mt19937& random) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto place = [&](double size) {
      return Vec3d(unit(random), unit(random), unit(random)) * size;
    };
    camera.projection = unit(random) < 0 ? Projection::perspective : Projection::orthographic;
    camera.position_lps_mm = place(60);
    camera.target_lps_mm = place(30);
    camera.vertical_fov_degrees = 40 + 30 * unit(random);
    camera.height_mm = 30 + 20 * unit(random);
    camera.window_shift = 0.5 * unit(random);
    width = 60 + int(30 * unit(random));
  }

  const Geometry geometry{
      {40, 30, 20}, {7, -3, 10}, {Vec3d(-0.9, 0.1, 0), {0, 1.1, 0.2}, {0.1, 0, 2.5}}};
  Camera camera;
  int width, height = 60;
};

TEST(PropertyViewVolume, APointIsSeenWhereItsPixelLiesInThePicture) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> coordinate(-10, 50);
  int seen = 0, hidden = 0;
  for (int n = 0; n < 200; ++n) {
    const RandomView view(random);
    const ViewVolume volume(view.camera, double(view.width) / view.height, view.geometry);
    for (int m = 0; m < 50; ++m) {
      const Vec3d place(coordinate(random), coordinate(random), coordinate(random));
      double px = 0, py = 0;
      const bool is_inside = project_to_pixel(view.camera, view.width, view.height,
                                              view.geometry.world_from_index(place), px, py) &&
                             px >= 0 && px <= view.width && py >= 0 && py <= view.height;
      EXPECT_EQ(volume.meets(place, place), is_inside);
      (is_inside ? seen : hidden) += 1;
    }
  }
  EXPECT_GT(seen, 500);
  EXPECT_GT(hidden, 500);
}

TEST(PropertyViewVolume, ASliceShowsWhatLiesWithinHalfOfItsThickness) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> coordinate(-10, 50), part(0.1, 1);
  int seen = 0;
  for (int n = 0; n < 200; ++n) {
    const Geometry geometry = RandomView(random).geometry;
    const Vec3d normal(part(random), -part(random), part(random));
    const Vec3d through(30 * part(random), 20 * part(random), 15 * part(random));
    const double thickness_mm = 20 * part(random);
    const Geometry slice = slice_grid(geometry, oblique_axes(normal, {}), through, 1);
    const ViewVolume volume(slice, thickness_mm, geometry);
    for (int m = 0; m < 50; ++m) {
      const Vec3d place(coordinate(random), coordinate(random), coordinate(random));
      const Vec3d from = geometry.world_from_index(place) - geometry.world_from_index(through);
      const bool is_within = std::abs(from.dot(normal.normalized())) <= thickness_mm / 2;
      EXPECT_EQ(volume.meets(place, place), is_within);
      seen += is_within;
    }
  }
  EXPECT_GT(seen, 500);
}

TEST(PropertyViewVolume, EveryBoxThatARayPassesThroughIsMet) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-10, 50), part(0, 1);
  int left_out = 0;
  for (int n = 0; n < 200; ++n) {
    const RandomView view(random);
    const ViewVolume volume(view.camera, double(view.width) / view.height, view.geometry);
    for (int m = 0; m < 20; ++m) {
      const Ray ray = camera_ray(view.camera, view.width, view.height, part(random) * view.width,
                                 part(random) * view.height);
      const Vec3d on_ray =
          view.geometry.index_from_world(ray.origin_lps_mm + ray.direction_lps * 90 * part(random));
      const Vec3d below(8 * part(random), 8 * part(random), 8 * part(random));
      EXPECT_TRUE(volume.meets(on_ray - below, on_ray - below + Vec3d(8)));
      const Vec3d corner(coordinate(random), coordinate(random), coordinate(random));
      left_out += !volume.meets(corner, corner + Vec3d(8));
    }
  }
  EXPECT_GT(left_out, 1000);
}

TEST(PropertyCamera, MatricesLeadWhereRaysDo) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> coordinate(-40, 40);
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    Camera camera = from_anterior();
    camera.projection = projection;
    camera.position_lps_mm = {30, -120, 25};
    camera.up_lps = {0.2, 0.1, 1};
    camera.height_mm = 90;
    camera.vertical_fov_degrees = 40;
    camera.window_shift = 0.15;
    const auto matrices = camera_matrices(camera, 320, 200);
    const auto through = [](const std::array<double, 16>& m, const Vec3d& p) {
      std::array<double, 4> result{};
      for (std::size_t c = 0; c < 4; ++c) {
        result[c] = p.x * m[c] + p.y * m[4 + c] + p.z * m[8 + c] + m[12 + c];
      }
      return result;
    };
    for (int n = 0; n < 50; ++n) {
      const Vec3d place(coordinate(random), coordinate(random), coordinate(random));
      double px = 0, py = 0;
      ASSERT_TRUE(project_to_pixel(camera, 320, 200, place, px, py));
      const auto picture = through(matrices[1], place), local = through(matrices[0], place);
      EXPECT_NEAR(picture[0] / picture[3], px / 320, 1e-12);
      EXPECT_NEAR(picture[1] / picture[3], py / 200, 1e-12);
      EXPECT_NEAR(local[2], (place - camera.position_lps_mm).dot(camera_frame(camera).forward),
                  1e-10);
      EXPECT_NEAR(local[0], (place - camera.position_lps_mm).dot(camera_frame(camera).right),
                  1e-10);
      EXPECT_EQ(local[3], 1);
    }
  }
}

}  // namespace
}  // namespace supple

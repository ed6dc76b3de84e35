// Light under the microscope: the lamp's strength, sheets that dim it, haze and balls in their
// order; and that nothing depends on threads or fails to return.
#include <gtest/gtest.h>
#include <unistd.h>

#include "raycast/sample/sample_batch.h"
#include "tests/raycast/microscope/microscope_scenes.h"
#include "volumes/base/parallel.h"

namespace supple {
namespace {

/// A haze that absorbs and scatters the same everywhere behind a plane across the view.
struct EvenHaze : HazeLayer {
  double per_mm = 0.05, start_mm = 190;
  double colour = 0.4;
  int calls = 0;
  double opacity(double depth_mm) const {
    return 1 - std::exp(-per_mm * std::max(depth_mm - start_mm, 0.0));
  }
  FloatImage draw(const Camera&, const RayDepths& depths) override {
    ++calls;
    FloatImage picture(depths.width, depths.height);
    for (std::size_t n = 0; n < depths.mm.size(); ++n) {
      const double a = opacity(depths.mm[n]);
      for (std::size_t c = 0; c < 3; ++c) picture.rgba[4 * n + c] = float(colour * a);
      picture.rgba[4 * n + 3] = float(a);
    }
    return picture;
  }
};

double depth_of(const Camera& camera, const MicroscopeSettings& settings, int x, int y) {
  return far_side(camera_ray(camera, settings.width, settings.height, x + 0.5, y + 0.5), {0, 0, 0},
                  11);
}

TEST(PropertyMicroscopeLight, TheRetinaIsLitByTheSquareOfTheDistanceAndTheCosine) {
  Microscope microscope;
  microscope.set_globe(grey_globe());
  LampLight lamp = aside_lamp();
  lamp.power = 0.7;
  microscope.set_lamp(lamp);
  MicroscopeSettings settings = small_picture();
  settings.ambient = 0.02;
  const Camera camera = eye_camera();
  const Image picture = picture_by(microscope, camera, settings);
  const Vec3d light = lamp.place_mm + lamp.direction * 0.03;
  int lit = 0, dark = 0;
  for (int y = 1; y < settings.height; y += 6) {
    for (int x = 1; x < settings.width; x += 6) {
      const Ray ray = camera_ray(camera, settings.width, settings.height, x + 0.5, y + 0.5);
      const Vec3d place = ray.origin_lps_mm + ray.direction_lps * far_side(ray, {0, 0, 0}, 11);
      const Vec3d way = light - place;
      const double angle = std::acos(-way.normalized().dot(lamp.direction)) * kDegreesPerRadian;
      if (angle > lamp.cone_degrees - lamp.edge_degrees && angle < lamp.cone_degrees) continue;
      const double cosine = way.normalized().dot(-place.normalized());
      const double lamp_part =
          angle > lamp.cone_degrees ? 0 : 0.7 * 65 / (way.length2() + 1) * cosine;
      const double expected = byte_from_light(grey_albedo() * (lamp_part + 0.02));
      EXPECT_NEAR(picture.rgba[4 * (std::size_t(y) * settings.width + x)], expected, 1.01);
      ++(angle > lamp.cone_degrees ? dark : lit);
    }
  }
  EXPECT_GT(lit, 200);
  EXPECT_GT(dark + lit, 400);
}

TEST(PropertyMicroscopeLight, ASheetThatDimsLetsItsPartPassAndOneThatBlocksNone) {
  const Camera camera = eye_camera();
  MicroscopeSettings settings = small_picture();
  settings.ambient = 0;
  const auto light_behind = [&](bool has_sheet, bool blocks, double dims) {
    Microscope microscope;
    microscope.set_globe(grey_globe());
    LampLight lamp = aside_lamp();
    microscope.set_lamp(lamp);
    SurfaceLook glass;
    glass.opacity = 0, glass.specular = 0;
    glass.casts_shadow = blocks, glass.dims = dims;
    const SoftSheet sheet = flat_sheet(3, -7);
    const int soft = microscope.add_soft(glass);
    if (has_sheet) microscope.reshape(soft, sheet.vertices, sheet.triangles);
    return light_at(picture_by(microscope, camera, settings), 83, 57);
  };
  const double clear = light_behind(false, false, 1);
  EXPECT_GT(clear, 0.1);
  EXPECT_NEAR(light_behind(true, false, 1), clear, 0.01);
  EXPECT_NEAR(light_behind(true, false, 0.5), 0.5 * clear, 0.01);
  EXPECT_NEAR(light_behind(true, true, 1), 0, 1e-6);
}

TEST(PropertyMicroscopeLight, ASheetOfOpacityShowsItsPartOfWhatIsBehind) {
  Microscope microscope;
  microscope.set_globe(grey_globe());
  SurfaceLook black;
  black.rgb = {0, 0, 0}, black.opacity = 0.3;
  const SoftSheet near = flat_sheet(3, -5), far = flat_sheet(3, -7);
  microscope.reshape(microscope.add_soft(black), near.vertices, near.triangles);
  microscope.reshape(microscope.add_soft(black), far.vertices, far.triangles);
  MicroscopeSettings settings = small_picture();
  settings.ambient = 0.8;
  const Image picture = picture_by(microscope, eye_camera(), settings);
  EXPECT_NEAR(light_at(picture, 81, 62), 0.49 * 0.8 * grey_albedo(), 0.01);
}

TEST(PropertyMicroscopeLight, AThinSheetMirrorsByItsOpacityWhichGrowsWithItsWayThrough) {
  const auto mirrored = [](double opacity, double slant_degrees) {
    Microscope microscope;
    LampLight lamp = aside_lamp();
    lamp.place_mm = {5 * std::sin(2 * slant_degrees * kRadiansPerDegree), 0,
                     5 * std::cos(2 * slant_degrees * kRadiansPerDegree)};
    lamp.direction = -lamp.place_mm.normalized();
    microscope.set_lamp(lamp);
    SurfaceLook film;
    film.rgb = {0, 0, 0}, film.specular = 0.1, film.casts_shadow = false;
    film.opacity = opacity;
    SoftSheet sheet = flat_sheet(3, 0);
    for (Vec3d& v : sheet.vertices) v.z = -v.x * std::tan(slant_degrees * kRadiansPerDegree);
    microscope.reshape(microscope.add_soft(film), sheet.vertices, sheet.triangles);
    MicroscopeSettings settings = small_picture();
    settings.ambient = 0;
    return light_at(picture_by(microscope, eye_camera(), settings), 80, 60);
  };
  for (const double slant_degrees : {0.0, 20.0, 40.0}) {
    const double whole = mirrored(1, slant_degrees);
    EXPECT_GT(whole, 0.5);
    const double way = 1 / std::cos(slant_degrees * kRadiansPerDegree);
    for (const double opacity : {0.12, 0.5}) {
      EXPECT_NEAR(mirrored(opacity, slant_degrees) / whole, 1 - std::pow(1 - opacity, way), 0.01);
    }
  }
}

TEST(PropertyMicroscopeLight, AVeilAtRestIsFaintAndShowsTheContrastOfTheRetina) {
  const auto lit = [](std::uint8_t grey, bool has_veil) {
    Microscope microscope;
    GlobeLook globe = grey_globe();
    globe.fundus.texels = {{grey, grey, grey}};
    microscope.set_globe(globe);
    microscope.set_lamp(aside_lamp());
    SurfaceLook film;
    film.opacity = 0.12, film.specular = 0.5, film.shininess = 60, film.casts_shadow = false;
    SoftSheet sheet = flat_sheet(2.5, 0, 40);
    for (Vec3d& v : sheet.vertices) v.z = -std::sqrt(10.98 * 10.98 - v.x * v.x - v.y * v.y);
    const int soft = microscope.add_soft(film);
    if (has_veil) microscope.reshape(soft, sheet.vertices, sheet.triangles);
    return light_at(picture_by(microscope, eye_camera(), small_picture()), 82, 58);
  };
  const double bright = lit(170, false), dark = lit(90, false);
  const double veiled_bright = lit(170, true), veiled_dark = lit(90, true);
  EXPECT_NEAR(veiled_bright - veiled_dark, 0.88 * (bright - dark), 0.01);
  EXPECT_GT(veiled_dark, dark);
  EXPECT_LT(veiled_dark - 0.88 * dark, 0.25);
}

TEST(PropertyMicroscopeLight, SoftShadowsAreDarkInTheMiddleAndGradedAtTheEdge) {
  Microscope microscope;
  microscope.set_globe(grey_globe());
  microscope.set_lamp(aside_lamp());
  RigidPlacement placement;
  placement.origin_mm = {0.4, -0.3, -7.5};
  microscope.place(microscope.add_rigid(ball_mesh(0.8), {}), placement);
  MicroscopeSettings settings = small_picture();
  settings.ambient = 0, settings.smooth_edges = false, settings.lamp_radius_mm = 0.4;
  const auto between = [&](int samples) {
    settings.shadow_samples = samples;
    const Image soft = picture_by(microscope, eye_camera(), settings);
    settings.shadow_samples = 0;
    const Image open = picture_by(microscope, eye_camera(), settings);
    int count = 0;
    for (int n = 0; n < 160 * 120; ++n) {
      const double part =
          light_at(soft, n % 160, n / 160) / std::max(light_at(open, n % 160, n / 160), 1e-6);
      count += part > 0.2 && part < 0.8;
    }
    return count;
  };
  EXPECT_LT(between(1), 5);
  EXPECT_GT(between(4), 150);
}

TEST(PropertyMicroscopeLight, HazeLiesOverSurfacesByTheirDepth) {
  Microscope microscope;
  microscope.set_globe(grey_globe());
  EvenHaze haze;
  const Camera camera = eye_camera();
  for (const int part : {1, 2, 4, 7}) {
    MicroscopeSettings settings = small_picture(161, 119);
    settings.ambient = 0.8, settings.haze_part = part;
    const Image picture = picture_by(microscope, camera, settings, &haze);
    for (int y = 2; y < settings.height; y += 13) {
      for (int x = 2; x < settings.width; x += 13) {
        const double a = haze.opacity(depth_of(camera, settings, x, y));
        const double expected = 0.4 * a + (1 - a) * 0.8 * grey_albedo();
        EXPECT_NEAR(picture.rgba[4 * (std::size_t(y) * settings.width + x)],
                    byte_from_light(expected), 1.01);
      }
    }
  }
  EXPECT_EQ(haze.calls, 4);
}

TEST(PropertyMicroscopeLight, ABallHasHazeBeforeAndBehindIt) {
  Microscope microscope;
  microscope.set_globe(grey_globe());
  const TaskBall ball{{0, 0, -3}, 1.5, {1, 1, 1}, 0.5};
  microscope.set_balls({ball});
  EvenHaze haze;
  haze.colour = 0.9;
  MicroscopeSettings settings = small_picture();
  settings.ambient = 0.8;
  const Camera camera = eye_camera();
  const Image picture = picture_by(microscope, camera, settings, &haze);
  EXPECT_EQ(haze.calls, 2);
  const double front = haze.opacity(200 + 3 - 1.5);  // the ball's nearest place
  const double whole = haze.opacity(211);
  const double rest = (whole - front) / (1 - front);
  const double behind = 0.9 * rest + (1 - rest) * 0.8 * grey_albedo();
  const double expected = 0.9 * front + (1 - front) * (0.5 + 0.5 * behind);
  EXPECT_NEAR(light_at(picture, 80, 60), expected, 0.02);
  const Image clear = picture_by(microscope, camera, settings);
  EXPECT_NEAR(light_at(clear, 80, 60), 0.5 + 0.5 * 0.8 * grey_albedo(), 0.02);
}

TEST(PropertyMicroscopeLight, ABallBehindASheetIsSeenThroughItAndOneBeforeIsNot) {
  Microscope microscope;
  microscope.set_globe(grey_globe());
  SurfaceLook black;
  black.rgb = {0, 0, 0}, black.opacity = 0.5;
  const SoftSheet sheet = flat_sheet(3, -5);
  microscope.reshape(microscope.add_soft(black), sheet.vertices, sheet.triangles);
  MicroscopeSettings settings = small_picture();
  settings.ambient = 0.8;
  const double retina = 0.8 * grey_albedo();
  const auto light_with = [&](double z) {
    microscope.set_balls({{{0, 0, z}, 1, {1, 1, 1}, 0.5}});
    return light_at(picture_by(microscope, eye_camera(), settings), 80, 60);
  };
  EXPECT_NEAR(light_with(-8), 0.5 * (0.5 + 0.5 * retina), 0.015);
  EXPECT_NEAR(light_with(-2), 0.5 + 0.5 * 0.5 * retina, 0.015);
}

TEST(PropertyMicroscopeLight, CoarseHazeLeavesNoHaloAtSilhouettes) {
  Microscope microscope;
  microscope.set_globe(grey_globe());
  SurfaceLook black;
  black.rgb = {0, 0, 0};
  RigidPlacement placement;
  placement.origin_mm = {0, 0, -2};
  microscope.place(microscope.add_rigid(ball_mesh(1.2), black), placement);
  RigidPlacement thin;
  thin.origin_mm = {-3, -3, -1};
  thin.z = Vec3d(1, 0.3, 0).normalized();
  thin.x = thin.z.cross(Vec3d(0, 0, 1)).normalized();
  thin.y = thin.z.cross(thin.x);
  microscope.place(microscope.add_rigid(needle_mesh(6, 0.02, 0.12), black), thin);
  EvenHaze haze;
  haze.per_mm = 0.1, haze.colour = 1;
  MicroscopeSettings settings = small_picture(320, 240);
  settings.ambient = 0.5, settings.smooth_edges = false, settings.haze_part = 1;
  const Image fine = picture_by(microscope, eye_camera(), settings, &haze);
  settings.haze_part = 4;
  const Image coarse = picture_by(microscope, eye_camera(), settings, &haze);
  int most = 0;
  for (std::size_t n = 0; n < fine.rgba.size(); ++n) {
    most = std::max(most, std::abs(int(fine.rgba[n]) - int(coarse.rgba[n])));
  }
  EXPECT_LE(most, 12);
}

/// Everything at once.
EyePair whole_pair(int threads) {
  return on_threads(threads, [] {
    Microscope microscope;
    GlobeLook globe;
    globe.fundus = make_fundus(128, 3);
    microscope.set_globe(globe);
    microscope.set_lamp(aside_lamp());
    microscope.set_spots({{Vec3d(0.1, 0.1, -1).normalized(), 0.5}});
    microscope.set_balls({{{2, 0, -8}, 0.5}});
    RigidPlacement placement;
    placement.origin_mm = {0.4, -0.3, -8};
    for (int n = 0; n < 4; ++n) {
      placement.origin_mm.x += 0.7;
      microscope.place(microscope.add_rigid(ball_mesh(0.5), {}), placement);
    }
    SurfaceLook film;
    film.opacity = 0.3, film.casts_shadow = false, film.dims = 0.8;
    const int soft = microscope.add_soft(film);
    SoftSheet sheet = flat_sheet(3, -9.5, 40);
    for (Vec3d& v : sheet.vertices) v.z += 0.2 * std::sin(3 * v.x) * std::cos(2 * v.y);
    microscope.reshape(soft, flat_sheet(2, -9).vertices, flat_sheet(2, -9).triangles);
    microscope.reshape(soft, sheet.vertices, sheet.triangles);
    EvenHaze haze;
    MicroscopeSettings settings = small_picture();
    settings.shadow_samples = 4;
    return pair_by(microscope, eye_camera(), 9, settings, &haze);
  });
}

TEST(PropertyMicroscopeLight, BitsAreTheSameForAnyNumberOfThreads) {
  const EyePair one = whole_pair(1), two = whole_pair(2), five = whole_pair(5);
  EXPECT_EQ(one.left.rgba, two.left.rgba);
  EXPECT_EQ(one.right.rgba, two.right.rgba);
  EXPECT_EQ(one.left.rgba, five.left.rgba);
  EXPECT_EQ(one.right.rgba, five.right.rgba);
  EXPECT_NE(one.left.rgba, one.right.rgba);
}

TEST(PropertyMicroscopeLight, EveryInstructionSetGivesThePictureOfTheBest) {
  const EyePair best = whole_pair(2);
  const std::vector<std::string> sets = sampling_instruction_sets();
#ifdef SUPPLE_TEST_ALL_LANES
  EXPECT_GE(sets.size(), 2u);
#endif
  for (const std::string& set : sets) {
    choose_sampling_instruction_set(set);
    const EyePair pair = whole_pair(2);
    int differing = 0;
    for (std::size_t n = 0; n < best.left.rgba.size(); ++n) {
      differing += std::abs(int(best.left.rgba[n]) - int(pair.left.rgba[n])) > 2;
    }
    EXPECT_LT(differing, 100) << set;  // at edges
  }
  choose_sampling_instruction_set("");
}

}  // namespace
}  // namespace supple

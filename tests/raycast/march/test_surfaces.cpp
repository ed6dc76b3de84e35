// Triangle meshes in pictures: normals, depth order with the volume, shadows both ways.
#include <algorithm>

#include <gtest/gtest.h>

#include "raycast/pictures/compare.h"
#include "tests/raycast/scenes.h"
#include "volumes/field/points/material_points.h"
#include "volumes/field/procedural.h"

namespace supple {
namespace {

constexpr int kSurfaceSize = 32;

/// A rectangle across the view of front_camera(kSurfaceSize) at y, as two triangles.
Surface rectangle(double y, double half, const std::array<double, 3>& rgb, double opacity = 1,
                  const Vec3d& shift = Vec3d(0)) {
  Surface surface;
  surface.mesh.vertices_lps_mm = {Vec3d(-half, y, -half) + shift, Vec3d(half, y, -half) + shift,
                                  Vec3d(half, y, half) + shift, Vec3d(-half, y, half) + shift};
  surface.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  surface.rgb = rgb;
  surface.opacity = opacity;
  return surface;
}

/// A prism around the z axis, every triangle with vertices of its own, as in STL files.
TriangleMesh prism(int sides, double radius, double height) {
  TriangleMesh mesh;
  const auto add = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const int first = int(mesh.vertices_lps_mm.size());
    mesh.vertices_lps_mm.insert(mesh.vertices_lps_mm.end(), {a, b, c});
    mesh.triangles.push_back({first, first + 1, first + 2});
  };
  const auto corner = [&](int n, double z) {
    const double angle = 2 * M_PI * (n % sides) / sides;
    return Vec3d(radius * std::cos(angle), radius * std::sin(angle), z);
  };
  for (int n = 0; n < sides; ++n) {
    const Vec3d a = corner(n, 0), b = corner(n + 1, 0);
    const Vec3d c = corner(n + 1, height), d = corner(n, height);
    add(a, b, c);
    add(a, c, d);
    add({0, 0, height}, d, c);
    add({0, 0, 0}, b, a);
  }
  return mesh;
}

RenderSettings unlit(int size) {
  RenderSettings settings = small_picture(size);
  settings.lighting.model = ShadingModel::none;
  return settings;
}

/// Slab of the mid density plus 500 between y0 and y1 mm.
Renderer slab_renderer(double y0, double y1) {
  const Geometry geometry = cube_geometry(kSurfaceSize);
  return {geometry, grid_of(voxels_of(Vec3i(kSurfaceSize), everywhere), [&](const Vec3d& p) {
            const double y = geometry.world_from_index(p).y;
            return y >= y0 && y <= y1 ? 1000.0 : 0.0;
          })};
}

std::array<float, 4> centre(const FloatImage& picture) {
  const std::size_t n = 4 * (std::size_t(picture.height / 2) * picture.width + picture.width / 2);
  return {picture.rgba[n], picture.rgba[n + 1], picture.rgba[n + 2], picture.rgba[n + 3]};
}

const std::array<double, 3> kRed{1, 0, 0}, kBlue{0, 0, 1};

TEST(UnitSurface, ManySidesAreRoundAndEndsAreFlat) {
  for (const SurfaceTriangle& triangle : surface_triangles(prism(8, 3, 10))) {
    const bool is_end = std::abs(triangle.face_normal.z) > 0.9f;
    for (const Vec3f& normal : triangle.normals) {
      EXPECT_NEAR(normal.length(), 1, 1e-6);
      // Between two sides: half of 45 degrees from each.
      EXPECT_NEAR(normal.dot(triangle.face_normal), is_end ? 1 : std::cos(M_PI / 8), 1e-6);
    }
  }
  for (const SurfaceTriangle& triangle : surface_triangles(prism(4, 3, 10))) {
    for (const Vec3f& normal : triangle.normals) {
      EXPECT_NEAR(normal.dot(triangle.face_normal), 1, 1e-6);
    }
  }
}

TEST(UnitSurface, WhatHasNoAreaOrNoSenseIsRefused) {
  Renderer renderer(cube_geometry(8), DensityGrid());
  const auto is_refused = [&](const Surface& surface) {
    EXPECT_THROW(renderer.set_surfaces({surface}), InputError);
  };
  is_refused({});
  Surface line = rectangle(0, 1, kRed);
  line.mesh.triangles = {{0, 1, 1}, {2, 2, 2}};
  is_refused(line);
  Surface astray = rectangle(0, 1, kRed);
  astray.mesh.triangles.push_back({0, 1, 4});
  is_refused(astray);
  Surface infinite = rectangle(0, 1, kRed);
  infinite.mesh.vertices_lps_mm[1].x = HUGE_VAL;
  is_refused(infinite);
  is_refused(rectangle(0, 1, kRed, 1.5));
  is_refused(rectangle(0, 1, {-0.1, 0, 0}));
}

TEST(PropertySurface, WhatIsInFrontHidesWhatIsBehind) {
  Renderer renderer = slab_renderer(0, 6);
  TransferFunction opaque = fog_function(1);
  opaque.opacity = {{500, 0}, {501, 1}};
  const Camera camera = front_camera(kSurfaceSize);
  const FloatImage volume = renderer.render_float(camera, opaque, unlit(32));
  EXPECT_EQ(centre(volume), (std::array<float, 4>{1, 1, 1, 1}));

  renderer.set_surfaces({rectangle(-8, 5, kRed)});
  const FloatImage before = renderer.render_float(camera, opaque, unlit(32));
  EXPECT_EQ(centre(before), (std::array<float, 4>{1, 0, 0, 1}));
  EXPECT_EQ(before.rgba[4 * (3 * 32 + 3) + 1], volume.rgba[4 * (3 * 32 + 3) + 1]);

  renderer.set_surfaces({rectangle(9, 5, kRed)});
  EXPECT_EQ(renderer.render_float(camera, opaque, unlit(32)).rgba, volume.rgba);
  EXPECT_EQ(renderer.render(camera, opaque, unlit(32)).rgba, to_image(volume).rgba);

  renderer.set_surfaces({});
  EXPECT_EQ(renderer.render_float(camera, opaque, unlit(32)).rgba, volume.rgba);
}

TEST(PropertySurface, TranslucentSurfacesMixFromFrontToBack) {
  Renderer renderer(cube_geometry(kSurfaceSize), DensityGrid());
  const auto picture = [&](double red_y, double blue_y) {
    renderer.set_surfaces({rectangle(red_y, 5, kRed, 0.5), rectangle(blue_y, 5, kBlue, 0.5)});
    return centre(renderer.render_float(front_camera(kSurfaceSize), fog_function(1), unlit(32)));
  };
  EXPECT_EQ(picture(-3, 3), (std::array<float, 4>{0.5f, 0, 0.25f, 0.75f}));
  EXPECT_EQ(picture(3, -3), (std::array<float, 4>{0.25f, 0, 0.5f, 0.75f}));
}

TEST(PropertySurface, EdgesOfTranslucentSurfacesLeaveNoSeams) {
  Renderer renderer(cube_geometry(kSurfaceSize), DensityGrid());
  renderer.set_surfaces({rectangle(0, 12, kRed, 0.5)});  // its diagonal meets pixel centres
  const FloatImage picture =
      renderer.render_float(front_camera(kSurfaceSize), fog_function(1), unlit(32));
  for (int row = 5; row < 27; ++row) {
    for (int column = 5; column < 27; ++column) {
      ASSERT_EQ(picture.rgba[4 * (row * 32 + column) + 3], 0.5f) << column << " " << row;
    }
  }
}

TEST(PropertySurface, FogBeforeASurfaceFollowsBeerAndLambertWhereverItStands) {
  Renderer renderer = slab_renderer(-12, 12);
  TransferFunction fog = fog_function(0.1);
  fog.opacity = {{400, 0}, {600, 0.1}};
  double previous = 0;
  for (double depth = 2; depth < 20; depth += 0.13) {
    renderer.set_surfaces({rectangle(-12 + depth, 5, {0, 0, 0})});
    const auto pixel = centre(renderer.render_float(front_camera(kSurfaceSize), fog, unlit(32)));
    EXPECT_NEAR(pixel[0], 1 - std::pow(0.9, depth), 0.012) << depth;
    EXPECT_EQ(pixel[3], 1);
    EXPECT_GT(pixel[0], previous);  // in every fraction of a step
    previous = pixel[0];
  }
}

TEST(PropertySurface, ASurfaceOutsideOfTheVolumesBoxIsSeen) {
  Renderer renderer = slab_renderer(0, 6);
  for (const Vec3d& shift : {Vec3d(40, 0, 0), Vec3d(40, -100, 0), Vec3d(40, 100, 0)}) {
    renderer.set_surfaces({rectangle(0, 5, kRed, 1, shift)});
    Camera camera = front_camera(kSurfaceSize);
    camera.height_mm = 100;
    RenderSettings settings = unlit(100);
    settings.auxiliary = true;
    const FloatImage picture = renderer.render_float(camera, surface_function(), settings);
    const std::size_t pixel = 50 * 100 + 90;
    EXPECT_EQ(picture.rgba[4 * pixel], 1);
    EXPECT_NEAR(picture.depth_mm[pixel], 200 + shift.y, 1e-3);
    EXPECT_NEAR(picture.normal_lps[3 * pixel + 1], -1, 1e-6);
    EXPECT_EQ(picture.offset_mm[pixel], 0);
  }
}

TEST(UnitSurface, ClipsCutSurfacesOnlyWhenAsked) {
  Renderer renderer(cube_geometry(kSurfaceSize), DensityGrid());
  renderer.set_surfaces({rectangle(0, 12, kRed)});
  RenderSettings settings = unlit(32);
  settings.clips = {{{{{0, 0, 0}, {1, 0, 0}}}, ClipKeep::inside, ClipSpace::deformed}};
  const auto alpha = [&](int column) {
    const FloatImage picture =
        renderer.render_float(front_camera(kSurfaceSize), fog_function(1), settings);
    return picture.rgba[4 * (16 * 32 + column) + 3];
  };
  EXPECT_EQ(alpha(8), 1);
  settings.clip_surfaces = true;
  EXPECT_EQ(alpha(8), 0);
  EXPECT_EQ(alpha(24), 1);
}

TEST(UnitSurface, AMaximumLiesOverTheSurfacesAndEndsAtAnOpaqueOne) {
  Renderer renderer = slab_renderer(0, 6);
  TransferFunction maximum;
  maximum.blend = Blend::maximum;
  maximum.opacity = {{0, 0}, {1000, 0.25}};
  maximum.colour = {{0, {0, 1, 0}}};
  renderer.set_surfaces({rectangle(9, 5, kRed)});
  EXPECT_EQ(centre(renderer.render_float(front_camera(kSurfaceSize), maximum, unlit(32))),
            (std::array<float, 4>{0.75f, 0.25f, 0, 1}));
  renderer.set_surfaces({rectangle(-9, 5, kRed)});
  EXPECT_EQ(centre(renderer.render_float(front_camera(kSurfaceSize), maximum, unlit(32))),
            (std::array<float, 4>{1, 0, 0, 1}));
}

/// Ambient 0.1, diffuse 0.8; the light given.
struct LitScene {
  explicit LitScene(const Vec3d& towards_light) : function(fog_function(0.1)) {
    function.ambient = 0.1, function.diffuse = 0.8, function.specular = 0;
    Light light;
    light.direction = towards_light;
    light.is_of_camera = false;
    settings.lighting.lights = {light};
    settings.lighting.shadows = true;
  }
  TransferFunction function;
  RenderSettings settings = small_picture(32);
};

TEST(PropertySurfaceShadow, FogShadesASurfaceByBeerAndLambert) {
  // A wall oblique to both, left of 16 mm of fog that the light must cross.
  const Geometry geometry = cube_geometry(kSurfaceSize);
  Renderer renderer(
      geometry,
      grid_of(voxels_of(Vec3i(kSurfaceSize), [](const Vec3i& v) { return v.x >= 8 && v.x <= 24; }),
              [](const Vec3d&) { return 100; }));
  Surface wall;
  wall.mesh.vertices_lps_mm = {{-15, -3, -9}, {-9, 3, -9}, {-9, 3, 9}, {-15, -3, 9}};
  wall.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  wall.rgb = {1, 1, 1};
  renderer.set_surfaces({wall});
  const LitScene scene({1, 0, 0});
  const FloatImage picture =
      renderer.render_float(front_camera(kSurfaceSize), scene.function, scene.settings);
  const double reached = std::pow(0.9, 16);
  EXPECT_NEAR(picture.rgba[4 * (16 * 32 + 4)], 0.1 + 0.8 * std::sqrt(0.5) * reached, 0.01);
}

TEST(PropertySurfaceShadow, ARodShadesTheWallBehindItInAStripOfItsWidth) {
  constexpr double kRadius = 2, kWall = 8;
  const Vec3d rod_at(4, -6, 0), towards(0.6, -0.8, 0);
  Renderer renderer = slab_renderer(kWall, 14);
  Surface rod;
  rod.mesh = prism(48, kRadius, 60);
  for (Vec3d& v : rod.mesh.vertices_lps_mm) v += rod_at - Vec3d(0, 0, 30);
  renderer.set_surfaces({rod});
  LitScene scene(towards);
  scene.function.opacity = {{400, 0}, {600, 0.99}};
  scene.settings.width = scene.settings.height = 96;
  const FloatImage picture =
      renderer.render_float(front_camera(kSurfaceSize), scene.function, scene.settings);
  // Along the light from the rod's axis to the wall.
  const double centre_x = rod_at.x + towards.x / towards.y * (kWall - rod_at.y);
  const double half_width = kRadius / std::abs(towards.y);
  int dark = 0, lit = 0;
  for (int column = 3; column < 93; ++column) {
    const double x = (column + 0.5) / 3 - 16;
    const double outside = std::abs(x - centre_x) - half_width;
    if (std::abs(x - rod_at.x) < kRadius + 0.2 || std::abs(outside) < 0.6) continue;
    const double expected = outside < 0 ? 0.1 : 0.1 + 0.8 * 0.8;
    EXPECT_NEAR(picture.rgba[4 * std::size_t(48 * 96 + column)], expected, 0.02) << x;
    ++(outside < 0 ? dark : lit);
  }
  EXPECT_GT(dark, 8);
  EXPECT_GT(lit, 40);
}

TEST(UnitSurface, PhongsHighlightLiesOnTheLitSideOnly) {
  // A screen seen at a slant. Light from behind it would be mirrored to the viewer, too, were the
  // screen not in its way.
  const Vec3d normal(std::sqrt(0.96), -0.2, 0), along(0.2, std::sqrt(0.96), 0), eye(0, -1, 0);
  Surface screen;
  for (const auto& [u, z] : {std::pair(-8, -8), {8, -8}, {8, 8}, {-8, 8}}) {
    screen.mesh.vertices_lps_mm.push_back(along * u + Vec3d(0, 0, z));
  }
  screen.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  Renderer renderer(cube_geometry(kSurfaceSize), DensityGrid());
  renderer.set_surfaces({screen});
  const auto highlight = [&](const Vec3d& towards_light) {
    LitScene scene(towards_light);
    scene.settings.lighting.model = ShadingModel::phong;
    scene.settings.lighting.shadows = false;
    scene.function.ambient = scene.function.diffuse = 0;
    scene.function.specular = 1, scene.function.specular_power = 4;
    return centre(
        renderer.render_float(front_camera(kSurfaceSize), scene.function, scene.settings))[0];
  };
  const Vec3d mirrored = normal * (2 * normal.dot(eye)) - eye;
  EXPECT_NEAR(highlight(mirrored), 1, 1e-4);
  const Vec3d behind = Vec3d(-0.1, 1, 0).normalized();
  ASSERT_LT(behind.dot(normal), -0.2);
  ASSERT_GT((normal * (2 * normal.dot(behind)) - behind).dot(eye), 0.8);
  EXPECT_EQ(highlight(behind), 0);
}

TEST(UnitSurfaceShadow, WhatIsCutAwayCastsNoShadow) {
  Renderer renderer(cube_geometry(kSurfaceSize), DensityGrid());
  // Lit from the front, where a screen is cut away.
  renderer.set_surfaces({rectangle(0, 12, {1, 1, 1}), rectangle(-8, 12, kRed)});
  LitScene scene({0, -1, 0});
  scene.settings.clips = {{{{{0, -4, 0}, {0, 1, 0}}}, ClipKeep::inside, ClipSpace::deformed}};
  scene.settings.clip_surfaces = true;
  EXPECT_NEAR(
      centre(renderer.render_float(front_camera(kSurfaceSize), scene.function, scene.settings))[0],
      0.1 + 0.8, 1e-5);
}

TEST(PropertySurfaceShadow, SurfacesShadeTheVolumeAndEachOtherByTheirOpacity) {
  // A screen between the light, which comes from the viewer's right, and what lies behind it.
  const LitScene scene({0.6, -0.8, 0});
  for (const bool on_volume : {true, false}) {
    Renderer renderer = slab_renderer(on_volume ? 8 : 100, 14);
    std::vector<Surface> surfaces = {rectangle(0, 2, {1, 1, 1}, 0.4, {8, 0, 0})};
    if (!on_volume) surfaces.push_back(rectangle(8, 15, {1, 1, 1}));
    renderer.set_surfaces(surfaces);
    TransferFunction opaque = scene.function;
    opaque.opacity = {{400, 0}, {600, 0.99}};
    const FloatImage picture =
        renderer.render_float(front_camera(kSurfaceSize), opaque, scene.settings);
    const auto grey = [&](double x) { return picture.rgba[4 * (16 * 32 + int(16 + x))]; };
    const double lit = 0.1 + 0.8 * 0.8, dimmed = 0.1 + 0.6 * 0.8 * 0.8;
    EXPECT_NEAR(grey(8 - 6), dimmed, 0.02) << on_volume;  // 8 mm behind, 6 mm aside
    EXPECT_NEAR(grey(-8), lit, 0.02) << on_volume;
  }
}

TEST(PropertySurfaceShadow, ARoundBodyOfFewSidesDoesNotShadeItsLitSide) {
  Renderer renderer(cube_geometry(kSurfaceSize), DensityGrid());
  Surface rod;
  rod.mesh = prism(12, 8, 20);
  for (Vec3d& v : rod.mesh.vertices_lps_mm) v.z -= 10;
  renderer.set_surfaces({rod});
  LitScene scene({0.766, -0.643, 0.1});  // the terminator lies within a side
  scene.settings.width = scene.settings.height = 128;
  const FloatImage with =
      renderer.render_float(front_camera(kSurfaceSize), scene.function, scene.settings);
  scene.settings.lighting.shadows = false;
  const FloatImage without =
      renderer.render_float(front_camera(kSurfaceSize), scene.function, scene.settings);
  int compared = 0;
  for (std::size_t n = 0; n < with.rgba.size(); n += 4) {
    if (without.rgba[n] < 0.15f) continue;
    ASSERT_NEAR(with.rgba[n], without.rgba[n], 1e-6) << n / 4 % 128 << " " << n / 4 / 128;
    ++compared;
  }
  EXPECT_GT(compared, 2000);
}

/// The mesh of a sphere in a body that bulges is still an iso-surface of its densities.
TEST(PropertySurface, AMeshMovedAlongStaysOnTheDeformedSurface) {
  const Geometry geometry({40, 40, 40}, {3, -2, 1}, {Vec3d(0.9, 0, 0), {0, -0.9, 0}, {0, 0, 1.4}});
  const AnalyticWarp warp = bump_warp({20, 20, 20}, 15, 4);
  const Displacement u =
      sample_displacement(warp, geometry, voxels_of(geometry.dims(), everywhere));
  TriangleMesh sphere = prism(24, 1, 1);
  std::vector<Vec3d> rest;
  for (const Vec3d& v : sphere.vertices_lps_mm) {
    const Vec3d unit = (v - Vec3d(0, 0, 0.5)).normalized();
    rest.push_back(geometry.world_from_index(Vec3d(20.3, 19.8, 20.1) + unit * 9.7));
  }
  const std::vector<Vec3d> moved = moved_along(u, rest);
  double largest = 0;
  for (std::size_t n = 0; n < rest.size(); ++n) {
    const Vec3d x = geometry.index_from_world(moved[n]);
    const Vec3d source = x + warp.offset_voxels(x);
    ASSERT_NEAR((source - Vec3d(20.3, 19.8, 20.1)).length(), 9.7, 0.05);
    largest = std::max(largest, (moved[n] - rest[n]).length());
  }
  EXPECT_GT(largest, 2);
  // A point beyond the material moves, too, and not wildly.
  const Vec3d far = moved_along(u, {geometry.world_from_index({20, 60, 20})}).front();
  EXPECT_LT((far - geometry.world_from_index({20, 60, 20})).length(), 4);
}

}  // namespace
}  // namespace supple

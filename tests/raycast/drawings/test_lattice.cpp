// Bodies drawn as lattices.
#include <gtest/gtest.h>

#include "raycast/drawings/lattice.h"
#include "tests/raycast/scenes.h"
#include "volumes/base/error.h"

namespace supple {
namespace {

std::array<int, 3> pixel_at(const Image& image, double x, double y) {
  const std::uint8_t* p = &image.rgba[4 * (std::size_t(int(y)) * image.width + int(x))];
  return {p[0], p[1], p[2]};
}

Displacement at_rest(const Geometry& geometry, const BrickTopology& where) {
  return {geometry, {where, BrickVectors(where.brick_count())}};
}

void shift(Displacement& u, const Vec3i& voxel, const Vec3f& by) {
  u.u.vectors.touch(std::size_t(u.u.topology.find(voxel)))[brick_offset(voxel)] = by;
}

/// Slices of 5x3 voxels: right-handed, left-handed, and tilted in the patient.
std::vector<Geometry> slices() {
  return {{{5, 3, 1}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}}},
          {{5, 3, 1}, {7, 0, 0}, {Vec3d(1, 0, 0), {0, -1, 0}, {0, 0, 1}}},
          {{5, 3, 1}, {0, 9, 0}, {Vec3d(0, 0.6, 0.8), {1, 0, 0}, {0, 0.8, -0.6}}}};
}

LatticeStyle style_of(int width, int height, bool links) {
  LatticeStyle style;
  style.width = width, style.height = height, style.links = links;
  return style;
}

TEST(UnitLattice, ASliceAtRestIsTheImageAsItWasRead) {
  for (const Geometry& geometry : slices()) {
    const BrickTopology where = voxels_of({5, 3, 1}, everywhere);
    const DensityGrid grid = grid_of(where, [](const Vec3d& p) { return 40 * p.x + 30 * p.y; });
    const Displacement u = at_rest(geometry, where);
    const Camera camera = lattice_camera(geometry, u, 2);
    const Image image = draw_lattice(geometry, grid, u, camera, style_of(200, 100, false));
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < 3; ++j) {
        double px = 0, py = 0;
        ASSERT_TRUE(
            project_to_pixel(camera, 200, 100, geometry.world_from_index(Vec3d(i, j, 0)), px, py));
        // Just inside the outline.
        px += i == 0 ? 1 : i == 4 ? -1 : 0;
        py += j == 0 ? 1 : j == 2 ? -1 : 0;
        EXPECT_NEAR(pixel_at(image, px, py)[0], 40 * i + 30 * j, 4);
      }
    }
    EXPECT_EQ(pixel_at(image, 3, 3), (std::array<int, 3>{255, 255, 255}));
  }
}

TEST(UnitLattice, LinksRunBetweenNeighboursOnly) {
  const Geometry geometry = slices().front();
  const BrickTopology where =
      voxels_of({5, 3, 1}, [](const Vec3i& v) { return v != Vec3i(2, 1, 0); });
  const DensityGrid grid = grid_of(where, [](const Vec3d&) { return 128; });
  const Displacement u = at_rest(geometry, where);
  const Camera camera = lattice_camera(geometry, u, 1);
  LatticeStyle style = style_of(300, 300, true);
  style.grey_image = false;
  style.link_width_pixels = 3;
  const Image image = draw_lattice(geometry, grid, u, camera, style);
  const auto drawn = [&](double i, double j) {
    double px = 0, py = 0;
    project_to_pixel(camera, 300, 300, geometry.world_from_index(Vec3d(i, j, 0)), px, py);
    return pixel_at(image, px, py)[0] < 128;
  };
  EXPECT_TRUE(drawn(0.5, 0));
  EXPECT_TRUE(drawn(4, 1.5));
  EXPECT_TRUE(drawn(0.5, 1));
  EXPECT_FALSE(drawn(1.5, 1));  // the hole
  EXPECT_FALSE(drawn(2, 1.5));
  EXPECT_FALSE(drawn(0.5, 0.5));
}

TEST(UnitLattice, TheNearerSheetHidesTheOther) {
  // A strip folded over itself: i = 3, 4 lie on i = 1, 0 but 0.5 nearer to the viewer.
  const Geometry geometry = slices().front();
  const BrickTopology where = voxels_of({5, 3, 1}, everywhere);
  const DensityGrid grid = grid_of(where, [](const Vec3d& p) { return p.x < 2.5 ? 0 : 200; });
  for (const double depth : {-0.5, 0.5}) {
    Displacement u = at_rest(geometry, where);
    for (int j = 0; j < 3; ++j) {
      shift(u, {3, j, 0}, Vec3f(-2, 0, float(depth)));
      shift(u, {4, j, 0}, Vec3f(-4, 0, float(depth)));
    }
    const Camera camera = lattice_camera(geometry, u, 1);
    const Image image = draw_lattice(geometry, grid, u, camera, style_of(120, 120, false));
    double px = 0, py = 0;
    ASSERT_TRUE(project_to_pixel(camera, 120, 120, geometry.world_from_index({0.5, 1, 0}), px, py));
    EXPECT_NEAR(pixel_at(image, px, py)[0], depth < 0 ? 200 : 0, 1);
  }
}

TEST(UnitLattice, TheCameraFramesTheDeformedSlice) {
  const Geometry geometry = slices().front();
  const BrickTopology where = voxels_of({5, 3, 1}, everywhere);
  Displacement u = at_rest(geometry, where);
  shift(u, {4, 2, 0}, Vec3f(20, 0, 3));
  const Camera camera = lattice_camera(geometry, u, 1);
  double px = 0, py = 0;
  ASSERT_TRUE(project_to_pixel(camera, 100, 100, {24.5, 2, 3}, px, py));
  EXPECT_NEAR(px, 95, 1e-9);
  ASSERT_TRUE(project_to_pixel(camera, 100, 100, {-0.5, 0, 0}, px, py));
  EXPECT_NEAR(px, 5, 1e-9);
}

TEST(PropertyLattice, ACubeIsSeenByItsSurfaceWithFacesDarkenedAsTheyTurnAway) {
  const Geometry geometry = cube_geometry(6);
  const BrickTopology where = voxels_of(geometry.dims(), everywhere);
  const DensityGrid grid = grid_of(where, [](const Vec3d& p) {
    const bool inside = p.x > 0 && p.x < 5 && p.y > 0 && p.y < 5 && p.z > 0 && p.z < 5;
    return inside ? 0 : 200;
  });
  const Displacement u = at_rest(geometry, where);
  Camera camera = default_camera(geometry, 1);
  const Image front = draw_lattice(geometry, grid, u, camera, style_of(90, 90, false));
  EXPECT_NEAR(pixel_at(front, 45, 45)[0], 200 * 1.0, 45);  // the inside grey does not shine through
  EXPECT_GT(pixel_at(front, 45, 45)[0], 20);
  camera.position_lps_mm = {-20, -6, 0};
  const Image oblique = draw_lattice(geometry, grid, u, camera, style_of(90, 90, false));
  int darkest = 255;
  for (int n = 0; n < 90 * 90; ++n) {
    const int value = oblique.rgba[4 * std::size_t(n)];
    if (value > 60) darkest = std::min(darkest, value);
  }
  EXPECT_LT(darkest, 150);
}

TEST(UnitLattice, WrongStylesAreInputErrors) {
  const Geometry geometry = slices().front();
  const Displacement u = at_rest(geometry, voxels_of({5, 3, 1}, everywhere));
  const Camera camera = lattice_camera(geometry, u, 1);
  LatticeStyle style;
  style.grey_hi = style.grey_lo;
  EXPECT_THROW(draw_lattice(geometry, DensityGrid(), u, camera, style), InputError);
  style = LatticeStyle();
  style.width = 0;
  EXPECT_THROW(draw_lattice(geometry, DensityGrid(), u, camera, style), InputError);
}

}  // namespace
}  // namespace supple

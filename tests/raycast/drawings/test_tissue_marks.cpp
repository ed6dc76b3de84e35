// Marks in space of how tissue has moved: arrows, the grid on its surface, surfaces of labels.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "raycast/drawings/arrows.h"
#include "raycast/drawings/label_surfaces.h"
#include "raycast/drawings/surface_grid.h"
#include "tests/raycast/scenes.h"
#include "volumes/base/error.h"

namespace supple {
namespace {

/// Winding of a closed mesh around a point: 1 inside, 0 outside (A. Van Oosterom and J. Strackee,
/// The solid angle of a plane triangle, IEEE Transactions on Biomedical Engineering 30(2), 1983).
double winding_number(const TriangleMesh& mesh, const Vec3d& point) {
  double angle = 0;
  for (const auto& triangle : mesh.triangles) {
    Vec3d r[3];
    double length[3];
    for (int n = 0; n < 3; ++n) {
      r[n] = mesh.vertices_lps_mm[std::size_t(triangle[std::size_t(n)])] - point;
      length[n] = r[n].length();
    }
    const double above = r[0].dot(r[1].cross(r[2]));
    const double below = length[0] * length[1] * length[2] + r[0].dot(r[1]) * length[2] +
                         r[1].dot(r[2]) * length[0] + r[2].dot(r[0]) * length[1];
    angle += 2 * std::atan2(above, below);
  }
  return angle / (4 * 3.14159265358979);
}

/// Labels may have one voxel, holes and edges that two parts share, also on left-handed grids.
TEST(PropertyLabelSurfaces, EveryVoxelLiesInTheSurfaceOfItsLabelAndInNoOther) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> any(0, 3);
  const Vec3d thick(0, 0, 3), left_handed(0, 0, -3);
  for (const Vec3d& third : {thick, left_handed}) {
    const Geometry geometry({5, 6, 4}, {10, -20, 5}, {Vec3d(1, 0.2, 0), {0, 2, 0}, third});
    std::vector<int> labels(5 * 6 * 4);
    for (int& label : labels) label = any(random) * 7;
    const auto label_at = [&](const Vec3i& v) {
      return std::int64_t(labels[std::size_t((v.z * 6 + v.y) * 5 + v.x)]);
    };
    const std::vector<LabelSurface> surfaces = label_surfaces(geometry, label_at);
    ASSERT_EQ(surfaces.size(), 3u);
    for (const LabelSurface& surface : surfaces) {
      for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < 6; ++j) {
          for (int i = 0; i < 5; ++i) {
            const Vec3d place = geometry.world_from_index(Vec3d(i, j, k));
            ASSERT_NEAR(winding_number(surface.mesh, place),
                        label_at({i, j, k}) == surface.label ? 1 : 0, 1e-6)
                << surface.label << " at " << i << " " << j << " " << k;
          }
        }
      }
    }
  }
}

TEST(PropertyLabelSurfaces, ABallIsSmooth) {
  const Geometry geometry = cube_geometry(40);
  const auto surfaces = label_surfaces(geometry, [&](const Vec3i& v) {
    return std::int64_t(geometry.world_from_index(Vec3d(v)).length() < 15 ? 1 : 0);
  });
  ASSERT_EQ(surfaces.size(), 1u);
  double worst = 0, sum = 0;
  const TriangleMesh& mesh = surfaces.front().mesh;
  for (const auto& t : mesh.triangles) {
    const Vec3d& a = mesh.vertices_lps_mm[std::size_t(t[0])];
    const Vec3d& b = mesh.vertices_lps_mm[std::size_t(t[1])];
    const Vec3d& c = mesh.vertices_lps_mm[std::size_t(t[2])];
    const double cosine = (b - a).cross(c - a).normalized().dot(((a + b + c) / 3.0).normalized());
    worst = std::min(worst, cosine);
    sum += std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / 3.14159265358979;
  }
  EXPECT_EQ(worst, 0);  // none looks inwards
  // The faces of voxels are 31 degrees off on average.
  EXPECT_LT(sum / double(mesh.triangles.size()), 8);
}

TEST(UnitArrows, AnArrowReachesFromWhereTissueWasToWhereItIs) {
  const Arrow arrow{{1, 2, 3}, {1, 2, 11}};
  const auto grey = [](double) { return Rgb{0.5, 0.5, 0.5}; };
  const std::vector<Surface> surfaces = arrow_surfaces({arrow}, 6, 10, grey);
  ASSERT_EQ(surfaces.size(), 1u);
  EXPECT_NO_THROW(surfaces.front().validate(""));
  double low = 1e9, high = -1e9, widest = 0, widest_at = 0;
  for (const Vec3d& v : surfaces.front().mesh.vertices_lps_mm) {
    low = std::min(low, v.z), high = std::max(high, v.z);
    const double radius = std::hypot(v.x - 1, v.y - 2);
    if (radius > widest) widest = radius, widest_at = v.z;
  }
  EXPECT_NEAR(low, 3, 1e-12);
  EXPECT_NEAR(high, 11, 1e-12);
  EXPECT_NEAR(widest, 1, 1e-12);
  EXPECT_NEAR(widest_at, 11 - 0.45 * 6, 1e-12);                             // where its head begins
  EXPECT_NEAR(winding_number(surfaces.front().mesh, {1, 2, 10}), 1, 1e-9);  // and looks outwards
}

TEST(UnitArrows, ColoursFollowLengthsAndPlacesTheGrid) {
  const Geometry geometry({21, 11, 1}, {0, 0, 0}, {Vec3d(1, 0, 0), {0, 2, 0}, {0, 0, 1}});
  std::vector<Vec3d> asked;
  const auto arrows = arrows_on_lattice(geometry, 5, [&](const Vec3d& index, Arrow& arrow) {
    asked.push_back(index);
    arrow = {Vec3d(0), Vec3d(0, 0, index.x < 5 ? 0.09 : index.x)};
    return index.y < 9;
  });
  ASSERT_EQ(asked.size(), 4u * 4u);
  EXPECT_EQ(asked.front(), Vec3d(2.5, 1.25, 0));  // as much free on every side
  EXPECT_EQ(asked.back(), Vec3d(17.5, 8.75, 0));
  EXPECT_EQ(arrows.size(), 3u * 4u);  // too short to be seen
  std::vector<double> shares;
  arrow_surfaces(arrows, 5, 12.5, [&](double share) {
    shares.push_back(share);
    return Rgb{1, 1, 1};
  });
  ASSERT_EQ(shares.size(), 2u);  // what is longer than the longest has the last colour
  EXPECT_NEAR(shares[0], 7.5 / 12.5, 1.0 / kArrowColours);
  EXPECT_GT(shares[1], 1 - 1.0 / kArrowColours);
  EXPECT_THROW(arrows_on_lattice(cube_geometry(200), 0.5, {}), InputError);
}

/// A wall that faces the viewer, 1 mm per pixel, whose tissue came from 3 mm further left.
FloatImage marked_wall(const SurfaceGrid& grid, const ShowsTissue& shows_tissue,
                       const Vec3d& moved) {
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.position_lps_mm = {0, -100, 0};
  camera.target_lps_mm = {0, 0, 0};
  camera.height_mm = 60;
  FloatImage wall(60, 60, true);
  for (std::size_t n = 0; n < wall.pixel_count(); ++n) {
    for (std::size_t c = 0; c < 4; ++c) wall.rgba[4 * n + c] = c == 3 ? 1.0f : 0.0f;
    wall.depth_mm[n] = 100;
    for (std::size_t c = 0; c < 3; ++c) wall.normal_lps[3 * n + c] = c == 1 ? -1.0f : 0.0f;
  }
  const auto rest_place = [&](const Vec3d& index, Vec3d& at_rest) {
    at_rest = index + moved;
    at_rest.y += 0.02 * index.x;  // planes along the wall cross it, but hardly
    return true;
  };
  draw_surface_grid(wall, camera, Geometry(), grid, rest_place, shows_tissue);
  return wall;
}

TEST(UnitSurfaceGrid, LinesLieWhereTheirTissueHasGoneAndPlanesAlongTheWallDrawNothing) {
  SurfaceGrid grid;
  grid.ink = {1, 1, 1};
  const FloatImage wall = marked_wall(grid, [](int x, int) { return x < 50; }, {-3.5, 0, 0.5});
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      // Left is on the right; the middle of pixel 30 is at 0.5 mm, of row 30 at -0.5 mm.
      const int across = x - 30 - 3, down = 30 - y;
      const bool is_line = across % 10 == 0 || down % 10 == 0;
      EXPECT_NEAR(wall.rgba[4 * std::size_t(60 * y + x)], is_line && x < 50 ? 1 : 0, 1e-6)
          << x << " " << y;
    }
  }
  FloatImage plain(4, 4);
  EXPECT_THROW(draw_surface_grid(plain, Camera(), Geometry(), grid, {}, {}), InputError);
}

}  // namespace
}  // namespace supple

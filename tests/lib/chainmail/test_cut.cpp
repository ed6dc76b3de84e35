// Cuts: what a surface crosses, and what moves afterwards.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "tests/lib/cut_fixtures.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

Geometry random_geometry(std::mt19937& random) {
  while (true) {
    const std::array<Vec3d, 3> axes = {pick_vector(random, -1, 1), pick_vector(random, -1, 1),
                                       pick_vector(random, -1, 1)};
    const Vec3d units[3] = {axes[0].normalized(), axes[1].normalized(), axes[2].normalized()};
    if (std::abs(units[0].dot(units[1].cross(units[2]))) < 0.1) continue;
    return {{64, 64, 64}, pick_vector(random, -300, 300), axes};
  }
}

/// Number of the connected piece of every element, over the links that are left.
std::vector<int> pieces_of(const Body& body) {
  std::vector<int> piece(slot_count(body.elements), -1);
  int count = 0;
  for_each_element(body.elements, [&](Slot first) {
    if (piece[first] >= 0) return;
    std::vector<Slot> open = {first};
    piece[first] = count;
    while (!open.empty()) {
      const Slot slot = open.back();
      open.pop_back();
      for (int face = 0; face < 6; ++face) {
        Slot next;
        if (!neighbour_slot(body.elements, body.cuts, slot, face / 2, face % 2 != 0, next) ||
            piece[next] >= 0) {
          continue;
        }
        piece[next] = count;
        open.push_back(next);
      }
    }
    ++count;
  });
  return piece;
}

/// Plane of a triangle of a convex mesh; the normal points to its inside.
struct InnerPlane {
  Vec3d corner, normal;
};
std::vector<InnerPlane> inner_planes(const TriangleMesh& convex, const Vec3d& centre) {
  std::vector<InnerPlane> planes;
  for (const auto& [a, b, c] : convex.triangles) {
    const Vec3d& corner = convex.vertices_lps_mm[a];
    const Vec3d normal =
        (convex.vertices_lps_mm[b] - corner).cross(convex.vertices_lps_mm[c] - corner).normalized();
    planes.push_back({corner, normal.dot(centre - corner) < 0 ? -normal : normal});
  }
  return planes;
}

/// 1 inside, -1 outside, 0 within a thousandth of the surface.
int side_of(const std::vector<InnerPlane>& convex, const Vec3d& point) {
  constexpr double kSurface = 1e-3;
  bool is_inside = true;
  for (const InnerPlane& plane : convex) {
    const double depth = plane.normal.dot(point - plane.corner);
    if (depth <= -kSurface) return -1;
    is_inside = is_inside && depth >= kSurface;
  }
  return is_inside ? 1 : 0;
}

}  // namespace

TEST(PropertyCuts, AClosedSphereLeavesNoLinkBetweenItsInsideAndItsOutside) {
  std::mt19937 random(21);
  int split = 0;
  for (int n = 0; n < cases(120); ++n) {
    Block block = n % 3 == 0 ? random_block(random, {18, 17, 16}) : soft_block({18, 17, 16});
    Body body = body_of(block);
    body.geometry = random_geometry(random);
    // An ellipsoid of any orientation in voxels, from far below one to most of the body.
    TriangleMesh sphere = unit_sphere(int(random() % 4));
    const Vec3d centre = Vec3d(block.origin) + pick_vector(random, 2, 15);
    const double size = std::pow(10.0, pick(random, -2, 0.9));
    const Vec3d axes[3] = {pick_vector(random, -size, size), pick_vector(random, -size, size),
                           pick_vector(random, -size, size)};
    for (Vec3d& v : sphere.vertices_lps_mm) {
      v = centre + axes[0] * v.x + axes[1] * v.y + axes[2] * v.z;
    }
    const CutReport report = cut(body, to_world(body.geometry, sphere));
    EXPECT_EQ(report.crossed, body.cuts.count());
    const std::vector<InnerPlane> planes = inner_planes(sphere, centre);
    const std::vector<int> piece = pieces_of(body);
    std::vector<int> side(piece.size(), 0);
    std::vector<char> has_inside(piece.size(), 0), has_outside(piece.size(), 0);
    for_each_element(body.elements, [&](Slot slot) {
      side[slot] = side_of(planes, Vec3d(voxel_of(body.elements, slot)));
      has_inside[std::size_t(piece[slot])] |= side[slot] > 0;
      has_outside[std::size_t(piece[slot])] |= side[slot] < 0;
    });
    for (std::size_t p = 0; p < piece.size(); ++p) ASSERT_FALSE(has_inside[p] && has_outside[p]);
    for_each_lattice_link(body, [&](int, Slot low, Slot high, bool is_cut) {
      if (side[low] * side[high] < 0) {
        EXPECT_TRUE(is_cut);
      }
      if (side[low] > 0 && side[high] > 0) {
        EXPECT_FALSE(is_cut);
      }
    });
    split += std::count(has_inside.begin(), has_inside.end(), 1) > 0;
    if (HasFailure()) FAIL() << "case " << n;
  }
  EXPECT_GT(split, cases(20));
}

TEST(PropertyCuts, BoxesThroughVoxelCentresAndBrickBordersCutExactlyTheLinksThatLeaveThem) {
  std::mt19937 random(22);
  for (int n = 0; n < 60; ++n) {
    Body body = body_of(soft_block({20, 19, 18}));
    if (n % 2)
      body.geometry = Geometry({64, 64, 64}, {-17.3, 4.1, 0.7},
                               {Vec3d(0, 0.7, 0), Vec3d(-0.7, 0, 0), Vec3d(0, 0, 1.3)});
    Vec3d lo, hi;
    for (int a = 0; a < 3; ++a) {
      // Voxel centres, faces between voxels, faces of bricks, and outside the body.
      const double places[] = {2, 3.5, 7, 7.5, 8, 11, 15.5, 16, -3};
      do {
        lo[a] = places[random() % 9];
        hi[a] = places[random() % 9];
      } while (hi[a] - lo[a] < 1);  // a thinner box crosses links between voxels beside it
    }
    cut(body, to_world(body.geometry, box_mesh(lo, hi)));
    // A face through voxel centres lies just above them.
    const auto inside = [&](Slot slot) {
      const Vec3d v(voxel_of(body.elements, slot));
      return lo.x < v.x && lo.y < v.y && lo.z < v.z && v.x <= hi.x && v.y <= hi.y && v.z <= hi.z;
    };
    for_each_lattice_link(body, [&](int, Slot low, Slot high, bool is_cut) {
      EXPECT_EQ(is_cut, inside(low) != inside(high));
    });
    Body same = body_of(soft_block({20, 19, 18}));
    cut_boundary(same, inside);
    EXPECT_EQ(same.cuts.count(), body.cuts.count());
    if (HasFailure()) FAIL() << "case " << n << " from " << lo << " to " << hi;
  }
}

TEST(PropertyCuts, OctahedraWhoseFacesPassThroughVoxelCentresLeaveNoLinkOpen) {
  for (int radius = 1; radius < 8; ++radius) {
    Body body = body_of(soft_block({18, 17, 16}));
    const Vec3i centre(8, 7 + radius % 3, 8);
    TriangleMesh mesh;
    for (int n = 0; n < 6; ++n) {
      Vec3d vertex(centre);
      vertex[n / 2] += n % 2 ? radius : -radius;
      mesh.vertices_lps_mm.push_back(vertex);
    }
    for (int n = 0; n < 8; ++n) mesh.triangles.push_back({n & 1, 2 + (n >> 1 & 1), 4 + (n >> 2)});
    cut(body, mesh);
    // Counts in 1e-6 voxel: the surface moves a little up along every axis, as cut.h says.
    const auto inside = [&](Slot slot) {
      const Vec3i v = (voxel_of(body.elements, slot) - centre) * 1000000 - Vec3i(30, 33, 37);
      return std::abs(v.x) + std::abs(v.y) + std::abs(v.z) < radius * 1000000;
    };
    for_each_lattice_link(body, [&](int, Slot low, Slot high, bool is_cut) {
      if (inside(low) != inside(high)) {
        EXPECT_TRUE(is_cut);
      }
      if (inside(low) && inside(high)) {
        EXPECT_FALSE(is_cut);
      }
    });
    if (HasFailure()) FAIL() << "radius " << radius;
  }
}

TEST(PropertyCuts, RandomTrianglesCutWhatSegmentTriangleIntersectionSays) {
  LEFT_OUT_WHEN_SANITIZED();
  std::mt19937 random(23);
  int crossed = 0, unclear = 0;
  for (int n = 0; n < cases(1500); ++n) {
    Body body = body_of(n % 2 ? soft_block({12, 11, 10}) : random_block(random, {12, 11, 10}));
    body.geometry = random_geometry(random);
    const Vec3d origin(body.elements.active_bounds().lo);
    const double size = std::pow(10.0, pick(random, -1, 1.5));
    TriangleMesh mesh{{}, {{0, 1, 2}}};
    const Vec3d place = origin + pick_vector(random, -2, 13);
    for (int k = 0; k < 3; ++k)
      mesh.vertices_lps_mm.push_back(place + pick_vector(random, -size, size));
    // Now and then in a lattice plane between voxels or with an edge along an axis.
    const int flat = int(random() % 9);
    for (Vec3d& v : mesh.vertices_lps_mm) {
      if (flat < 3) v[flat] = std::floor(place[flat]) + 0.5;
    }
    if (flat == 4) mesh.vertices_lps_mm[1] = mesh.vertices_lps_mm[0] + Vec3d(0, size, 0);
    cut(body, to_world(body.geometry, mesh));
    const auto& corners = mesh.vertices_lps_mm;
    for_each_lattice_link(body, [&](int axis, Slot low, Slot, bool is_cut) {
      // Barycentric coordinates by Cramer's rule: start + t step = a + s (b - a) + r (c - a).
      Vec3d step(0);
      step[axis] = 1;
      const Vec3d e1 = corners[1] - corners[0], e2 = corners[2] - corners[0];
      const Vec3d from = Vec3d(voxel_of(body.elements, low)) - corners[0];
      const double determinant = e1.cross(e2).dot(step);
      const double s = from.cross(e2).dot(step) / determinant;
      const double r = e1.cross(from).dot(step) / determinant;
      const double t = -e1.cross(e2).dot(from) / determinant;
      const double room = std::min({s, r, 1 - s - r, t, 1 - t});
      const Vec3d normal = e1.cross(e2).normalized();
      const double start = normal.dot(from), end = normal.dot(from + step);
      if (start * end > 0 && std::min(std::abs(start), std::abs(end)) > 1e-3) {
        EXPECT_FALSE(is_cut);
      } else if (std::abs(room) > 1e-3 &&
                 std::abs(determinant) > 1e-3 * e1.length() * e2.length()) {
        EXPECT_EQ(is_cut, room > 0) << "s " << s << " r " << r << " t " << t;
      } else {
        ++unclear;
      }
      crossed += is_cut;
    });
    if (HasFailure()) FAIL() << "case " << n;
  }
  EXPECT_GT(crossed, cases(4000));
  EXPECT_LT(unclear, crossed / 10);
  std::printf("crossed %d, too near to tell %d\n", crossed, unclear);
}

TEST(PropertyCuts, TheSidesOfAPlaneCutMoveIndependently) {
  std::mt19937 random(24);
  for (int n = 0; n < 40; ++n) {
    const Block block = soft_block({12, 11, 10});
    Body body = body_of(block);
    body.geometry = random_geometry(random);
    // A patch through the middle, much larger than the body.
    const Vec3d normal = pick_vector(random, -1, 1).normalized();
    const Vec3d e1 = normal.cross(Vec3d(0.3, 0.5, -0.7)).normalized(), e2 = normal.cross(e1);
    const Vec3d middle = Vec3d(5.5, 5, 4.5) + pick_vector(random, -1, 1);
    const Geometry& geometry = body.geometry;
    const CutReport report =
        cut(body, PlanePatch{geometry.world_from_index(middle - (e1 + e2) * 100.0),
                             geometry.world_vector_from_index(e1 * 200.0),
                             geometry.world_vector_from_index(e2 * 200.0)});
    EXPECT_GT(report.crossed, 90);
    const int grabbed = random_element(random, block);
    drag(body, {Handle(block.voxel(grabbed), {4000000, -4000000, 4000000})}, {});
    const double side = normal.dot(Vec3d(block.voxel(grabbed)) - middle);
    int moved = 0, anchored = 0;
    for_each_element(body.elements, [&](Slot slot) {
      const Vec3i voxel = voxel_of(body.elements, slot);
      const bool same_side = normal.dot(Vec3d(voxel) - middle) * side > 0;
      const bool at_rest =
          body.offset(voxel, 0) == 0 && body.offset(voxel, 1) == 0 && body.offset(voxel, 2) == 0;
      EXPECT_EQ(at_rest, !same_side) << voxel;
      (at_rest ? anchored : moved) += 1;
    });
    EXPECT_GT(moved, 100);
    EXPECT_GT(anchored, 100);
    if (HasFailure()) FAIL() << "case " << n;
  }
}

TEST(UnitCuts, ASecondCutAtTheSamePlaceFindsNothingNew) {
  Body body = body_of(soft_block({10, 4, 4}));
  const PlanePatch patch{{6.5, -5, -5}, {0, 20, 0}, {0, 0, 20}};
  const CutReport first = cut(body, patch), second = cut(body, patch);
  EXPECT_EQ(first.crossed, 16);
  EXPECT_EQ(first.newly_cut, 16);
  EXPECT_EQ(second.crossed, 16);
  EXPECT_EQ(second.newly_cut, 0);
  // A second one beside it shares nothing; a patch half as large crosses half of it.
  EXPECT_EQ(cut(body, PlanePatch{{7.5, -5, -5}, {0, 20, 0}, {0, 0, 6.5}}).newly_cut, 8);
  EXPECT_EQ(body.cuts.count(), 24);
  EXPECT_EQ(check_links(body).links, 9 * 16 + 2 * 10 * 12 - 24);
}

TEST(UnitCuts, APatchCutsTheLinksThatItsOwnEdgesCross) {
  // Cuts go from voxel centre to voxel centre, as far as the body goes, on all axes and both ways.
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3i dims(6, 5, 4);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    Vec3d corner(0), edge1(0), edge2(0);
    corner[axis] = 2.5;
    edge1[u] = dims[u] - 1;
    edge2[v] = dims[v] - 1;
    const int links = dims[u] * dims[v];
    Body low = body_of(soft_block(dims)), high = body_of(soft_block(dims));
    EXPECT_EQ(cut(low, PlanePatch{corner, edge1, edge2}).crossed, links) << axis;
    const PlanePatch back{corner + edge1 + edge2, -edge2, -edge1};
    EXPECT_EQ(cut(high, back).crossed, links) << axis;
    // A skew one of two rows of three lattice points.
    Body skew = body_of(soft_block(dims));
    Vec3d step(0);
    step[u] = step[v] = 1;
    Vec3d along(0);
    along[u] = 2;
    EXPECT_EQ(cut(skew, PlanePatch{corner, along, step}).crossed, 6) << axis;
  }
}

TEST(UnitCuts, ACutIsMadeInTheBodyAtRestHoweverFarItHasMoved) {
  Body body = body_of(soft_block({10, 4, 4}));
  drag(body, {Handle({0, 0, 0}, {600000, 400000, 0})}, {});
  ASSERT_GT(body.offset({6, 2, 2}, 0), 65536);
  Body rest = body_of(soft_block({10, 4, 4}));
  const PlanePatch patch{{6.5, -5, -5}, {0, 20, 0}, {0, 0, 20}};
  cut(body, patch);
  cut(rest, patch);
  EXPECT_TRUE(body.cuts == rest.cuts);
}

TEST(UnitCuts, TrianglesWithoutAreaAreCountedAndCrossNothing) {
  Body body = body_of(soft_block({10, 4, 4}));
  TriangleMesh mesh{{{3.5, -9, -9}, {3.5, 9, 9}, {3.5, 0, 0}, {5, 5, 5}},
                    {{0, 1, 2}, {0, 0, 1}, {3, 3, 3}}};
  const CutReport report = cut(body, mesh);
  EXPECT_EQ(report.degenerate, 3);
  EXPECT_EQ(report.crossed, 0);
  EXPECT_TRUE(body.cuts.empty());
  EXPECT_EQ(cut(body, PlanePatch{{3.5, -9, -9}, {0, 30, 0}, {0, 60, 0}}).degenerate, 2);
}

TEST(UnitCuts, SurfacesThatAreNotFiniteOrTooFarAreErrorsThatLeaveTheBodyAsItWas) {
  Body body = body_of(soft_block({10, 4, 4}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {nan, -HUGE_VAL, 1e300, 131072.0}) {
    const std::string error = input_error([&] {
      cut(body, TriangleMesh{{{6.5, -9, -9}, {6.5, 90, -9}, {6.5, -9, 90}, {1, bad, 1}},
                             {{0, 1, 2}, {0, 1, 3}}});
    });
    EXPECT_NE(error.find(": found a vertex at voxel"), std::string::npos) << error;
    EXPECT_TRUE(body.cuts.empty());
  }
}

TEST(ExtremesCuts, NeedlesDustAndPatchesFarLargerThanTheBodyLeaveNoGap) {
  // The same plane as one huge patch, as dust and as needles.
  Body whole = body_of(soft_block({10, 9, 8})), dust = whole, needles = whole;
  const Vec3d corner(-0.7, 3.3, -0.9), e1(11.9, 0.8, 0.3), e2(-0.2, 1.1, 9.7);
  cut(whole, PlanePatch{corner - e1 * 4000.0 - e2 * 4000.0, e1 * 8000.0, e2 * 8000.0});
  EXPECT_EQ(whole.cuts.count() > 80, true);
  const auto grid = [&](int columns, int rows) {
    TriangleMesh mesh;
    for (int y = 0; y <= rows; ++y) {
      for (int x = 0; x <= columns; ++x) {
        mesh.vertices_lps_mm.push_back(corner + e1 * (double(x) / columns) +
                                       e2 * (double(y) / rows));
      }
    }
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        const int a = y * (columns + 1) + x, b = a + columns + 1;
        mesh.triangles.push_back({a, a + 1, b});
        mesh.triangles.push_back({a + 1, b + 1, b});
      }
    }
    return mesh;
  };
  cut(dust, grid(300, 250));
  cut(needles, grid(1, 20000));
  EXPECT_TRUE(dust.cuts == whole.cuts);
  EXPECT_TRUE(needles.cuts == whole.cuts);
}

TEST(ExtremesCuts, BodiesWithoutLinksAreLeftAlone) {
  const TriangleMesh sphere = unit_sphere(2);
  Body nothing;
  EXPECT_EQ(cut(nothing, sphere).crossed, 0);
  Body voxel = soft_row(1);
  EXPECT_EQ(cut(voxel, sphere).crossed, 0);
  EXPECT_EQ(cut_boundary(voxel, [](Slot) { return true; }).crossed, 0);
  Body chain = body_of(soft_block({1, 1, 30}));
  EXPECT_EQ(cut(chain, PlanePatch{{-1, -1, 20.5}, {3, 0, 0}, {0, 3, 0}}).crossed, 1);
  drag(chain, {Handle({0, 0, 21}, {9000000, 0, 0})}, {});
  EXPECT_EQ(chain.offset({0, 0, 20}, 0), 0);
  EXPECT_NE(chain.offset({0, 0, 29}, 0), 0);
}

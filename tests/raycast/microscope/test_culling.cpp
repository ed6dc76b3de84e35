// Triangles that the microscope leaves out may not be seen: they are in no list of a block, of a
// camera's picture or of the lamp's light.
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "raycast/microscope/shape_scene.h"
#include "raycast/microscope/triangle_bins.h"
#include "raycast/microscope/triangle_lanes.h"
#include "tests/raycast/microscope/microscope_scenes.h"

namespace supple {
namespace {

using Random = std::mt19937;
using Corners = std::array<Vec3f, 3>;

double number(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
Vec3d place_in(Random& random, double half) {
  return {number(random, -half, half), number(random, -half, half), number(random, -half, half)};
}
Corners triangle_near(Random& random, const Vec3d& middle, double size) {
  return {Vec3f(middle + place_in(random, size)), Vec3f(middle + place_in(random, size)),
          Vec3f(middle + place_in(random, size))};
}
Vec3d place_on(Random& random, const Corners& corners) {
  double u = number(random, 0, 1), v = number(random, 0, 1);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  return Vec3d(corners[0] * float(1 - u - v) + corners[1] * float(u) + corners[2] * float(v));
}

/// The place where a line meets a triangle, in lengths of its direction, and its distance from the
/// sides as a part of them; by Cramer's rule.
struct Meeting {
  double distance, inside;
};
std::optional<Meeting> meeting(const Corners& corners, const Vec3d& origin,
                               const Vec3d& direction) {
  const Vec3d a(corners[1] - corners[0]), b(corners[2] - corners[0]);
  const Vec3d across = a.cross(b), apart = Vec3d(corners[0]) - origin;
  const double steep = across.dot(direction);
  if (std::abs(steep) < 1e-12) return std::nullopt;
  const double u = apart.cross(direction).dot(b) / steep;
  const double v = -apart.cross(direction).dot(a) / steep;
  return Meeting{across.dot(apart) / steep, std::min({u, v, 1 - u - v})};
}

bool has(const TriangleList& list, std::uint32_t number) {
  return std::count(list.begin, list.begin + list.count, number) == 1;
}

TEST(PropertyMicroscopeCulling, BlocksOfAllPlacesOfTrianglesAreMarkedAndFewOthers) {
  Random random(3);
  constexpr int kWidth = 157, kHeight = 118;
  const Camera camera = eye_camera();
  int marked = 0, touched = 0;
  for (int n = 0; n < 60; ++n) {
    const Corners corners = triangle_near(random, place_in(random, 6), number(random, 0.05, 8));
    TriangleBins seen;
    seen.begin(lens_of(camera, kWidth, kHeight), kWidth, kHeight);
    seen.add(7, corners);
    seen.finish();
    std::vector<std::uint8_t> is_touched(40 * 30, 0);
    for (int k = 0; k < 20000; ++k) {
      double x = 0, y = 0;
      ASSERT_TRUE(project_to_pixel(camera, kWidth, kHeight, place_on(random, corners), x, y));
      if (x < 0 || y < 0 || x >= kWidth || y >= kHeight) continue;
      ASSERT_TRUE(has(seen.at_pixel(int(x), int(y)), 7)) << n << ": " << x << " " << y;
      is_touched[std::size_t(int(y) / 4 * 40 + int(x) / 4)] = 1;
    }
    for (int b = 0; b < 40 * 30; ++b) {
      touched += is_touched[std::size_t(b)];
      marked += seen.at_pixel(b % 40 * 4, b / 40 * 4).count;
    }
  }
  EXPECT_GT(touched, 2000);
  EXPECT_LT(marked, 1.5 * touched);
}

TEST(ExtremesMicroscopeCulling, OfTrianglesThroughTheCameraOnlyWhatLiesBeforeItCounts) {
  const Camera camera = eye_camera();
  const auto bins_of = [&](const Corners& corners) {
    TriangleBins bins;
    bins.begin(lens_of(camera, 160, 80), 160, 80);
    bins.add(0, corners);
    bins.finish();
    return bins;
  };
  EXPECT_TRUE(bins_of({Vec3f(0, 0, 201), {1, 0, 205}, {0, 1, 300}}).is_empty());
  const Corners through = {Vec3f(0.5f, 0, 250), {-3, 0.5f, 0}, {-3.5f, -0.5f, 0}};
  const TriangleBins bins = bins_of(through);
  Random random(4);
  int seen = 0;
  for (int k = 0; k < 20000; ++k) {
    double x = 0, y = 0;
    const Vec3d place = place_on(random, through);
    if (place.z > 199 || !project_to_pixel(camera, 160, 80, place, x, y)) continue;
    if (x < 0 || y < 0 || x >= 160 || y >= 80) continue;
    EXPECT_TRUE(has(bins.at_pixel(int(x), int(y)), 0)) << x << " " << y;
    ++seen;
  }
  EXPECT_GT(seen, 100);
  EXPECT_FALSE(has(bins.at_pixel(159, 5), 0));
}

TEST(PropertyMicroscopeCulling, FirstHitsAreThoseOfAllTrianglesOneByOne) {
  Random random(11);
  std::vector<Corners> corners;
  std::vector<TriangleFloats> triangles;
  std::vector<std::uint32_t> numbers;
  for (int n = 0; n < 40; ++n) {
    corners.push_back(triangle_near(random, place_in(random, 3), number(random, 0.1, 2)));
    triangles.push_back(triangle_floats(corners.back()));
    triangles.back().shape = n % 3;
    numbers.push_back(std::uint32_t(n));
  }
  int compared = 0;
  for (int round = 0; round < 300; ++round) {
    PacketRays rays;
    rays.active = kWholePacket & ~(1u << round % 16);
    for (int lane = 0; lane < kPacketRays; ++lane) {
      rays.origin.set(lane, Vec3f(Vec3d(0, 0, 200)));
      rays.direction.set(lane, Vec3f((place_in(random, 3) - Vec3d(0, 0, 200)).normalized()));
      rays.near[lane] = float(number(random, 190, 200)), rays.far[lane] = 203;
    }
    PacketHits hits;
    first_hits(triangles.data(), {numbers.data(), int(numbers.size())}, rays, hits);
    EXPECT_EQ(hits.met & ~rays.active, 0u);
    for (int lane = 0; lane < kPacketRays; ++lane) {
      double nearest = rays.far[lane];
      int found = -1;
      bool is_sure = (rays.active >> lane & 1) != 0;
      for (std::size_t n = 0; n < corners.size(); ++n) {
        const auto at = meeting(corners[n], Vec3d(rays.origin[lane]), Vec3d(rays.direction[lane]));
        if (!at || at->inside < -1e-3) continue;
        // Rounding may decide at sides and ends.
        is_sure &= at->inside > 1e-3 && std::abs(at->distance - rays.near[lane]) > 1e-3;
        if (at->distance < rays.near[lane] || at->distance >= nearest) continue;
        nearest = at->distance, found = int(n);
      }
      if (!is_sure) continue;
      ASSERT_EQ((hits.met >> lane & 1) != 0, found >= 0);
      ++compared;
      if (found < 0) continue;
      ASSERT_EQ(hits.triangle[lane], found);
      ASSERT_EQ(hits.shape[lane], found % 3);
      ASSERT_NEAR(hits.distance[lane], nearest, 1e-4);
      const Corners& c = corners[std::size_t(found)];
      const float u = hits.u[lane], v = hits.v[lane];
      const Vec3f there = c[0] * (1 - u - v) + c[1] * u + c[2] * v;
      ASSERT_LT((there - rays.origin[lane] - rays.direction[lane] * hits.distance[lane]).length(),
                1e-3);
    }
  }
  EXPECT_GT(compared, 2000);
}

/// Triangles near a lamp's light, lists of places in a ball, and what stands between.
struct Shading {
  LampFloats lamp;
  std::vector<Corners> corners;
  ShapeScene shapes;

  Shading(Random& random, double cone_degrees, const DiscReach& disc) {
    lamp.is_on = true;
    lamp.place = {-2, 1, -3};
    lamp.direction = Vec3f(Vec3d(0.3, -0.1, -1).normalized());
    lamp.cosine_none = float(std::cos(cone_degrees * kPi / 180));
    for (int n = 0; n < 12; ++n) {
      const Vec3d middle =
          Vec3d(lamp.place) + Vec3d(lamp.direction) * number(random, -0.5, 8) + place_in(random, 3);
      const double size = std::exp(number(random, -3, 0));
      corners.push_back(triangle_near(random, middle, size));
      const int shape = shapes.add({n % 2 == 0, 0.5});
      shapes.shape(shape,
                   {Vec3d(corners.back()[0]), Vec3d(corners.back()[1]), Vec3d(corners.back()[2])},
                   {{0, 1, 2}}, 0);
    }
    shapes.commit();
    shapes.light_from(lamp, disc);
  }
};

/// Rays of a packet to places of the lamp's disc. Every other packet is one ray that is aimed past
/// a place of a triangle from the disc's rim.
PacketRays shadow_rays_of(Random& random, const Shading& shading, const DiscReach& disc,
                          bool is_aimed) {
  const Vec3d direction(shading.lamp.direction), place(shading.lamp.place);
  const Vec3d across = direction.cross(Vec3d(1, 0, 0)).normalized();
  const Vec3d aside = direction.cross(across);
  const double spread = std::exp(number(random, -4, 1));
  const Vec3d middle(place + direction * number(random, 1, 9) + place_in(random, 2));
  PacketRays rays;
  for (int lane = 0; lane < kPacketRays; ++lane) {
    const double angle = number(random, 0, 2 * kPi);
    const double part = is_aimed ? 1 : number(random, 0, 1);
    const Vec3d to = place + (across * std::cos(angle) + aside * std::sin(angle)) *
                                 (part * double(disc.radius_mm));
    Vec3d from = middle + place_in(random, spread);
    if (is_aimed) {
      const auto n = std::size_t(number(random, 0, double(shading.corners.size())));
      from = to + (place_on(random, shading.corners[n]) - to) * std::exp(number(random, 0.05, 3));
    }
    rays.origin.set(lane, Vec3f(from));
    rays.direction.set(lane, Vec3f(to - from));
    rays.near[lane] = 0, rays.far[lane] = 1;
    const Vec3d way = from - place;
    const bool is_lit = way.normalized().dot(direction) > shading.lamp.cosine_none + 1e-4;
    const bool is_within = disc.ball_mm <= 0 || (from - Vec3d(disc.centre)).length() < disc.ball_mm;
    if (is_lit && is_within && (!is_aimed || lane == 3)) rays.active |= 1u << lane;
  }
  return rays;
}

/// Compares the light that passes with what stands between, triangle by triangle; returns how many
/// places were compared and how many are shaded.
std::array<int, 2> compare_shades(Random& random, const Shading& shading, const DiscReach& disc) {
  const TriangleBins& bins = shading.shapes.before_lamp();
  TriangleRoom room;
  std::array<int, 2> counts{0, 0};
  for (int round = 0; round < 500; ++round) {
    const PacketRays rays = shadow_rays_of(random, shading, disc, round % 2 == 0);
    std::uint32_t wanted = rays.active;
    const PacketPixels pixels = bins.pixels_of(rays.origin);
    LaneFloats part;
    while (wanted != 0) {
      PacketRays near = rays;
      const TriangleList list = bins.list_near(pixels, wanted, near.active, room);
      LaneFloats found;
      shading.shapes.passing(near, list, found);
      for (int lane = 0; lane < kPacketRays; ++lane) {
        if ((near.active >> lane & 1) != 0) part[lane] = found[lane];
      }
    }
    for (int lane = 0; lane < kPacketRays; ++lane) {
      bool is_sure = (rays.active >> lane & 1) != 0;
      double expected = 1;
      for (std::size_t n = 0; n < shading.corners.size(); ++n) {
        const auto at =
            meeting(shading.corners[n], Vec3d(rays.origin[lane]), Vec3d(rays.direction[lane]));
        if (!at || at->inside < -1e-3 || at->distance < -1e-3 || at->distance > 1.001) continue;
        is_sure &= at->inside > 1e-3 && at->distance > 1e-3 && at->distance < 0.97;
        expected *= n % 2 == 0 ? 0 : 0.5;
      }
      if (!is_sure) continue;
      EXPECT_NEAR(part[lane], expected, 1e-4);
      ++counts[0];
      counts[1] += expected < 1;
    }
  }
  return counts;
}

TEST(PropertyMicroscopeCulling, ShadesAreThoseOfAllTrianglesForPointsDiscsAndWideCones) {
  Random random(5);
  const DiscReach point, disc{1.2f, {0, 0, 0}, 0}, in_ball{1.2f, {0, 0, 0}, 11};
  for (const DiscReach& reach : {point, disc, in_ball}) {
    for (const double cone_degrees : {35.0, 70.0, 110.0}) {
      std::array<int, 2> sum{0, 0};
      for (int n = 0; n < 12; ++n) {
        const Shading shading(random, cone_degrees, reach);
        const auto [compared, shaded] = compare_shades(random, shading, reach);
        sum[0] += compared, sum[1] += shaded;
      }
      EXPECT_GT(sum[0], 5000) << cone_degrees;
      EXPECT_GT(sum[1], 400) << cone_degrees;
    }
  }
}

TEST(UnitMicroscopeCulling, AShapeThatGrowsMovesTheNumbersOfThoseBehindIt) {
  ShapeScene shapes;
  const SoftSheet few = flat_sheet(1, -9, 3), many = flat_sheet(1, -9, 8);
  const int grows = shapes.add({}), stays = shapes.add({});
  shapes.shape(grows, few.vertices, few.triangles, 180);
  const SoftSheet above = flat_sheet(0.5, -8, 2);
  shapes.shape(stays, above.vertices, above.triangles, 180);
  for (const SoftSheet& sheet : {few, many, few}) {
    shapes.shape(grows, sheet.vertices, sheet.triangles, 180);
    shapes.commit();
    TriangleBins seen;
    shapes.sort_seen(lens_of(eye_camera(), 160, 120), 160, 120, seen);
    PacketRays rays;
    rays.active = kWholePacket;
    for (int lane = 0; lane < kPacketRays; ++lane) {
      rays.origin.set(lane, {0.1f, 0.1f, 0});
      rays.direction.set(lane, {0, 0, -1});
      rays.near[lane] = 0, rays.far[lane] = 20;
    }
    PacketHits hits;
    shapes.first_hits(rays, seen.at_pixel(81, 59), hits);
    EXPECT_EQ(hits.met, kWholePacket);
    EXPECT_EQ(hits.shape[0], stays);
    EXPECT_FLOAT_EQ(hits.distance[0], 8);
  }
}

// The wall behind a thin sheet keeps its half shadows narrow.
TEST(UnitMicroscopeCulling, ABallShortensListsOfADisc) {
  const auto length = [](float ball_mm) {
    LampFloats lamp;
    lamp.is_on = true;
    lamp.cosine_none = 0.8f;
    ShapeScene shapes;
    const SoftSheet sheet = flat_sheet(2, -10.5, 30);
    shapes.shape(shapes.add({}), sheet.vertices, sheet.triangles, 180);
    shapes.commit();
    shapes.light_from(lamp, {0.3f, {0, 0, 0}, ball_mm});
    int sum = 0;
    for (int pixel = 0; pixel < 400; pixel += 4) {
      sum += shapes.before_lamp().at_pixel(pixel, 200).count;
    }
    return sum;
  };
  EXPECT_LT(length(11), 0.5 * length(0));
}

}  // namespace
}  // namespace supple

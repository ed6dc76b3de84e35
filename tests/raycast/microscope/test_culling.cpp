// What the microscope leaves out may not be seen: blocks of pixels without triangles, and ways to
// the light that no box stands in.
#include <random>

#include <gtest/gtest.h>

#include "raycast/microscope/caster_box.h"
#include "raycast/microscope/seen_blocks.h"
#include "tests/raycast/microscope/microscope_scenes.h"

namespace supple {
namespace {

using Random = std::mt19937;

double number(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
Vec3d place_in(Random& random, double half) {
  return {number(random, -half, half), number(random, -half, half), number(random, -half, half)};
}

TEST(PropertyMicroscopeCulling, BlocksOfAllPlacesOfTrianglesAreMarkedAndFewOthers) {
  Random random(3);
  constexpr int kWidth = 157, kHeight = 118;
  const Camera camera = eye_camera();
  int marked = 0, touched = 0;
  for (int n = 0; n < 60; ++n) {
    std::vector<Vec3f> corners;
    const Vec3d middle = place_in(random, 6);
    const double size = number(random, 0.05, 8);
    for (int c = 0; c < 3; ++c) corners.emplace_back(middle + place_in(random, size));
    SeenBlocks seen;
    seen.begin(lens_of(camera, kWidth, kHeight), kWidth, kHeight);
    seen.add(corners, {{0, 1, 2}});
    std::vector<std::uint8_t> is_touched(40 * 30, 0);
    for (int k = 0; k < 20000; ++k) {
      double u = number(random, 0, 1), v = number(random, 0, 1);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vec3d place(corners[0] * float(1 - u - v) + corners[1] * float(u) +
                        corners[2] * float(v));
      double x = 0, y = 0;
      ASSERT_TRUE(project_to_pixel(camera, kWidth, kHeight, place, x, y));
      if (x < 0 || y < 0 || x >= kWidth || y >= kHeight) continue;
      ASSERT_TRUE(seen.has(int(x), int(y))) << n << ": " << x << " " << y;
      is_touched[std::size_t(int(y) / 4 * 40 + int(x) / 4)] = 1;
    }
    for (int b = 0; b < 40 * 30; ++b) {
      touched += is_touched[std::size_t(b)];
      marked += seen.has(b % 40 * 4, b / 40 * 4);
    }
  }
  EXPECT_GT(touched, 2000);
  EXPECT_LT(marked, 1.5 * touched);
}

TEST(ExtremesMicroscopeCulling, TrianglesBehindTheCameraMarkNothingAndOnesThroughItAll) {
  SeenBlocks seen;
  seen.begin(lens_of(eye_camera(), 16, 8), 16, 8);
  seen.add({{0, 0, 201}, {1, 0, 205}, {0, 1, 300}}, {{0, 1, 2}});
  EXPECT_FALSE(seen.has(7, 3));
  seen.add({{0, 0, 201}, {1, 0, 205}, {0, 1, 100}}, {{0, 1, 2}});
  for (int x = 0; x < 16; ++x) EXPECT_TRUE(seen.has(x, x / 2));
}

TEST(PropertyMicroscopeCulling, ABoxMayBeMetWhereverAWayPassesAVertexAndFarWaysMeetNone) {
  Random random(5);
  int missed = 0;
  for (int n = 0; n < 3000; ++n) {
    ShapeMotion motion;
    const Vec3d z = place_in(random, 1).normalized();
    const Vec3d x = z.cross(place_in(random, 1)).normalized();
    motion.x = Vec3f(x), motion.y = Vec3f(z.cross(x)), motion.z = Vec3f(z);
    motion.origin = Vec3f(place_in(random, 5));
    std::vector<Vec3d> vertices;
    for (int k = 0; k < 8; ++k) vertices.push_back(place_in(random, number(random, 0.1, 3)));
    const CasterBox box(vertices, motion);
    const Vec3f met = motion.turned(Vec3f(vertices[std::size_t(n % 8)])) + motion.origin;
    const Vec3f light(place_in(random, 8)), place = light + (met - light) * 1.7f;
    PacketPlaces places{};
    for (int lane = 0; lane < kPacketRays; ++lane) {
      places.at.set(lane, place + Vec3f(place_in(random, lane == 5 ? 0 : 0.3)));
    }
    EXPECT_TRUE(box.may_meet(segment_between(places, kWholePacket, light, 0)));
    EXPECT_TRUE(box.may_meet(segment_between(places, 1u << 5, light, 0)));
    missed += !box.may_meet(segment_between(places, kWholePacket, place + Vec3f(0, 0, 2), 0));
  }
  EXPECT_GT(missed, 500);
}

}  // namespace
}  // namespace supple

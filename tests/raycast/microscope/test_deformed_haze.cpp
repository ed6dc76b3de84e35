#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "raycast/microscope/deformed_haze.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/field/inversion/invert.h"

namespace supple {
namespace {

constexpr double kSpacing = 0.5;  // mm
constexpr double kEndless = std::numeric_limits<double>::infinity();

struct HazeBody {
  /// Densities of a function of the voxel; 0 is void.
  HazeBody(int dim, const std::function<float(const Vec3i&)>& density_at)
      : geometry(Vec3i(dim), Vec3d(-kSpacing * (dim - 1) / 2),
                 {Vec3d(kSpacing, 0, 0), Vec3d(0, kSpacing, 0), Vec3d(0, 0, kSpacing)}) {
    std::vector<Vec3i> origins;
    std::vector<BrickMask> masks;
    for (int x = 0; x < dim; x += kBrickDim) {
      for (int y = 0; y < dim; y += kBrickDim) {
        for (int z = 0; z < dim; z += kBrickDim) {
          BrickMask mask{};
          for (int n = 0; n < kBrickVoxels; ++n) {
            const Vec3i v = Vec3i(x, y, z) + brick_local(n);
            if (std::max({v.x, v.y, v.z}) < dim && density_at(v) > 0) mask_set(mask, n);
          }
          origins.emplace_back(x, y, z);
          masks.push_back(mask);
        }
      }
    }
    const BrickTopology bricks(std::move(origins), std::move(masks));
    std::vector<float> values(bricks.brick_count() * kBrickVoxels, 0);
    for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
      for_each_active(bricks.mask(b), [&](int n) {
        values[b * kBrickVoxels + std::size_t(n)] = density_at(bricks.origin(b) + brick_local(n));
      });
    }
    density = make_density_grid(bricks, values, 0);
  }

  Displacement moved(const std::function<Vec3f(const Vec3i&)>& u_at) const {
    const BrickTopology& bricks = density.bricks();
    Displacement displacement{geometry, {bricks, BrickVectors(bricks.brick_count())}};
    for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
      for_each_active(bricks.mask(b), [&](int n) {
        displacement.u.vectors.touch(b)[n] = u_at(bricks.origin(b) + brick_local(n));
      });
    }
    return displacement;
  }

  Geometry geometry;
  DensityGrid density;
};

/// Ways of all elements as bodies keep them.
class Ways {
 public:
  explicit Ways(const Displacement& displacement) : m_bricks(displacement.u.topology) {
    for (std::size_t b = 0; b < m_bricks.brick_count(); ++b) m_left.push_back(m_bricks.mask(b));
    for (std::vector<std::int32_t>& ways : m_ways) ways.resize(m_left.size() * kBrickVoxels, 0);
    for_each_voxel(m_bricks, [&](const Vec3i& voxel) {
      Vec3f u;
      EXPECT_TRUE(displacement.u.at(voxel, u));
      const std::size_t n = slot(voxel);
      for (std::size_t c = 0; c < 3; ++c) {
        m_ways[c][n] = std::int32_t(std::lround(65536 * u[int(c)]));
      }
    });
  }
  void remove(const std::vector<Vec3i>& voxels) {
    for (const Vec3i& voxel : voxels) {
      const std::size_t n = slot(voxel) % kBrickVoxels;
      m_left[slot(voxel) / kBrickVoxels][n / 64] &= ~(std::uint64_t(1) << (n % 64));
    }
  }
  std::vector<HazeElements> bricks() const {
    std::vector<HazeElements> list;
    for (std::size_t b = 0; b < m_left.size(); ++b) {
      const std::size_t at = b * kBrickVoxels;
      list.push_back(
          {m_bricks.origin(b), m_left[b], {&m_ways[0][at], &m_ways[1][at], &m_ways[2][at]}});
    }
    return list;
  }

 private:
  std::size_t slot(const Vec3i& voxel) const {
    return std::size_t(m_bricks.find(voxel)) * kBrickVoxels + std::size_t(brick_offset(voxel));
  }
  BrickTopology m_bricks;
  std::vector<BrickMask> m_left;
  std::array<std::vector<std::int32_t>, 3> m_ways;
};

/// A ball with structure in the middle of a box.
HazeBody structured_ball(int dim = 33) {
  const double middle = (dim - 1) / 2.0;
  return HazeBody(dim, [middle](const Vec3i& v) {
    const Vec3d from = Vec3d(v) - Vec3d(middle);
    const double wave = std::sin(0.9 * v.x) * std::cos(0.7 * v.y) + std::sin(0.5 * v.z);
    return from.length() < 9 ? float(120 + 50 * wave) : 0;
  });
}

Camera camera_from(const Vec3d& position, double height_mm) {
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.position_lps_mm = position;
  camera.target_lps_mm = position - Vec3d(0, 0, position.z);
  camera.up_lps = {0, 1, 0};
  camera.height_mm = height_mm;
  return camera;
}

Camera oblique_camera() {
  Camera camera;
  camera.position_lps_mm = {12, -17, 25};
  camera.target_lps_mm = {0.3, 0.2, 0.1};
  camera.up_lps = {0, 1, 0};
  camera.vertical_fov_degrees = 22;
  return camera;
}

RayDepths depths_of(int width, int height, double mm = kEndless) {
  return {width, height, std::vector<float>(std::size_t(width * height), float(mm))};
}

HazeLook bright() {
  HazeLook look;
  look.ambient = 1;
  return look;
}

double largest_difference(const FloatImage& a, const FloatImage& b) {
  EXPECT_EQ(a.rgba.size(), b.rgba.size());
  double largest = 0;
  for (std::size_t n = 0; n < a.rgba.size(); ++n) {
    largest = std::max(largest, std::abs(double(a.rgba[n]) - double(b.rgba[n])));
  }
  return largest;
}

double largest_opacity(const FloatImage& picture) {
  double largest = 0;
  for (std::size_t n = 3; n < picture.rgba.size(); n += 4) {
    largest = std::max(largest, double(picture.rgba[n]));
  }
  return largest;
}

/// Length of a ray in the box of voxel centres, up to a depth.
double chord_mm(const Geometry& geometry, const Ray& ray, double depth_mm) {
  double from = 0, to = depth_mm;
  const Vec3d lo = geometry.world_from_index(Vec3d(0)),
              hi = geometry.world_from_index(Vec3d(geometry.dims() - Vec3i(1)));
  for (int c = 0; c < 3; ++c) {
    const double a = (lo[c] - ray.origin_lps_mm[c]) / ray.direction_lps[c];
    const double b = (hi[c] - ray.origin_lps_mm[c]) / ray.direction_lps[c];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return std::max(0.0, to - from);
}

TEST(UnitDeformedHaze, UniformHazeDimsByBeerAndLambertUpToTheDepth) {
  const HazeBody body(17, [](const Vec3i&) { return 200.0f; });
  DeformedHaze haze(bright());
  haze.set_body(body.geometry, body.density);
  const Camera camera = oblique_camera();
  for (const double depth : {kEndless, 32.0, 30.0, 3.0}) {
    const FloatImage picture = haze.draw(camera, depths_of(50, 38, depth));
    const CameraRays rays(camera, 50, 38);
    for (int y = 0; y < 38; ++y) {
      for (int x = 0; x < 50; ++x) {
        const double chord = chord_mm(body.geometry, rays.at(x + 0.5, y + 0.5), depth);
        const double opacity = 1 - std::exp(-HazeLook().extinction_per_mm * 200 / 255 * chord);
        const float* rgba = picture.rgba.data() + 4 * (50 * y + x);
        ASSERT_NEAR(rgba[3], opacity, 2e-5) << x << " " << y << " " << depth;
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_NEAR(rgba[c], opacity * bright().rgb[c], 2e-5);  // all of it is lit by 1
        }
      }
    }
    EXPECT_EQ(largest_opacity(picture) > 0.1, depth > 20);
  }
}

TEST(PropertyDeformedHaze, ATranslatedBodyDrawsTheShiftedPicture) {
  const HazeBody body = structured_ball();
  DeformedHaze rest(bright()), moved(bright());
  rest.set_body(body.geometry, body.density);
  moved.set_body(body.geometry, body.density);
  const Displacement shift = body.moved([](const Vec3i&) { return Vec3f(4, -3, 0); });
  moved.update(Ways(shift).bricks());
  const RayDepths depths = depths_of(60, 60);
  const Vec3d by = Vec3d(4, -3, 0) * kSpacing;
  const FloatImage before = rest.draw(camera_from({0, 0, 30}, 14), depths);
  const FloatImage after = moved.draw(camera_from(Vec3d(0, 0, 30) + by, 14), depths);
  EXPECT_GT(largest_opacity(before), 0.2);
  EXPECT_LT(largest_difference(before, after), 1e-4);
  EXPECT_GT(largest_difference(before, moved.draw(camera_from({0, 0, 30}, 14), depths)), 0.1);
}

TEST(PropertyDeformedHaze, ADisplacementOfZeroDrawsTheBodyAtRest) {
  const HazeBody body = structured_ball();
  DeformedHaze rest, still;
  rest.set_body(body.geometry, body.density);
  still.set_body(body.geometry, body.density);
  const Displacement none = body.moved([](const Vec3i&) { return Vec3f(0); });
  still.update(Ways(none).bricks());
  const RayDepths depths = depths_of(60, 45);
  EXPECT_EQ(rest.draw(oblique_camera(), depths).rgba, still.draw(oblique_camera(), depths).rgba);
}

Vec3f wave_at(const Vec3i& v) {
  return {float(1.5 * std::sin(0.2 * v.y)), float(1.2 * std::cos(0.25 * v.z)),
          float(0.8 * std::sin(0.3 * v.x))};
}

/// The same light by double precision: offsets and densities as everyone else reads them.
double opacity_of(const HazeBody& body, const OffsetField& offsets, const Ray& ray) {
  constexpr double kStepMm = 0.02;
  double thickness = 0;
  for (double t = 10; t < 50; t += kStepMm) {
    const Vec3d x = body.geometry.index_from_world(ray.origin_lps_mm + ray.direction_lps * t);
    Vec3d o;
    if (offsets.sample(x, o)) thickness += double(sample_trilinear(body.density, x + o, 0));
  }
  return 1 - std::exp(-HazeLook().extinction_per_mm / 255 * thickness * kStepMm);
}

TEST(PropertyDeformedHaze, DeformedItIsReadAtTheOffsetsOfTheInverse) {
  const HazeBody ball = structured_ball();
  // Nearly empty around it, so that all of the ball lies between known offsets.
  const HazeBody body(33, [&](const Vec3i& v) { return std::max(ball.density.at(v), 1e-3f); });
  const Displacement wave = body.moved(wave_at);
  const OffsetField offsets = invert(wave);
  HazeLook look = bright();
  look.step_voxels = 0.25;
  DeformedHaze haze(look);
  haze.set_body(body.geometry, body.density);
  haze.update(Ways(wave).bricks());
  const Camera camera = oblique_camera();
  const FloatImage picture = haze.draw(camera, depths_of(40, 30));
  const CameraRays rays(camera, 40, 30);
  double sum = 0, rest_sum = 0;
  DeformedHaze rest(look);
  rest.set_body(body.geometry, body.density);
  const FloatImage at_rest = rest.draw(camera, depths_of(40, 30));
  int count = 0;
  for (int y = 0; y < 30; y += 3) {
    for (int x = 0; x < 40; x += 3) {
      const double expected = opacity_of(body, offsets, rays.at(x + 0.5, y + 0.5));
      if (expected < 0.05) continue;
      const std::size_t n = 4 * std::size_t(40 * y + x) + 3;
      sum += std::abs(double(picture.rgba[n]) - expected);
      rest_sum += std::abs(double(at_rest.rgba[n]) - expected);
      EXPECT_NEAR(picture.rgba[n], expected, 0.02) << x << " " << y;
      ++count;
    }
  }
  EXPECT_GT(count, 20);
  EXPECT_LT(sum / count, 0.006);
  EXPECT_GT(rest_sum, 2 * sum);
}

/// A bump of ways that wanders.
Vec3f bump_at(const Vec3i& v, int step) {
  const Vec3d from = Vec3d(v) - Vec3d(12 + step, 18, 14 + 0.5 * step);
  const double part = std::max(0.0, 1 - from.dot(from) / 64);
  return {float(1.8 * part * part), float(-1.2 * part * part), float(0.9 * part * part)};
}

TEST(PropertyDeformedHaze, FollowingStepByStepDrawsWhatANewOneWould) {
  const HazeBody body = structured_ball();
  DeformedHaze haze(bright());
  haze.set_body(body.geometry, body.density);
  const RayDepths depths = depths_of(60, 45);
  const FloatImage rest = haze.draw(oblique_camera(), depths);
  for (int n = 1; n <= 9; ++n) {
    const Ways ways(body.moved([&](const Vec3i& v) { return bump_at(v, n); }));
    haze.update(ways.bricks());
    DeformedHaze anew(bright());
    anew.set_body(body.geometry, body.density);
    anew.update(ways.bricks());
    const FloatImage expected = anew.draw(oblique_camera(), depths);
    ASSERT_LT(largest_difference(haze.draw(oblique_camera(), depths), expected), 0.004) << n;
    ASSERT_GT(largest_difference(rest, expected), 0.02) << n;
  }
  haze.update(Ways(body.moved([](const Vec3i&) { return Vec3f(0); })).bricks());
  EXPECT_LT(largest_difference(rest, haze.draw(oblique_camera(), depths)), 0.004);
}

TEST(PropertyDeformedHaze, RemovedVoxelsAreDrawnAsIfTheyHadNeverBeen) {
  const HazeBody body = structured_ball();
  const auto is_taken = [](const Vec3i& v) { return v.x > 16 && v.y < 18; };
  const HazeBody rest(33, [&](const Vec3i& v) { return is_taken(v) ? 0 : body.density.at(v); });
  std::vector<Vec3i> some, all;
  for_each_voxel(body.density.bricks(), [&](const Vec3i& v) {
    all.push_back(v);
    if (is_taken(v)) some.push_back(v);
  });
  DeformedHaze haze, expected;
  haze.set_body(body.geometry, body.density);
  expected.set_body(rest.geometry, rest.density);
  const RayDepths depths = depths_of(60, 45);
  const FloatImage before = haze.draw(oblique_camera(), depths);
  Ways ways(body.moved([](const Vec3i&) { return Vec3f(0); }));
  ways.remove(some);
  haze.update(ways.bricks());
  const FloatImage after = haze.draw(oblique_camera(), depths);
  EXPECT_EQ(after.rgba, expected.draw(oblique_camera(), depths).rgba);
  EXPECT_GT(largest_difference(before, after), 0.1);
  ways.remove(all);
  haze.update(ways.bricks());
  EXPECT_EQ(largest_opacity(haze.draw(oblique_camera(), depths)), 0);
}

TEST(PropertyDeformedHaze, OnlyTheLampsConeIsBrightAndOpacityIsThatOfTheHaze) {
  const HazeBody body(33, [](const Vec3i&) { return 100.0f; });
  HazeLook look;
  look.ambient = 0;
  DeformedHaze haze(look);
  haze.set_body(body.geometry, body.density);
  const RayDepths depths = depths_of(64, 64);
  const Camera camera = camera_from({0, 0, 30}, 16);
  EXPECT_EQ(haze.draw(camera, depths).rgba[0], 0);  // the lamp is off
  LampLight lamp;
  lamp.is_on = true;
  lamp.place_mm = {-8, 0, 0};
  lamp.direction = {1, 0, 0};
  lamp.cone_degrees = 20;
  haze.set_light(lamp);
  const FloatImage picture = haze.draw(camera, depths);
  const CameraRays rays(camera, 64, 64);
  const double tangent = std::tan(20 * 3.14159265358979 / 180);
  for (int y = 0; y < 64; ++y) {
    for (int x = 1; x < 63; ++x) {
      const Vec3d at = rays.at(x + 0.5, y + 0.5).origin_lps_mm;
      const float* rgba = picture.rgba.data() + 4 * (64 * y + x);
      const double inside = tangent * (at.x + 8) - std::abs(at.y);
      if (inside < -0.01) {
        EXPECT_EQ(rgba[0], 0) << x << " " << y;
      }
      if (inside > 0.5) {
        EXPECT_GT(rgba[0], 1e-4) << x << " " << y;
      }
      EXPECT_NEAR(rgba[3], picture.rgba[4 * (64 * 32 + 32) + 3], 1e-5);
    }
  }
}

TEST(PropertyDeformedHaze, BitsDoNotDependOnTheNumberOfThreads) {
  const HazeBody body = structured_ball();
  const Displacement wave = body.moved(wave_at);
  const auto drawn_with = [&](int threads) {
    const ThreadLimit limit(threads);
    DeformedHaze haze;
    haze.set_body(body.geometry, body.density);
    haze.update(Ways(wave).bricks());
    return haze.draw(oblique_camera(), depths_of(75, 50)).rgba;
  };
  EXPECT_EQ(drawn_with(1), drawn_with(2));
}

TEST(FaultDeformedHaze, UnevenSpacingAndALookWithoutExtinctionAreRefused) {
  const Geometry uneven(Vec3i(8), Vec3d(0), {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 2)});
  DeformedHaze haze;
  EXPECT_THROW(haze.set_body(uneven, DensityGrid()), InputError);
  HazeLook look;
  look.extinction_per_mm = 0;
  EXPECT_THROW(DeformedHaze(look).draw(oblique_camera(), depths_of(2, 2)), InputError);
}

}  // namespace
}  // namespace supple

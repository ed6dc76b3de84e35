#include "raycast/microscope/packet_shader.h"

#include <cmath>
#include <limits>

#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr int kMostLayers = 8;  // of translucent surfaces along a ray
/// Chords of what lies on the globe pass behind it.
constexpr float kSkinMm = 0.005f;
constexpr float kEndless = std::numeric_limits<float>::infinity();

bool has(std::uint32_t mask, int lane) {
  return (mask >> lane & 1) != 0;
}

/// A turn of the samples that differs from pixel to pixel without a pattern that the eye finds (J.
/// Jimenez, Next generation post processing in Call of Duty, 2014: interleaved gradient noise).
int turn_of_pixel(float x, float y) {
  const double a = 0.06711056 * std::floor(2 * double(x)) + 0.00583715 * std::floor(2 * double(y));
  const double b = 52.9829189 * (a - std::floor(a));
  return int((b - std::floor(b)) * LampDisc::kTurns);
}

/// Points of the lamp's disc to which sample `sample` of each ray goes: evenly spread by the golden
/// angle.
void sample_lamp(const EyeScene& scene, const LaneFloats& cosine, const LaneFloats& sine,
                 int sample, LaneVectors& points) {
  const LampDisc& disc = scene.disc;
  const Vec3f place = scene.lamp.place;
  const double angle = sample * kPi * (3 - std::sqrt(5.0));
  const double radius = std::sqrt((sample + 0.5) / disc.samples);
  const auto c = float(radius * std::cos(angle)), s = float(radius * std::sin(angle));
  for (int lane = 0; lane < kPacketRays; ++lane) {
    const float across = c * cosine[lane] - s * sine[lane];
    const float aside = c * sine[lane] + s * cosine[lane];
    points.x[lane] = place.x + disc.across.x * across + disc.aside.x * aside;
    points.y[lane] = place.y + disc.across.y * across + disc.aside.y * aside;
    points.z[lane] = place.z + disc.across.z * across + disc.aside.z * aside;
  }
}

/// Part of the lamp's light that reaches places, from the middle of its disc.
void hard_passing(const EyeScene& scene, const PacketPlaces& places, const TriangleList& list,
                  std::uint32_t listed, LaneFloats& part) {
  LaneVectors points;
  for (int lane = 0; lane < kPacketRays; ++lane) points.set(lane, scene.lamp.place);
  PacketRays rays;
  shadow_rays(places, points, listed, rays);
  scene.shapes->passing(rays, list, part);
}

/// The same from all of its disc.
void soft_passing(const EyeScene& scene, const LaneVectors& turns, const PacketPlaces& places,
                  const TriangleList& list, std::uint32_t listed, LaneFloats& part) {
  PacketRays rays;
  LaneVectors points;
  LaneFloats sum{}, one;
  for (int sample = 0; sample < scene.disc.samples; ++sample) {
    sample_lamp(scene, turns.x, turns.y, sample, points);
    shadow_rays(places, points, listed, rays);
    scene.shapes->passing(rays, list, one);
    for (int lane = 0; lane < kPacketRays; ++lane) sum[lane] += one[lane];
  }
  for (int lane = 0; lane < kPacketRays; ++lane) {
    part[lane] = sum[lane] / float(scene.disc.samples);
  }
}

/// Part of the lamp's light that reaches each place.
void lamp_passing(const EyeScene& scene, const LaneFloats& x, const LaneFloats& y,
                  const PacketPlaces& places, std::uint32_t wanted, ShaderRoom& room,
                  LaneFloats& part) {
  for (float& p : part.of) p = 1;
  const TriangleBins& casters = scene.shapes->before_lamp();
  const bool is_hard = scene.disc.samples == 1;
  if (wanted == 0 || casters.is_empty()) return;
  const PacketPixels pixels = casters.pixels_of(places.at);
  LaneVectors turns;  // cosines and sines
  for (int lane = 0; !is_hard && lane < kPacketRays; ++lane) {
    const auto& turn = scene.disc.turns[std::size_t(turn_of_pixel(x[lane], y[lane]))];
    turns.x[lane] = turn[0], turns.y[lane] = turn[1];
  }
  while (wanted != 0) {
    std::uint32_t listed = 0;
    const TriangleList list = casters.list_near(pixels, wanted, listed, room.shading);
    if (list.count == 0) continue;
    LaneFloats found;
    if (is_hard)
      hard_passing(scene, places, list, listed, found);
    else
      soft_passing(scene, turns, places, list, listed, found);
    for (int lane = 0; lane < kPacketRays; ++lane) {
      part[lane] = has(listed, lane) ? found[lane] : part[lane];
    }
  }
}

/// Puts a ball into the rays that enter it before `until`; edges are denser than the middle.
void put_ball(const BallFloats& ball, const LaneFloats& until, std::uint32_t active,
              bool is_in_front, Layers& layers, PacketPicture& picture) {
  PacketColours& sum = is_in_front ? picture.front : picture.colour;
  LaneFloats& clear = is_in_front ? layers.front_clear : layers.clear;
  for (int lane = 0; lane < kPacketRays; ++lane) {
    const Vec3f direction = layers.rays.direction[lane];
    const Vec3f apart = layers.rays.origin[lane] - ball.centre;
    const float middle = -apart.dot(direction);
    const float rest = ball.radius * ball.radius - (apart + direction * middle).length2();
    if (!(rest > 0) || !has(active, lane)) continue;
    const float entry = middle - std::sqrt(rest);
    if (!(entry > layers.reached_mm[lane]) || !(entry <= until[lane])) continue;
    const float facing = std::sqrt(rest) / ball.radius;
    const float share = clear[lane] * ball.opacity;
    const Vec3f colour = ball.colour * (share * (0.45f + 0.55f * facing));
    sum.red[lane] += colour.x, sum.green[lane] += colour.y, sum.blue[lane] += colour.z;
    clear[lane] -= share;
    if (is_in_front) picture.front_mm[lane] = std::min(picture.front_mm[lane], entry);
  }
}

void begin(const EyeScene& scene, const LaneFloats& x, const LaneFloats& y, Layers& layers,
           PacketPicture& picture) {
  aim_rays(scene.lens, *scene.globe, x, y, layers.rays);
  for (int lane = 0; lane < kPacketRays; ++lane) {
    layers.clear[lane] = layers.front_clear[lane] = 1;
    layers.reached_mm[lane] = layers.rays.near[lane];
    picture.depth_mm[lane] = picture.front_mm[lane] = kEndless;
    picture.key[lane] = 0;
  }
  layers.end_mm = layers.rays.far;
  picture.colour = picture.front = {};
}

/// Where each ray's layer lies: the shape that it meets, the globe, or nowhere.
void find_layer(const EyeScene& scene, const TriangleList& list, Layers& layers, PacketHits& hits,
                LaneFloats& distance) {
  hits.met = 0;
  distance = layers.end_mm;
  if (list.count == 0) return;
  for (float& far : layers.rays.far.of) far += kSkinMm;
  scene.shapes->first_hits(layers.rays, list, hits);
  layers.rays.far = layers.end_mm;
  if (hits.met == 0) return;
  for (int lane = 0; lane < kPacketRays; ++lane) {
    distance[lane] = has(hits.met, lane) ? hits.distance[lane] : layers.end_mm[lane];
  }
}

}  // namespace

LampDisc lamp_disc(const Vec3d& direction, double radius_mm, int samples) {
  LampDisc disc;
  disc.samples = samples;
  const Vec3d unlike = std::abs(direction.x) < 0.7 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  const Vec3d across = direction.cross(unlike).normalized();
  disc.across = Vec3f(across * radius_mm);
  disc.aside = Vec3f(direction.cross(across).normalized() * radius_mm);
  for (int n = 0; n < LampDisc::kTurns; ++n) {
    const double angle = 2 * kPi * n / LampDisc::kTurns;
    disc.turns[std::size_t(n)] = {float(std::cos(angle)), float(std::sin(angle))};
  }
  return disc;
}

void shade_packet(const EyeScene& scene, const LaneFloats& x, const LaneFloats& y,
                  const TriangleList& list, ShaderRoom& room, PacketPicture& picture) {
  using Clock = std::chrono::steady_clock;
  const auto started = room.is_timed ? Clock::now() : Clock::time_point();
  Layers layers;
  begin(scene, x, y, layers, picture);
  PacketHits hits;
  PacketPlaces places{};
  PacketLight light;
  LaneFloats distance, passing;
  for (int n = 0; n < kMostLayers && layers.rays.active != 0; ++n) {
    find_layer(scene, list, layers, hits, distance);
    for (const BallFloats& ball : scene.balls) {
      put_ball(ball, distance, layers.rays.active, n == 0, layers, picture);
    }
    if (scene.globe->radius <= 0)
      layers.rays.active &= hits.met;
    else
      globe_places(*scene.globe, layers.rays, places);
    if (layers.rays.active == 0) break;
    for (int lane = 0; n == 0 && lane < kPacketRays; ++lane) {
      if (has(layers.rays.active, lane)) picture.depth_mm[lane] = distance[lane];
    }
    put_hits(scene.shapes->normals(), scene.surfaces->data(), hits, layers.rays, places);
    lamp_light(scene.lamp, places, light);
    const std::uint32_t wanted = layers.rays.active & light.reached;
    const auto shadow_started = room.is_timed ? Clock::now() : started;
    lamp_passing(scene, x, y, places, wanted, room, passing);
    if (room.is_timed) room.shadow_ms += ms_since(shadow_started);
    add_layer(light, passing, hits, distance, scene.disc.samples == 1 ? 4.0f : 0.0f, layers,
              picture);
  }
  for (int lane = 0; lane < kPacketRays; ++lane) {
    picture.front_opacity[lane] = 1 - layers.front_clear[lane];
  }
  if (room.is_timed) room.whole_ms += ms_since(started);
}

}  // namespace supple

#include "raycast/microscope/packet_shader.h"

#include <cmath>
#include <limits>

#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr int kMostLayers = 8;         // of translucent surfaces along a ray
constexpr float kNextLayerMm = 2e-3f;  // behind a surface the ray goes on
constexpr float kRetinaLiftMm = 0.004f;
/// Chords of what lies on the globe pass behind it.
constexpr float kSkinMm = 0.005f;
constexpr float kEndless = std::numeric_limits<float>::infinity();

bool has(std::uint32_t mask, int lane) {
  return (mask >> lane & 1) != 0;
}

/// What packets carry from layer to layer.
struct Layers {
  PacketRays rays;
  LaneFloats end_mm;  // of rays on the globe
  LaneFloats clear;   // part that is still seen of what comes
  LaneFloats front_clear;
  LaneFloats reached_mm;  // of balls that have been put in
};

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

/// Part of the lamp's light that reaches each place.
void lamp_passing(const EyeScene& scene, const LaneFloats& x, const LaneFloats& y,
                  const PacketPlaces& places, std::uint32_t wanted, LaneFloats& part) {
  for (float& p : part.of) p = 1;
  const LampDisc& disc = scene.disc;
  if (wanted == 0 || disc.samples == 0) return;
  const float reach = disc.samples == 1 ? 0 : disc.across.length();
  if (!scene.shapes->may_shade(places, wanted, scene.lamp.place, reach)) return;
  PacketRays rays;
  LaneVectors points;
  if (disc.samples == 1) {
    for (int lane = 0; lane < kPacketRays; ++lane) points.set(lane, scene.lamp.place);
    shadow_rays(places, points, wanted, rays);
    scene.shapes->passing(rays, part);
    return;
  }
  LaneFloats sum{}, one, cosine, sine;
  for (int lane = 0; lane < kPacketRays; ++lane) {
    const auto& turn = disc.turns[std::size_t(turn_of_pixel(x[lane], y[lane]))];
    cosine[lane] = turn[0], sine[lane] = turn[1];
  }
  for (int sample = 0; sample < disc.samples; ++sample) {
    sample_lamp(scene, cosine, sine, sample, points);
    shadow_rays(places, points, wanted, rays);
    scene.shapes->passing(rays, one);
    for (int lane = 0; lane < kPacketRays; ++lane) sum[lane] += one[lane];
  }
  for (int lane = 0; lane < kPacketRays; ++lane) part[lane] = sum[lane] / float(disc.samples);
}

/// Replaces places on the globe by those of shapes before it.
void put_hits(const EyeScene& scene, const PacketHits& hits, const PacketRays& rays,
              PacketPlaces& places) {
  for (float& lift : places.lift_mm.of) lift = kRetinaLiftMm;
  if (hits.met == 0) return;
  for (int lane = 0; lane < kPacketRays; ++lane) {
    if (!has(hits.met, lane)) continue;
    const SurfaceFloats& surface = (*scene.surfaces)[std::size_t(hits.shape[lane])];
    const Vec3f direction = rays.direction[lane];
    const Vec3f normal = scene.shapes->normal(hits, lane);
    places.at.set(lane, rays.origin[lane] + direction * hits.distance[lane]);
    places.normal.set(lane, normal.dot(direction) > 0 ? -normal : normal);
    places.from_eye.set(lane, direction);
    places.red[lane] = surface.colour.x;
    places.green[lane] = surface.colour.y;
    places.blue[lane] = surface.colour.z;
    places.opacity[lane] = surface.opacity;
    places.specular[lane] = surface.specular;
    places.shininess[lane] = surface.shininess;
    places.lift_mm[lane] = surface.lift_mm;
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

/// Adds a lit layer behind those before it, and goes on where something of the next is seen.
void add_layer(const PacketLight& light, const LaneFloats& passing, const PacketHits& hits,
               const LaneFloats& distance, bool is_hard, Layers& layers, PacketPicture& picture) {
  // Without branches, so that loops become vectors.
  const std::uint32_t active = layers.rays.active;
  const auto add = [&](LaneFloats& sum, const LaneFloats& lit, const LaneFloats& ambient) {
    for (int lane = 0; lane < kPacketRays; ++lane) {
      const float seen = layers.clear[lane] * (lit[lane] * passing[lane] + ambient[lane]);
      sum[lane] += has(active, lane) ? seen : 0.0f;
    }
  };
  add(picture.colour.red, light.lit.red, light.ambient.red);
  add(picture.colour.green, light.lit.green, light.ambient.green);
  add(picture.colour.blue, light.lit.blue, light.ambient.blue);
  const float levels = is_hard ? 4 : 0;
  std::uint32_t open = 0;
  for (int lane = 0; lane < kPacketRays; ++lane) {
    const bool is_active = has(active, lane), is_hit = has(hits.met, lane);
    const float clear = layers.clear[lane] * (1 - light.opacity[lane]);
    layers.clear[lane] = is_active ? clear : layers.clear[lane];
    layers.reached_mm[lane] = is_active ? distance[lane] : layers.reached_mm[lane];
    layers.rays.near[lane] = distance[lane] + kNextLayerMm;
    const auto shape = std::uint32_t(is_hit ? hits.shape[lane] + 2 : 1);
    const auto level = std::uint32_t(int(passing[lane] * levels + 0.5f));
    const std::uint32_t key = (picture.key[lane] * 257 + shape) * 8 + level;
    picture.key[lane] = is_active ? key : picture.key[lane];
    open |= std::uint32_t(is_active & is_hit & (clear > 0.004f)) << lane;
  }
  layers.rays.active = open;
}

/// Where each ray's layer lies: the shape that it meets, the globe, or nowhere.
void find_layer(const EyeScene& scene, bool meets_shapes, Layers& layers, PacketHits& hits,
                LaneFloats& distance) {
  hits.met = 0;
  distance = layers.end_mm;
  if (!meets_shapes) return;
  for (float& far : layers.rays.far.of) far += kSkinMm;
  scene.shapes->first_hits(layers.rays, hits);
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
                  bool meets_shapes, PacketPicture& picture, ShadowClock* clock) {
  const auto started =
      clock != nullptr ? std::chrono::steady_clock::now() : std::chrono::steady_clock::time_point();
  Layers layers;
  begin(scene, x, y, layers, picture);
  PacketHits hits;
  PacketPlaces places{};
  PacketLight light;
  LaneFloats distance, passing;
  for (int n = 0; n < kMostLayers && layers.rays.active != 0; ++n) {
    find_layer(scene, meets_shapes, layers, hits, distance);
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
    put_hits(scene, hits, layers.rays, places);
    lamp_light(scene.lamp, places, light);
    const std::uint32_t wanted = layers.rays.active & light.reached;
    const auto shadow_started = clock != nullptr ? std::chrono::steady_clock::now() : started;
    lamp_passing(scene, x, y, places, wanted, passing);
    if (clock != nullptr) clock->shadow_ms += ms_since(shadow_started);
    add_layer(light, passing, hits, distance, scene.disc.samples == 1, layers, picture);
  }
  for (int lane = 0; lane < kPacketRays; ++lane) {
    picture.front_opacity[lane] = 1 - layers.front_clear[lane];
  }
  if (clock != nullptr) clock->whole_ms += ms_since(started);
}

}  // namespace supple

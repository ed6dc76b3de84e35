#include "raycast/microscope/microscope.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "raycast/microscope/haze_depths.h"
#include "raycast/microscope/packet_shader.h"
#include "raycast/microscope/picture_planes.h"
#include "raycast/microscope/shape_scene.h"
#include "raycast/microscope/tone_lanes.h"
#include "raycast/scene/stereo.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/text.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr double kRigidCreaseDegrees = 40, kSoftCreaseDegrees = 180;
constexpr float kRigidLiftMm = 0.004f, kSoftLiftMm = 0.02f;
/// Light begins before the tip, which would shade itself.
constexpr double kBeforeTipMm = 0.03;
constexpr int kMostPixels = 16384, kMostSamples = 64, kMostPart = 64;

Vec3f linear_of(const std::array<double, 3>& rgb) {
  return {linear_from_srgb(float(rgb[0])), linear_from_srgb(float(rgb[1])),
          linear_from_srgb(float(rgb[2]))};
}

SurfaceFloats surface_of(const SurfaceLook& look, float lift_mm) {
  return {linear_of(look.rgb), float(look.opacity), float(look.specular), float(look.shininess),
          lift_mm};
}

std::vector<std::uint32_t> packed_texels(const TextureImage& image) {
  std::array<std::uint32_t, 256> roots{};
  for (std::size_t n = 0; n < roots.size(); ++n) {
    roots[n] = std::uint32_t(std::lround(1023 * std::sqrt(linear_from_srgb(float(n) / 255))));
  }
  std::vector<std::uint32_t> packed;
  packed.reserve(image.texels.size());
  for (const auto& texel : image.texels) {
    packed.push_back(roots[texel[0]] | roots[texel[1]] << 10 | roots[texel[2]] << 20);
  }
  return packed;
}

LampFloats lamp_of(const LampLight& light, double ambient) {
  LampFloats lamp;
  lamp.ambient = float(ambient);
  lamp.is_on = light.is_on && light.power > 0;
  if (!lamp.is_on) return lamp;
  const Vec3d direction = light.direction.normalized();
  lamp.direction = Vec3f(direction);
  lamp.place = Vec3f(light.place_mm + direction * kBeforeTipMm);
  const double full = std::max(light.cone_degrees - light.edge_degrees, 0.0);
  lamp.cosine_full = float(std::cos(full * kRadiansPerDegree));
  lamp.cosine_none = float(std::cos(light.cone_degrees * kRadiansPerDegree));
  lamp.power = float(light.power);
  return lamp;
}

void require_between(const char* field, double value, double least, double most) {
  if (value >= least && value <= most) return;
  throw InputError({"", std::string("microscope ") + field, number_text(value),
                    number_text(least) + " to " + number_text(most)});
}

void validate(const Camera& camera, const MicroscopeSettings& settings) {
  camera.validate("");
  if (camera.projection == Projection::orthographic) {
    throw InputError({"", "microscope", "an orthographic camera", "a perspective one"});
  }
  require_between("width", settings.width, 1, kMostPixels);
  require_between("height", settings.height, 1, kMostPixels);
  require_between("ambient", settings.ambient, 0, 1000);
  require_between("shadow samples", settings.shadow_samples, 0, kMostSamples);
  require_between("lamp radius", settings.lamp_radius_mm, 0, 1000);
  require_between("haze part", settings.haze_part, 0, kMostPart);
}

void set_size(int width, int height, Image& image) {
  image.width = width, image.height = height;
  image.has_alpha = false;
  image.rgba.resize(4 * std::size_t(width) * height);
}

}  // namespace

struct Microscope::Impl {
  ShapeScene shapes;
  std::vector<SurfaceFloats> surfaces;
  GlobeFloats globe;
  LampLight lamp;
  std::vector<BallFloats> balls;
  PicturePlanes planes;
  HazeGrids haze;

  int add(const SurfaceLook& look, float lift_mm) {
    surfaces.push_back(surface_of(look, lift_mm));
    return shapes.add({look.casts_shadow, look.dims});
  }
  EyeScene scene_of(const Camera& camera, const MicroscopeSettings& settings) const;
  float globe_distance(const Camera& camera) const;
  void prepare(const MicroscopeSettings& settings, MicroscopeTimes* times);
  void draw(const Camera& camera, const MicroscopeSettings& settings, HazeLayer* layer,
            MicroscopeTimes* times, int left, Image& image);
};

EyeScene Microscope::Impl::scene_of(const Camera& camera,
                                    const MicroscopeSettings& settings) const {
  EyeScene scene;
  scene.lens = lens_of(camera, settings.width, settings.height);
  scene.globe = &globe;
  scene.shapes = &shapes;
  scene.surfaces = &surfaces;
  scene.lamp = lamp_of(lamp, settings.ambient);
  scene.disc =
      lamp_disc(Vec3d(scene.lamp.direction), settings.lamp_radius_mm, settings.shadow_samples);
  scene.balls = balls;
  const Vec3f eye = scene.lens.origin;
  const auto nearer = [&](const BallFloats& a, const BallFloats& b) {
    return (a.centre - eye).length() - a.radius < (b.centre - eye).length() - b.radius;
  };
  std::stable_sort(scene.balls.begin(), scene.balls.end(), nearer);
  return scene;
}

/// Distance to the nearest place of the globe, at which haze may begin.
float Microscope::Impl::globe_distance(const Camera& camera) const {
  if (globe.radius <= 0) return 0;
  const float distance = (Vec3f(camera.position_lps_mm) - globe.centre).length();
  return std::max(distance - globe.radius, 0.0f);
}

/// Whatever all eyes of a picture share.
void Microscope::Impl::prepare(const MicroscopeSettings& settings, MicroscopeTimes* times) {
  const Stopwatch build;
  shapes.commit();
  LampFloats light = lamp_of(lamp, settings.ambient);
  light.is_on &= settings.shadow_samples > 0;
  const double radius_mm = settings.shadow_samples == 1 ? 0 : settings.lamp_radius_mm;
  shapes.light_from(light, {float(radius_mm), globe.centre, globe.radius});
  if (times != nullptr) *times = {build.ms()};
}

/// Draws into a part of an image, from a column on.
void Microscope::Impl::draw(const Camera& camera, const MicroscopeSettings& settings,
                            HazeLayer* layer, MicroscopeTimes* times, int left, Image& image) {
  const bool has_haze = layer != nullptr && settings.haze_part > 0;
  const EyeScene scene = scene_of(camera, settings);
  planes.resize(settings.width, settings.height, has_haze && !balls.empty());
  PassTimes passes;
  draw_pixels(scene, planes, times != nullptr ? &passes : nullptr);
  const Stopwatch edges;
  if (settings.smooth_edges) smooth_edges(scene, planes);
  const double edges_ms = edges.ms();
  const Stopwatch haze_watch;
  haze.to_surface.width = 0;
  haze.start_mm = globe_distance(camera);
  if (has_haze) draw_haze(*layer, camera, planes, settings.haze_part, haze);
  const double haze_ms = haze_watch.ms();
  const Stopwatch tone;
  parallel_for(settings.height, Grain{8}, [&](int y) {
    tone_row(planes, haze, settings.eyepiece, y,
             &image.rgba[4 * (std::size_t(y) * image.width + left)]);
  });
  if (times != nullptr) {
    times->rays_ms += passes.rays_ms;
    times->shadow_ms += passes.shadow_ms;
    times->edges_ms += edges_ms;
    times->haze_ms += haze_ms;
    times->tone_ms += tone.ms();
  }
}

Microscope::Microscope() : m_impl(std::make_unique<Impl>()) {}
Microscope::~Microscope() = default;

void Microscope::set_globe(const GlobeLook& look) {
  const std::size_t count = std::size_t(look.fundus.width) * look.fundus.height;
  if (look.fundus.texels.size() != count) {
    throw InputError({"", "texels of a fundus", std::to_string(look.fundus.texels.size()),
                      std::to_string(count)});
  }
  GlobeFloats& globe = m_impl->globe;
  globe.centre = Vec3f(look.centre_mm);
  globe.radius = float(look.radius_mm);
  globe.width = look.fundus.width;
  globe.height = look.fundus.height;
  globe.texels = packed_texels(look.fundus);
}

void Microscope::set_spots(const std::vector<BloodSpot>& spots) {
  m_impl->globe.spots.clear();
  for (const BloodSpot& spot : spots) {
    if (!(spot.radius_mm > 0)) continue;
    m_impl->globe.spots.push_back({Vec3f(spot.direction.normalized()), float(spot.radius_mm)});
  }
}

int Microscope::add_rigid(const TriangleMesh& mesh, const SurfaceLook& look) {
  const int number = m_impl->add(look, kRigidLiftMm);
  m_impl->shapes.shape(number, mesh.vertices_lps_mm, mesh.triangles, kRigidCreaseDegrees);
  return number;
}

void Microscope::place(int rigid, const RigidPlacement& placement) {
  m_impl->shapes.place(rigid, {Vec3f(placement.x), Vec3f(placement.y), Vec3f(placement.z),
                               Vec3f(placement.origin_mm)});
}

int Microscope::add_soft(const SurfaceLook& look) {
  return m_impl->add(look, kSoftLiftMm);
}

void Microscope::reshape(int soft, const std::vector<Vec3d>& vertices_mm,
                         const std::vector<std::array<int, 3>>& triangles) {
  m_impl->shapes.shape(soft, vertices_mm, triangles, kSoftCreaseDegrees);
}

void Microscope::set_lamp(const LampLight& lamp) {
  m_impl->lamp = lamp;
}

void Microscope::set_balls(const std::vector<TaskBall>& balls) {
  m_impl->balls.clear();
  for (const TaskBall& ball : balls) {
    m_impl->balls.push_back(
        {Vec3f(ball.centre_mm), float(ball.radius_mm), linear_of(ball.rgb), float(ball.opacity)});
  }
}

void Microscope::draw(const Camera& camera, const MicroscopeSettings& settings, Image& image,
                      HazeLayer* haze, MicroscopeTimes* times) {
  validate(camera, settings);
  m_impl->prepare(settings, times);
  set_size(settings.width, settings.height, image);
  m_impl->draw(camera, settings, haze, times, 0, image);
}

void Microscope::draw_pair(const Camera& camera, double eye_separation_mm,
                           const MicroscopeSettings& settings, Image& both, HazeLayer* haze,
                           MicroscopeTimes* times) {
  validate(camera, settings);
  m_impl->prepare(settings, times);
  const StereoCameras eyes = stereo_cameras(camera, eye_separation_mm);
  set_size(2 * settings.width, settings.height, both);
  m_impl->draw(eyes.left, settings, haze, times, 0, both);
  m_impl->draw(eyes.right, settings, haze, times, settings.width, both);
}

}  // namespace supple

// Scenes under the microscope, of which places and light are known.
#pragma once

#include <cmath>
#include <vector>

#include "raycast/microscope/microscope.h"
#include "raycast/pictures/image.h"
#include "volumes/base/units.h"

namespace supple {

/// A camera above the eye, which looks along -z.
inline Camera eye_camera(double fov_degrees = 3.2) {
  Camera camera;
  camera.position_lps_mm = {0, 0, 200};
  camera.target_lps_mm = {0, 0, -9};
  camera.up_lps = {0, 1, 0};
  camera.vertical_fov_degrees = fov_degrees;
  return camera;
}

inline MicroscopeSettings small_picture(int width = 160, int height = 120) {
  MicroscopeSettings settings;
  settings.width = width;
  settings.height = height;
  return settings;
}

inline GlobeLook grey_globe() {
  GlobeLook globe;
  globe.fundus.width = globe.fundus.height = 1;
  globe.fundus.texels = {{188, 188, 188}};
  return globe;
}
/// Albedo of grey_globe().
inline double grey_albedo() {
  return linear_from_srgb(188 / 255.0f);
}

/// Light of a channel of a pixel, linear, before it was toned.
inline double light_at(const Image& image, int x, int y, int channel = 0) {
  const auto at = 4 * (std::size_t(y) * image.width + x) + channel;
  return -std::log(std::max(1 - double(linear_from_srgb(float(image.rgba[at]) / 255)), 1e-9));
}

inline double byte_from_light(double light) {
  return 255 * double(srgb_from_linear(float(1 - std::exp(-light))));
}

/// Distance from the ray's origin to the far side of a sphere.
inline double far_side(const Ray& ray, const Vec3d& centre, double radius) {
  const Vec3d apart = ray.origin_lps_mm - centre;
  const double middle = -apart.dot(ray.direction_lps);
  return middle + std::sqrt(middle * middle - apart.length2() + radius * radius);
}

/// A ball of triangles.
inline TriangleMesh ball_mesh(double radius, int steps = 48) {
  TriangleMesh mesh;
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i < 2 * steps; ++i) {
      const double theta = kPi * j / steps, phi = kPi * i / steps;
      mesh.vertices_lps_mm.push_back(
          Vec3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)) *
          radius);
    }
  }
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < 2 * steps; ++i) {
      const int a = j * 2 * steps + i, b = j * 2 * steps + (i + 1) % (2 * steps);
      mesh.triangles.push_back({a, a + 2 * steps, b});
      mesh.triangles.push_back({b, a + 2 * steps, b + 2 * steps});
    }
  }
  return mesh;
}

/// A needle from its flat tip at 0 along +z.
inline TriangleMesh needle_mesh(double length, double tip_radius, double radius) {
  constexpr int kSides = 32;
  TriangleMesh mesh;
  mesh.vertices_lps_mm.push_back({0, 0, 0});
  for (int i = 0; i < kSides; ++i) {
    const double phi = 2 * kPi * i / kSides;
    const Vec3d out(std::cos(phi), std::sin(phi), 0);
    mesh.vertices_lps_mm.push_back(out * tip_radius);
    mesh.vertices_lps_mm.push_back(out * radius + Vec3d(0, 0, length));
    const int a = 1 + 2 * i, b = 1 + 2 * ((i + 1) % kSides);
    mesh.triangles.push_back({0, b, a});
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
  }
  return mesh;
}

/// A sheet across the view at a height.
struct SoftSheet {
  std::vector<Vec3d> vertices;
  std::vector<std::array<int, 3>> triangles;
};
inline SoftSheet flat_sheet(double half_width, double z, int count = 9) {
  SoftSheet sheet;
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      sheet.vertices.push_back(
          {half_width * (2.0 * i / (count - 1) - 1), half_width * (2.0 * j / (count - 1) - 1), z});
    }
  }
  for (int j = 0; j + 1 < count; ++j) {
    for (int i = 0; i + 1 < count; ++i) {
      const int a = j * count + i;
      sheet.triangles.push_back({a, a + 1, a + count});
      sheet.triangles.push_back({a + 1, a + count + 1, a + count});
    }
  }
  return sheet;
}

inline LampLight aside_lamp() {
  LampLight lamp;
  lamp.is_on = true;
  lamp.place_mm = {-4, 1, -3};
  lamp.direction = (Vec3d(0, 0, -11) - lamp.place_mm).normalized();
  lamp.cone_degrees = 60;
  return lamp;
}

inline Image picture_by(Microscope& microscope, const Camera& camera,
                        const MicroscopeSettings& settings, HazeLayer* haze = nullptr) {
  Image image;
  microscope.draw(camera, settings, image, haze);
  return image;
}

struct EyePair {
  Image left, right;
};
inline EyePair pair_by(Microscope& microscope, const Camera& camera, double eye_separation_mm,
                       const MicroscopeSettings& settings, HazeLayer* haze = nullptr) {
  Image both;
  microscope.draw_pair(camera, eye_separation_mm, settings, both, haze);
  EyePair pair{{settings.width, settings.height}, {settings.width, settings.height}};
  const std::size_t bytes = 4 * std::size_t(settings.width);
  for (std::size_t y = 0; y < std::size_t(settings.height); ++y) {
    std::copy_n(&both.rgba[2 * y * bytes], bytes, &pair.left.rgba[y * bytes]);
    std::copy_n(&both.rgba[(2 * y + 1) * bytes], bytes, &pair.right.rgba[y * bytes]);
  }
  return pair;
}

}  // namespace supple

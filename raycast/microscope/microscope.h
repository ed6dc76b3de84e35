// Pictures as under an operating microscope: a globe from inside, instruments, membranes and a spot
// light at an instrument's tip with hard or soft shadows, in mono or as a stereo pair (thesis
// section 6.1.2, figures 6.8 and 6.10). For scenes that change all the time: packets of rays
// through Embree, what is rigid is an instance, what deforms is rebuilt for every picture.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "raycast/pictures/image.h"
#include "raycast/scene/camera.h"
#include "volumes/base/vec.h"
#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

/// Columns of a rigid motion: the local axes and the origin in the world.
struct RigidPlacement {
  Vec3d origin_mm{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
};

/// sRGB texels, row 0 first. On a globe they are an azimuthal equidistant map about its -z axis:
/// the middle is the posterior pole, the inscribed circle the anterior one; columns go along x and
/// rows against y, as who looks along -z sees it.
struct TextureImage {
  int width = 0, height = 0;
  std::vector<std::array<std::uint8_t, 3>> texels;
};

struct SurfaceLook {
  std::array<double, 3> rgb{0.75, 0.75, 0.78};  // sRGB, as of balls
  double opacity = 1;        // seen along the normal: a thin sheet that is seen aslant hides more
  double specular = 0.3;     // part of light that is mirrored
  double shininess = 40;     // exponent of the lobe
  bool casts_shadow = true;  // blocks light
  double dims = 1;           // part of light that passes where it does not block
};

struct GlobeLook {
  Vec3d centre_mm{0, 0, 0};
  double radius_mm = 11;
  TextureImage fundus;
};

/// Light at the tip of a lamp. It falls off with the square of the distance.
struct LampLight {
  bool is_on = false;
  Vec3d place_mm{0, 0, 0}, direction{0, 0, -1};
  double cone_degrees = 35;  // half of the cone, to where no light goes
  double edge_degrees = 8;   // of these, over which it fades
  double power = 1;          // at 8 mm a white surface that faces it is fully lit
};

/// A translucent ball that a task shows, as bright without light.
struct TaskBall {
  Vec3d centre_mm;
  double radius_mm;
  std::array<double, 3> rgb{1, 1, 0};
  double opacity = 0.4;
};

/// Spot of blood on the globe.
struct BloodSpot {
  Vec3d direction;  // unit, from the globe's centre
  double radius_mm;
};

struct MicroscopeSettings {
  int width = 800, height = 600;
  double ambient = 0.03;
  int shadow_samples = 1;        // 0: none; more: soft
  double lamp_radius_mm = 0.15;  // of soft shadows
  bool smooth_edges = true;
  int haze_part = 4;      // of the width at which a volume is marched; 0: none
  bool eyepiece = false;  // dark outside of a circle
};

/// Where rays of a picture end: distance along each ray in mm, endless where nothing is met. A
/// translucent surface ends them, too: haze behind it is left out.
struct RayDepths {
  int width = 0, height = 0;
  std::vector<float> mm;
};

/// Something translucent that is drawn before the surfaces.
class HazeLayer {
 public:
  virtual ~HazeLayer() = default;
  /// Colour (premultiplied, linear) and opacity of each pixel of a small picture of the camera, up
  /// to the depths of its pixels and of their size. Called twice for an eye that sees balls.
  virtual FloatImage draw(const Camera& camera, const RayDepths& depths) = 0;
};

/// Wall time of the parts of a picture, or of both of a pair.
struct MicroscopeTimes {
  double build_ms = 0, rays_ms = 0, shadow_ms = 0, edges_ms = 0, haze_ms = 0, tone_ms = 0;
};

class Microscope {
 public:
  Microscope();
  ~Microscope();

  void set_globe(const GlobeLook& globe);
  void set_spots(const std::vector<BloodSpot>& spots);
  /// Adds a rigid mesh; returns its number for place().
  int add_rigid(const TriangleMesh& mesh, const SurfaceLook& look);
  void place(int rigid, const RigidPlacement& placement);
  /// Adds a mesh that deforms; returns its number for reshape().
  int add_soft(const SurfaceLook& look);
  /// Takes its shape; normals are found anew.
  void reshape(int soft, const std::vector<Vec3d>& vertices_mm,
               const std::vector<std::array<int, 3>>& triangles);
  void set_lamp(const LampLight& lamp);
  void set_balls(const std::vector<TaskBall>& balls);

  /// Draws into an image of any size before, whose memory is used again; same bits for any number
  /// of threads. `haze`: null for none. With a globe only what lies within it is seen. Throws
  /// InputError: an orthographic or bad camera, settings out of their range.
  void draw(const Camera& camera, const MicroscopeSettings& settings, Image& image,
            HazeLayer* haze = nullptr, MicroscopeTimes* times = nullptr);
  /// Two pictures of settings.width each beside each other, the left eye's first, which share a
  /// window in the plane of the camera's target.
  void draw_pair(const Camera& camera, double eye_separation_mm, const MicroscopeSettings& settings,
                 Image& both, HazeLayer* haze = nullptr, MicroscopeTimes* times = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// Fundus with optic disc, macula and branching vessels; the same for the same seed.
TextureImage make_fundus(int size, std::uint64_t seed);

}  // namespace supple

#include "tools/scene/operation/operation_picture.h"

#include <algorithm>
#include <cmath>

#include "raycast/scene/stereo.h"
#include "volumes/base/units.h"

namespace supple::tools {

namespace {

constexpr int kFundusTexels = 2048;
constexpr double kIrisPart = 0.72;  // z of its plane, of the globe's radius

/// Place of a surface of revolution.
struct ProfilePoint {
  double radius_mm, z_mm;
};

RigidPlacement placement_of(const ToolFrame& frame) {
  return {frame.tip_mm, frame.x, frame.y, frame.z};
}

/// The iris as a ring, and from its rim on the wall of the globe, so that nothing but the pupil
/// lets look into the eye.
TriangleMesh iris_mesh(const EyeSetup& eye) {
  constexpr int kSides = 96;
  const double wall_mm = 0.999 * eye.radius_mm;
  std::vector<ProfilePoint> profile{{eye.pupil_mm, kIrisPart * wall_mm}};
  for (const double part : {kIrisPart, 0.55, 0.35, 0.15, 0.0}) {
    profile.push_back({wall_mm * std::sqrt(1 - part * part), part * wall_mm});
  }
  const int rings = int(profile.size());
  TriangleMesh mesh;
  for (int n = 0; n < kSides; ++n) {
    const double angle = 2 * kPi * n / kSides;
    for (const ProfilePoint& at : profile) {
      mesh.vertices_lps_mm.emplace_back(at.radius_mm * std::cos(angle),
                                        at.radius_mm * std::sin(angle), at.z_mm);
    }
    for (int ring = 0; ring + 1 < rings; ++ring) {
      const int a = rings * n + ring, b = rings * ((n + 1) % kSides) + ring;
      mesh.triangles.push_back({a, a + 1, b});
      mesh.triangles.push_back({b, a + 1, b + 1});
    }
  }
  return mesh;
}

}  // namespace

Image half_of(const Image& both, bool is_right) {
  Image half(both.width / 2, both.height);
  half.has_alpha = false;
  const std::ptrdiff_t bytes = 4 * std::ptrdiff_t(half.width);
  for (int y = 0; y < half.height; ++y) {
    const auto from = both.rgba.begin() + (2 * y + int(is_right)) * bytes;
    std::copy(from, from + bytes, half.rgba.begin() + y * bytes);
  }
  return half;
}

/// The vitreous as pictures sample it, and the last of its steps that they have followed.
struct OperationPicture::Haze {
  DeformedHaze layer;
  std::int64_t step = 0;

  explicit Haze(const Vitreous& vitreous) {
    layer.set_body(vitreous.geometry(), vitreous.density());
  }
};

OperationPicture::OperationPicture(const OperationScene& scene, const Operation& operation)
    : m_scene(scene) {
  if (const auto& eye = operation.setup().eye) {
    m_microscope.set_globe(
        {{0, 0, 0}, eye->radius_mm, make_fundus(kFundusTexels, std::uint64_t(eye->fundus_seed))});
    add_iris(*eye);
  }
  add_instruments(operation);
  for (std::size_t n = 0; n < operation.membranes().size(); ++n) {
    const MembraneLook& look = scene.membranes[n];
    SurfaceLook surface;
    surface.rgb = look.rgb;
    surface.opacity = look.opacity;
    surface.specular = 0.5;
    surface.shininess = 60;
    surface.casts_shadow = false;
    surface.dims = 1 - 0.5 * look.opacity;
    m_soft.push_back({m_microscope.add_soft(surface)});
  }
  if (const Vitreous* vitreous = operation.vitreous()) m_haze = std::make_unique<Haze>(*vitreous);
  follow(operation, {});
}

OperationPicture::~OperationPicture() = default;

void OperationPicture::add_iris(const EyeSetup& eye) {
  SurfaceLook look;
  look.rgb = {0.22, 0.13, 0.07};
  look.specular = 0;
  look.casts_shadow = false;
  m_microscope.place(m_microscope.add_rigid(iris_mesh(eye), look), {});
}

void OperationPicture::add_instruments(const Operation& operation) {
  for (std::size_t n = 0; n < operation.instruments().size(); ++n) {
    const Instrument& instrument = operation.instruments()[n];
    SurfaceLook look;
    look.rgb = m_scene.tracks[n].rgb;
    look.specular = 0.6;
    look.casts_shadow = !instrument.lamp;
    for (const InstrumentMesh& part : meshes_of(instrument)) {
      m_placed.push_back({int(n), part.jaw, m_microscope.add_rigid(part.mesh, look)});
    }
  }
}

LampLight OperationPicture::lamp_of(const Operation& operation) const {
  LampLight light;
  for (std::size_t n = 0; n < operation.instruments().size(); ++n) {
    const Instrument& instrument = operation.instruments()[n];
    const InstrumentPose& pose = operation.sample().instruments[n].pose;
    if (!instrument.lamp || pose.active <= 0) continue;
    light.is_on = true;
    light.place_mm = pose.tip_mm;
    light.direction = -pose.axis;
    light.cone_degrees = instrument.lamp->cone_degrees;
    light.power = pose.active;
  }
  return light;
}

void OperationPicture::follow_membranes(const Operation& operation) {
  for (std::size_t n = 0; n < m_soft.size(); ++n) {
    const Membrane& membrane = operation.membranes()[n];
    const MeshBody& body = membrane.body();
    Soft& soft = m_soft[n];
    if (soft.topology_version == membrane.topology_version() && soft.pos_mm == body.pos_mm)
      continue;
    soft.topology_version = membrane.topology_version();
    soft.pos_mm = body.pos_mm;
    m_microscope.reshape(soft.shape, body.pos_mm, body.triangles);
  }
}

void OperationPicture::follow_vitreous(const Vitreous& vitreous) {
  const Body& body = vitreous.body();
  std::vector<HazeElements> bricks;
  for (const std::size_t b : vitreous.changed_since(m_haze->step)) {
    bricks.push_back(
        {body.elements.origin(b),
         vitreous.left(b),
         {body.q[0].brick_or_zero(b), body.q[1].brick_or_zero(b), body.q[2].brick_or_zero(b)}});
  }
  m_haze->step = vitreous.steps();
  m_haze->layer.update(bricks);
}

void OperationPicture::follow(const Operation& operation, const std::vector<TaskBall>& balls) {
  m_turn = operation.turn();
  for (const Placed& placed : m_placed) {
    const std::size_t n = std::size_t(placed.tool);
    m_microscope.place(placed.rigid,
                       placement_of(jaw_frame(operation.instruments()[n],
                                              operation.sample().instruments[n].pose, placed.jaw)));
  }
  std::vector<BloodSpot> spots;
  for (const Bleeding& spot : operation.bleedings()) {
    spots.push_back({spot.place_mm.normalized(), spot.radius_mm});
  }
  m_microscope.set_spots(spots);
  m_microscope.set_balls(balls);
  const LampLight lamp = lamp_of(operation);
  m_microscope.set_lamp(lamp);
  follow_membranes(operation);
  if (!m_haze) return;
  m_haze->layer.set_light(lamp);
  follow_vitreous(*operation.vitreous());
}

HazeLayer* OperationPicture::layer() {
  return m_haze ? &m_haze->layer : nullptr;
}

Camera OperationPicture::camera_of(const MicroscopeView& view, double time_s) const {
  Camera camera = view.camera_at(time_s);
  camera.position_lps_mm = m_turn.to_eye(camera.position_lps_mm);
  camera.target_lps_mm = m_turn.to_eye(camera.target_lps_mm);
  camera.up_lps = m_turn.to_eye(camera.up_lps);
  return camera;
}

const Image& OperationPicture::draw(const MicroscopeView& view, double time_s,
                                    MicroscopeTimes* times) {
  const Camera camera = camera_of(view, time_s);
  if (view.stereo == StereoKind::none) {
    m_microscope.draw(camera, view.settings(), m_image, layer(), times);
    return m_image;
  }
  m_microscope.draw_pair(camera, view.eye_separation_mm, view.settings(), m_image, layer(), times);
  if (view.stereo == StereoKind::anaglyph) {
    m_image =
        to_image(anaglyph(to_float(half_of(m_image, false)), to_float(half_of(m_image, true))));
  }
  return m_image;
}

}  // namespace supple::tools

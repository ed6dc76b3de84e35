#include "raycast/scene/camera.h"

#include <algorithm>
#include <cmath>

#include "raycast/scene/framing.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

struct NamedView {
  const char* name;
  Vec3d from;  // towards the camera
  Vec3d up;
};
const std::vector<NamedView>& views() {
  static const std::vector<NamedView> table = {
      {"anterior", {0, -1, 0}, {0, 0, 1}}, {"posterior", {0, 1, 0}, {0, 0, 1}},
      {"left", {1, 0, 0}, {0, 0, 1}},      {"right", {-1, 0, 0}, {0, 0, 1}},
      {"superior", {0, 0, 1}, {0, -1, 0}}, {"inferior", {0, 0, -1}, {0, -1, 0}}};
  return table;
}

const NamedView& find_view(const std::string& name) {
  std::string known;
  for (const NamedView& view : views()) {
    if (name == view.name) return view;
    known += (known.empty() ? "" : ", ") + std::string(view.name);
  }
  throw InputError({"", "camera view", name, "one of " + known});
}

/// Half the height of the picture: mm, or of a perspective one at unit distance.
double half_height(const Camera& camera) {
  return camera.projection == Projection::orthographic ? camera.height_mm / 2
                                                       : half_height_at_unit_distance(camera);
}

}  // namespace

void Camera::validate(const std::string& file) const {
  const auto require_finite = [&](const char* field, const Vec3d& v) {
    if (!is_finite(v)) {
      throw InputError(
          {file, std::string("camera.") + field, to_text(v, " "), "three finite numbers"});
    }
  };
  require_finite("position", position_lps_mm);
  require_finite("target", target_lps_mm);
  require_finite("up", up_lps);
  const Vec3d view = target_lps_mm - position_lps_mm;
  if (!(view.length() > 0)) {
    throw InputError({file, "camera.position", to_text(position_lps_mm, " "),
                      "a place other than the target's"});
  }
  if (!(view.normalized().cross(up_lps.normalized()).length() > 1e-6)) {
    throw InputError({file, "camera.up", to_text(up_lps, " "), "a direction across the view"});
  }
  if (!(vertical_fov_degrees > 0 && vertical_fov_degrees < 180)) {
    throw InputError(
        {file, "camera.fov", number_text(vertical_fov_degrees), "degrees between 0 and 180"});
  }
  if (!std::isfinite(window_shift)) {
    throw InputError({file, "camera.window_shift", number_text(window_shift), "a finite number"});
  }
  if (!(height_mm > 0 && std::isfinite(height_mm))) {
    throw InputError({file, "camera.height", number_text(height_mm), "more than 0 mm"});
  }
}

double half_height_at_unit_distance(const Camera& camera) {
  return std::tan(camera.vertical_fov_degrees * kPi / 360);
}

Camera zoomed(const Camera& camera, double factor) {
  if (factor == 1) return camera;
  Camera near = camera;
  near.height_mm /= factor;
  near.vertical_fov_degrees = std::atan(half_height_at_unit_distance(camera) / factor) * 360 / kPi;
  return near;
}

CameraFrame camera_frame(const Camera& camera) {
  const Vec3d forward = (camera.target_lps_mm - camera.position_lps_mm).normalized();
  const Vec3d right = forward.cross(camera.up_lps).normalized();
  return {right, right.cross(forward), forward};
}

CameraRays::CameraRays(const Camera& camera, int width, int height)
    : m_camera(camera),
      m_frame(camera_frame(camera)),
      m_half_height(half_height(camera)),
      m_width(width),
      m_height(height) {}

Ray CameraRays::at(double px, double py) const {
  const double x = ((2 * px - m_width) / m_height + m_camera.window_shift) * m_half_height;
  const double y = (m_height - 2 * py) / m_height * m_half_height;
  const Vec3d aside = m_frame.right * x + m_frame.up * y;
  if (m_camera.projection == Projection::orthographic) {
    return {m_camera.position_lps_mm + aside, m_frame.forward};
  }
  return {m_camera.position_lps_mm, (m_frame.forward + aside).normalized()};
}

Ray camera_ray(const Camera& camera, int width, int height, double px, double py) {
  return CameraRays(camera, width, height).at(px, py);
}

bool CameraRays::pixel_of(const Vec3d& world_mm, double& px, double& py) const {
  const Vec3d p = world_mm - m_camera.position_lps_mm;
  const double depth = p.dot(m_frame.forward);
  if (!(depth > 0)) return false;
  const bool is_parallel = m_camera.projection == Projection::orthographic;
  const double half = is_parallel ? m_half_height : depth * m_half_height;
  px = ((p.dot(m_frame.right) / half - m_camera.window_shift) * m_height + m_width) / 2;
  py = (m_height - p.dot(m_frame.up) / half * m_height) / 2;
  return true;
}

bool project_to_pixel(const Camera& camera, int width, int height, const Vec3d& world_mm,
                      double& px, double& py) {
  return CameraRays(camera, width, height).pixel_of(world_mm, px, py);
}

std::vector<std::array<double, 16>> camera_matrices(const Camera& camera, int width, int height) {
  const CameraFrame frame = camera_frame(camera);
  const std::array<Vec3d, 3> axes = {frame.right, frame.up, frame.forward};
  const double half = half_height(camera), aspect = double(width) / height;
  const bool is_parallel = camera.projection == Projection::orthographic;
  // Columns of camera space to those of the picture, each (x, y, z, 1) times these.
  const double across = 1 / (2 * aspect * half), down = -1 / (2 * half);
  const double middle = 0.5 - camera.window_shift / (2 * aspect);
  std::array<double, 16> to_camera{}, to_picture{};
  for (int row = 0; row < 4; ++row) {
    const auto at = [&](std::size_t axis) {
      return row < 3 ? axes[axis][row] : -axes[axis].dot(camera.position_lps_mm);
    };
    const double one = row < 3 ? 0 : 1, w = is_parallel ? one : at(2);
    const std::size_t first = std::size_t(4 * row);
    for (std::size_t axis = 0; axis < 3; ++axis) to_camera[first + axis] = at(axis);
    to_camera[first + 3] = one;
    to_picture[first] = across * at(0) + middle * w;
    to_picture[first + 1] = down * at(1) + 0.5 * w;
    to_picture[first + 2] = at(2);
    to_picture[first + 3] = w;
  }
  return {to_camera, to_picture};
}

Camera default_camera(const Geometry& geometry, double aspect, const std::string& view_name,
                      Projection projection, double vertical_fov_degrees) {
  const NamedView& view = find_view(view_name);
  const std::vector<Vec3d> corners = box_corners_lps_mm(geometry);
  Camera camera;
  camera.projection = projection;
  camera.vertical_fov_degrees = vertical_fov_degrees;
  camera.target_lps_mm = (corners.front() + corners.back()) / 2;
  camera.position_lps_mm = camera.target_lps_mm + view.from;
  camera.up_lps = view.up;
  const CameraFrame frame = camera_frame(camera);

  // The nearest distance (perspective) or least height (orthographic) that shows every corner.
  const double used = 1 - 2 * kFramingMargin;
  const double tan_y = used * half_height_at_unit_distance(camera);
  double distance = 0, half_height = 0, depth = 0;
  for (const Vec3d& corner : corners) {
    const Vec3d p = corner - camera.target_lps_mm;
    const double extent =
        std::max(std::abs(p.dot(frame.right)) / aspect, std::abs(p.dot(frame.up)));
    distance = std::max(distance, extent / tan_y - p.dot(frame.forward));
    half_height = std::max(half_height, extent / used);
    depth = std::max(depth, std::abs(p.dot(frame.forward)));
  }
  camera.height_mm = 2 * half_height;
  if (projection == Projection::orthographic) distance = 2 * depth + half_height;
  camera.position_lps_mm = camera.target_lps_mm + view.from * distance;
  return camera;
}

std::vector<Vec3d> box_corners_lps_mm(const Geometry& geometry) {
  std::vector<Vec3d> corners(8);
  for (int c = 0; c < 8; ++c) {
    Vec3d index;
    for (int a = 0; a < 3; ++a) index[a] = (c >> a) & 1 ? geometry.dims()[a] - 0.5 : -0.5;
    corners[c] = geometry.world_from_index(index);
  }
  return corners;
}

std::vector<std::string> view_names() {
  std::vector<std::string> names;
  for (const NamedView& view : views()) names.emplace_back(view.name);
  return names;
}

void CameraPath::add_place(double time, const Camera& camera, Easing easing) {
  const CameraFrame frame = camera_frame(camera);
  m_target.add(time, camera.target_lps_mm, easing);
  m_axes.add(time, turn_to({frame.right, frame.up, -frame.forward}), easing);
  const double distance = (camera.position_lps_mm - camera.target_lps_mm).length();
  m_log_distance.add(time, std::log(distance), easing);
}

void CameraPath::add_zoom(double time, double factor, Easing easing) {
  m_log_zoom.add(time, std::log(factor), easing);
}

Camera CameraPath::at(const Camera& start, double time) const {
  Camera camera = start;
  if (!m_target.empty()) {
    const Turn axes = m_axes.at(time);
    camera.target_lps_mm = m_target.at(time);
    camera.position_lps_mm =
        camera.target_lps_mm + axes({0, 0, 1}) * std::exp(m_log_distance.at(time));
    camera.up_lps = axes({0, 1, 0});
  }
  if (!m_fov.empty()) camera.vertical_fov_degrees = m_fov.at(time);
  if (!m_height.empty()) camera.height_mm = m_height.at(time);
  if (!m_log_zoom.empty()) camera = zoomed(camera, std::exp(m_log_zoom.at(time)));
  return m_turn.empty() ? camera : turned_about_target(camera, m_turn.at(time) / 360);
}

}  // namespace supple

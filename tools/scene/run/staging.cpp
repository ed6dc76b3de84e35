#include "tools/scene/run/staging.h"

#include <cmath>

#include "raycast/drawings/annotations.h"
#include "raycast/drawings/rest_outline.h"
#include "raycast/pictures/background.h"
#include "raycast/scene/framing.h"
#include "raycast/scene/transfer_file.h"
#include "tools/scene/run/overlay_paint.h"
#include "tools/scene/run/space_marks.h"
#include "volumes/base/error.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

namespace {

/// Pixels on the longer side of the pictures in which the visible is found.
constexpr int kLookPixels = 192;
constexpr float kVisibleOpacity = 0.1f;
/// Pictures around a turntable's axis.
constexpr int kLooksAround = 8;
/// One looks again from the place that was found, where the depth of translucent edges, which is
/// not known, matters less and less: until the camera moves less than this part of its distance.
constexpr double kSettled = 0.003;
constexpr int kMostLooks = 8;
/// Annotations of small pictures leave the subject at least a third.
constexpr double kWidestMargin = 1.0 / 3;
/// Room beyond the picture's edges, to find what is cut off.
constexpr double kLookZoom = 0.7;

/// Positions of the elements that begin and end each row of a brick, where they are now.
std::vector<Vec3d> body_points(const PosedVolume& subject) {
  if (subject.offsets != nullptr && subject.displacement == nullptr) {
    throw InputError({"", "fit", "body of a volume seen through a warp", "box or visible"});
  }
  std::vector<Vec3d> points;
  const BrickTopology& elements = subject.elements;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for (int row = 0; row < 64; ++row) {
      const int shift = row % 8 * 8;
      const unsigned bits = elements.mask(b)[std::size_t(row / 8)] >> shift & 0xFF;
      if (bits == 0) continue;
      for (const int k : {__builtin_ctz(bits), 31 - __builtin_clz(bits)}) {
        const Vec3i voxel = elements.origin(b) + brick_local(row * 8 + k);
        Vec3f u(0);
        if (subject.displacement != nullptr) subject.displacement->u.at(voxel, u);
        points.push_back(subject.geometry.world_from_index(Vec3d(voxel) + Vec3d(u)));
      }
    }
  }
  return points;
}

/// Adds where a small picture shows something: the corners of its pixels at their depth, or where
/// that is not known, beside the target.
void add_visible_points(const FloatImage& picture, const Camera& camera,
                        std::vector<Vec3d>& points) {
  const CameraRays rays(camera, picture.width, picture.height);
  const Vec3d forward = camera_frame(camera).forward;
  const double to_target = (camera.target_lps_mm - camera.position_lps_mm).dot(forward);
  for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
    if (picture.rgba[4 * n + 3] < kVisibleOpacity) continue;
    const int x = int(n % std::size_t(picture.width)), y = int(n / std::size_t(picture.width));
    const double depth = std::isnan(picture.depth_mm[n]) ? to_target : picture.depth_mm[n];
    for (const auto& [dx, dy] : {std::pair(0, 0), {1, 0}, {0, 1}, {1, 1}}) {
      const Ray ray = rays.at(x + dx, y + dy);
      points.push_back(ray.origin_lps_mm +
                       ray.direction_lps * (depth / ray.direction_lps.dot(forward)));
    }
  }
}

std::vector<Vec3d> visible_points(const PosedVolume& subject, const Renderer& renderer,
                                  SceneView view, const Camera& camera, Progress& progress) {
  const double larger = std::max(view.size[0], view.size[1]);
  for (int& side : view.size) side = std::max(1, int(std::lround(side * kLookPixels / larger)));
  view.lighting.model = ShadingModel::none;
  view.lighting.shadows = false;
  view.lighting.occlusion_radius_mm = 0;
  view.picture.aux = {"depth"};
  std::vector<Vec3d> points;
  const int looks = view.picture.turntable > 0 ? kLooksAround : 1;
  for (int n = 0; n < looks; ++n) {
    view.camera.camera = turned_about_target(camera, double(n) / looks);
    add_visible_points(draw(subject, &renderer, view, nullptr, progress), *view.camera.camera,
                       points);
  }
  return points;
}

/// Densities between which a transfer function shows something.
ScalarRange shown_range(const TransferFunction& function) {
  const std::vector<OpacityKey>& keys = function.opacity;
  ScalarRange range{keys.front().density, keys.back().density};
  for (std::size_t n = 0; n + 1 < keys.size() && keys[n + 1].opacity == 0; ++n) {
    range.lo = keys[n + 1].density;
  }
  range.hi = std::max({range.hi, function.colour.back().density, range.lo + 1});
  return range;
}

}  // namespace

FramingMargins framing_margins(const SceneView& view) {
  const Decoration& wanted = view.decoration;
  const double width = view.size[0], height = view.size[1];
  double left = 0, right = 0, top = 0, bottom = 0;  // heights of letters
  if (wanted.shows("letters")) left = right = top = bottom = Annotations::kLettersReach;
  if (wanted.shows("scale")) bottom = std::max(bottom, Annotations::kScaleBarReach);
  if (wanted.shows("cube")) right = std::max(right, Annotations::kCubeReach);
  if (wanted.shows("cube")) bottom = std::max(bottom, Annotations::kCubeReach);
  if (wanted.shows("text")) {
    top = std::max(top, Annotations::kWordsReach + 2 * Annotations::kLineReach);
  }
  if (wanted.shows("legend")) {
    right = std::max(right, Annotations::kLegendReach);
  }
  const double letter = Annotations::letter_height_for({0, 0, width, height});
  const auto margin = [&](double letters, double side) {
    return std::clamp(letters * letter / side, kFramingMargin, kWidestMargin);
  };
  return {margin(left, width), margin(right, width), margin(top, height), margin(bottom, height)};
}

Camera framed_camera(const PosedVolume& subject, const Renderer* renderer, const SceneView& view,
                     Progress& progress) {
  const Camera camera = camera_of(subject, view);
  if (view.fit.empty()) return zoomed(camera, view.zoom);
  const double aspect = double(view.size[0]) / view.size[1];
  const CameraMotion motion =
      view.picture.turntable > 0 ? CameraMotion::turntable : CameraMotion::still;
  const FramingMargins margins = framing_margins(view);
  const Camera boxed =
      framed(camera, aspect, box_corners_lps_mm(subject.geometry), motion, margins);
  if (view.fit == "box") return zoomed(boxed, view.zoom);
  if (view.fit == "body" || renderer == nullptr) {
    return zoomed(framed(boxed, aspect, body_points(subject), motion, margins), view.zoom);
  }
  Camera found = boxed;
  for (int look = 0; look < kMostLooks; ++look) {
    const Camera wide = zoomed(found, look == 0 ? 1 : kLookZoom);
    const Camera before = found;
    found = framed(found, aspect, visible_points(subject, *renderer, view, wide, progress), motion,
                   margins);
    const double moved = (found.position_lps_mm - before.position_lps_mm).length();
    const double distance = (found.target_lps_mm - found.position_lps_mm).length();
    if (look > 0 && moved < kSettled * distance) break;
  }
  return zoomed(found, view.zoom);
}

void decorate(FloatImage& picture, const PosedVolume& subject, const SceneView& view) {
  const Decoration& wanted = view.decoration;
  const bool paints = !view.marks.overlay.empty();
  const PaintedBody painted{subject.geometry, subject.elements,
                            paints ? rest_place_of(subject) : RestPlaceAt()};
  std::optional<ValuePaint> paint;
  if (paints) {
    paint = overlay_paint(view.marks, painted, PaintEdge::beside);
    paint_values(picture, camera_of(subject, view), *paint, subject.geometry);
  }
  draw_grid(picture, subject, view, camera_of(subject, view));
  if (view.outline) {
    RestOutline(*subject.outlined, subject.geometry).draw(picture, camera_of(subject, view));
  }
  const Background behind =
      wanted.background.empty() ? Background() : parse_background(wanted.background);
  put_over(behind, picture);
  if (wanted.annotate.empty()) return;

  const Camera camera = camera_of(subject, view);
  const CameraFrame frame = camera_frame(camera);
  const PictureArea area{0, 0, double(picture.width), double(picture.height)};
  Overlay overlay;
  // A lattice is drawn on white.
  const Ground ground = is_light(behind) || view.lattice ? Ground::light : Ground::dark;
  Annotations annotations(overlay, area, Annotations::letter_height_for(area), ground);
  if (wanted.shows("letters")) annotations.letters(frame.right, frame.up);
  if (wanted.shows("scale")) {
    const bool is_exact = camera.projection == Projection::orthographic;
    annotations.scale_bar(mm_per_pixel(camera, picture.height), is_exact ? "" : " at target");
  }
  if (wanted.shows("cube")) annotations.cube(frame);
  std::vector<std::string> words = {"from " + orientation_letters(-frame.forward)};
  if (!view.lattice) {
    const TransferFunction function = look_of(view);
    words.insert(words.begin(), function.name);
    if (wanted.shows("legend")) {
      const auto colour = [&](double density) { return Rgb(function.colour_at(density)); };
      const bool is_ct = are_hounsfield_units(subject.density.background());
      const int count = 1 + (view.marks.arrows_mm ? 1 : 0) + (paint ? 1 : 0);
      annotations.legend(shown_range(function), colour, is_ct ? "HU" : "density", 0, count);
      if (paint) add_overlay_legend(annotations, view.marks, *paint, count - 1, count);
      if (view.marks.arrows_mm) add_arrow_legend(annotations, view, count);
    }
  }
  if (wanted.shows("text")) annotations.words(words);
  draw_overlay(picture, overlay);
}

}  // namespace supple::tools

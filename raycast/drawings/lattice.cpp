#include "raycast/drawings/lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volumes/base/error.h"

namespace supple {

namespace {

double edge(const CanvasPoint& a, const CanvasPoint& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// Samples whose centres lie in lo … hi, clipped to 0 … count - 1.
struct PixelRange {
  int first, last;
};
PixelRange covered(double lo, double hi, int count) {
  const double first = std::clamp(std::ceil(lo - 0.5), 0.0, double(count));
  const double last = std::clamp(std::floor(hi - 0.5), -1.0, double(count - 1));
  return {int(first), int(last)};
}

}  // namespace

Canvas::Canvas(const Camera& camera, int width, int height, const Colour3& background)
    : m_camera(camera),
      m_frame(camera_frame(camera)),
      m_width(width * kSamples),
      m_height(height * kSamples) {
  const std::size_t count = std::size_t(m_width) * m_height;
  m_nearness.assign(count, -std::numeric_limits<float>::infinity());
  m_colours.assign(count, {std::uint8_t(background[0]), std::uint8_t(background[1]),
                           std::uint8_t(background[2])});
}

CanvasPoint Canvas::project(const Vec3d& world_mm) const {
  CanvasPoint p;
  p.visible = project_to_pixel(m_camera, m_width, m_height, world_mm, p.x, p.y);
  const double depth = (world_mm - m_camera.position_lps_mm).dot(m_frame.forward);
  // 1 / depth is what perspective keeps linear on the picture.
  p.nearness = m_camera.projection == Projection::perspective ? 1 / depth : -depth;
  return p;
}

void Canvas::plot(int x, int y, double nearness, const Colour3& colour) {
  const std::size_t n = std::size_t(y) * m_width + x;
  if (float(nearness) < m_nearness[n]) return;
  m_nearness[n] = float(nearness);
  for (int c = 0; c < 3; ++c) {
    m_colours[n][c] = std::uint8_t(std::lround(std::clamp(colour[c], 0.0f, 255.0f)));
  }
}

void Canvas::triangle(const std::array<CanvasPoint, 3>& p, const std::array<Colour3, 3>& colours) {
  const double area = edge(p[0], p[1], p[2].x, p[2].y);
  if (!p[0].visible || !p[1].visible || !p[2].visible || area == 0) return;
  const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
  const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
  const PixelRange xs = covered(left, right, m_width), ys = covered(top, bottom, m_height);
  for (int y = ys.first; y <= ys.last; ++y) {
    for (int x = xs.first; x <= xs.last; ++x) {
      const double a = edge(p[1], p[2], x + 0.5, y + 0.5) / area;
      const double b = edge(p[2], p[0], x + 0.5, y + 0.5) / area;
      const double c = 1 - a - b;
      if (a < 0 || b < 0 || c < 0) continue;
      Colour3 colour;
      for (int n = 0; n < 3; ++n) {
        colour[n] = float(a * colours[0][n] + b * colours[1][n] + c * colours[2][n]);
      }
      plot(x, y, a * p[0].nearness + b * p[1].nearness + c * p[2].nearness, colour);
    }
  }
}

void Canvas::line(const CanvasPoint& a, const CanvasPoint& b, double width_pixels,
                  const Colour3& colour) {
  if (!a.visible || !b.visible) return;
  const double radius = 0.5 * width_pixels * kSamples;
  const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  // A bias of the depth that the surface may gain across the line's width.
  const double bias = 2e-4 * std::abs(a.nearness) + 0.5 * std::abs(b.nearness - a.nearness);
  const PixelRange xs = covered(std::min(a.x, b.x) - radius, std::max(a.x, b.x) + radius, m_width);
  const PixelRange ys = covered(std::min(a.y, b.y) - radius, std::max(a.y, b.y) + radius, m_height);
  for (int y = ys.first; y <= ys.last; ++y) {
    for (int x = xs.first; x <= xs.last; ++x) {
      const double px = x + 0.5 - a.x, py = y + 0.5 - a.y;
      const double t = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0, 1.0) : 0.0;
      if (std::hypot(px - t * dx, py - t * dy) > radius) continue;
      plot(x, y, a.nearness + t * (b.nearness - a.nearness) + bias, colour);
    }
  }
}

Image Canvas::to_image() const {
  Image image(m_width / kSamples, m_height / kSamples);
  image.has_alpha = false;
  constexpr int kPerPixel = kSamples * kSamples;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::uint8_t* out = &image.rgba[4 * (std::size_t(y) * image.width + x)];
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int s = 0; s < kPerPixel; ++s) {
          const int row = y * kSamples + s / kSamples, column = x * kSamples + s % kSamples;
          sum += m_colours[std::size_t(row) * m_width + column][c];
        }
        out[c] = std::uint8_t((sum + kPerPixel / 2) / kPerPixel);
      }
      out[3] = 255;
    }
  }
  return image;
}

namespace {

constexpr double kMargin = 0.05;
constexpr Colour3 kPaper = {255, 255, 255};
constexpr Colour3 kLink = {38, 92, 165};
constexpr float kEdgeOn = 0.45f;  // brightness of a face seen edge-on

Vec3d deformed_place_mm(const Geometry& geometry, const VectorBricks& u, const Vec3i& voxel) {
  Vec3f offset(0);
  u.at(voxel, offset);
  return geometry.world_from_index(Vec3d(voxel) + Vec3d(offset));
}

/// The deformed elements and which of their cells exist.
class LatticeDrawing {
 public:
  LatticeDrawing(const Geometry& geometry, const DensityGrid& density,
                 const Displacement& displacement, const LatticeStyle& style)
      : m_geometry(geometry), m_density(density), m_u(displacement.u), m_style(style) {}

  const BrickTopology& elements() const { return m_u.topology; }
  bool is_element(const Vec3i& voxel) const { return elements().is_active(voxel); }

  Vec3d place_mm(const Vec3i& voxel) const { return deformed_place_mm(m_geometry, m_u, voxel); }
  float grey(const Vec3i& voxel) const {
    const double t = (m_density.at(voxel) - m_style.grey_lo) / (m_style.grey_hi - m_style.grey_lo);
    return float(255 * std::clamp(t, 0.0, 1.0));
  }

  /// All eight corners of the cell above `voxel` are elements.
  bool has_cell(const Vec3i& voxel) const {
    for (int c = 0; c < 8; ++c) {
      if (!is_element(voxel + Vec3i(c & 1, (c >> 1) & 1, c >> 2))) return false;
    }
    return true;
  }
  /// The quad at `voxel` across axis `normal` is seen: not between two cells.
  bool is_surface_quad(const Vec3i& voxel, int normal) const {
    return !has_cell(voxel) || !has_cell(voxel - unit(normal));
  }
  /// The link at `voxel` along `axis` is seen: not inside four cells.
  bool is_surface_link(const Vec3i& voxel, int axis) const {
    const Vec3i a = unit((axis + 1) % 3), b = unit((axis + 2) % 3);
    return !has_cell(voxel) || !has_cell(voxel - a) || !has_cell(voxel - b) ||
           !has_cell(voxel - a - b);
  }

  static Vec3i unit(int axis) { return {axis == 0, axis == 1, axis == 2}; }

 private:
  const Geometry& m_geometry;
  const DensityGrid& m_density;
  const VectorBricks& m_u;
  const LatticeStyle& m_style;
};

/// Brightness by the angle between the face and the line of sight.
float facing(const std::array<Vec3d, 4>& p, const Vec3d& sight) {
  const Vec3d normal = (p[2] - p[0]).cross(p[3] - p[1]);
  const double length = normal.length() * sight.length();
  if (!(length > 0)) return 1;
  return kEdgeOn + (1 - kEdgeOn) * float(std::abs(normal.dot(sight)) / length);
}

/// Four triangles around the quad's centre.
void draw_quad(Canvas& canvas, const LatticeDrawing& lattice, const Camera& camera,
               const std::array<Vec3i, 4>& corners) {
  std::array<Vec3d, 4> place;
  std::array<CanvasPoint, 4> points;
  std::array<float, 4> greys;
  for (int c = 0; c < 4; ++c) {
    place[c] = lattice.place_mm(corners[c]);
    points[c] = canvas.project(place[c]);
    greys[c] = lattice.grey(corners[c]);
  }
  const Vec3d centre = (place[0] + place[1] + place[2] + place[3]) / 4;
  const Vec3d sight = camera.projection == Projection::perspective ? centre - camera.position_lps_mm
                                                                   : camera_frame(camera).forward;
  const float light = facing(place, sight);
  const auto colour = [&](float grey) { return Colour3{grey * light, grey * light, grey * light}; };
  const CanvasPoint middle = canvas.project(centre);
  const float middle_grey = (greys[0] + greys[1] + greys[2] + greys[3]) / 4;
  for (int c = 0; c < 4; ++c) {
    const int next = (c + 1) % 4;
    canvas.triangle({points[c], points[next], middle},
                    {colour(greys[c]), colour(greys[next]), colour(middle_grey)});
  }
}

void draw_cells(Canvas& canvas, const LatticeDrawing& lattice, const Camera& camera) {
  for_each_voxel(lattice.elements(), [&](const Vec3i& voxel) {
    for (int normal = 0; normal < 3; ++normal) {
      const Vec3i a = LatticeDrawing::unit((normal + 1) % 3),
                  b = LatticeDrawing::unit((normal + 2) % 3);
      const std::array<Vec3i, 4> corners = {voxel, voxel + a, voxel + a + b, voxel + b};
      const bool complete = std::all_of(corners.begin(), corners.end(), [&](const Vec3i& corner) {
        return lattice.is_element(corner);
      });
      if (complete && lattice.is_surface_quad(voxel, normal)) {
        draw_quad(canvas, lattice, camera, corners);
      }
    }
  });
}

void draw_links(Canvas& canvas, const LatticeDrawing& lattice, double width_pixels) {
  for_each_voxel(lattice.elements(), [&](const Vec3i& voxel) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3i other = voxel + LatticeDrawing::unit(axis);
      if (!lattice.is_element(other) || !lattice.is_surface_link(voxel, axis)) continue;
      canvas.line(canvas.project(lattice.place_mm(voxel)), canvas.project(lattice.place_mm(other)),
                  width_pixels, kLink);
    }
  });
}

}  // namespace

void LatticeStyle::validate() const {
  require(width >= 1 && width <= 16384, "width", width, "1 to 16384 pixels");
  require(height >= 1 && height <= 16384, "height", height, "1 to 16384 pixels");
  require(link_width_pixels >= 0.34 && link_width_pixels <= 10, "link width", link_width_pixels,
          "0.34 to 10 pixels");
  require(grey_lo < grey_hi, "grey_lo", grey_lo, "a density below grey_hi");
}

Image draw_lattice(const Geometry& geometry, const DensityGrid& density,
                   const Displacement& displacement, const Camera& camera,
                   const LatticeStyle& style) {
  camera.validate("");
  style.validate();
  const LatticeDrawing lattice(geometry, density, displacement, style);
  Canvas canvas(camera, style.width, style.height, kPaper);
  if (style.grey_image) draw_cells(canvas, lattice, camera);
  if (style.links) draw_links(canvas, lattice, style.link_width_pixels);
  return canvas.to_image();
}

Camera lattice_camera(const Geometry& geometry, const Displacement& displacement, double aspect) {
  // Looking along i x j with -j up puts i to the right in left-handed frames, too.
  const auto axes = geometry.direction();
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.up_lps = -axes[1];
  camera.position_lps_mm = Vec3d(0);
  camera.target_lps_mm = axes[0].cross(axes[1]);
  const CameraFrame frame = camera_frame(camera);

  // Extents of the deformed elements on the picture, half a voxel around each.
  Vec3d lo(HUGE_VAL), hi(-HUGE_VAL);
  for_each_voxel(displacement.u.topology, [&](const Vec3i& voxel) {
    const Vec3d p = deformed_place_mm(geometry, displacement.u, voxel);
    const Vec3d seen(p.dot(frame.right), p.dot(frame.up), p.dot(frame.forward));
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], seen[a]);
      hi[a] = std::max(hi[a], seen[a]);
    }
  });
  if (displacement.u.topology.empty()) lo = hi = Vec3d(0);
  const Vec3d half_voxel = geometry.spacing_mm() / 2;
  const Vec3d size = hi - lo + half_voxel * 2.0, centre = (lo + hi) / 2;

  camera.height_mm = std::max(size.y, size.x / aspect) / (1 - 2 * kMargin);
  camera.target_lps_mm = frame.right * centre.x + frame.up * centre.y + frame.forward * centre.z;
  camera.position_lps_mm = camera.target_lps_mm - frame.forward * (size.z + camera.height_mm);
  return camera;
}

}  // namespace supple

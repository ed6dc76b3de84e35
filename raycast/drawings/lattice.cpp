#include "raycast/drawings/lattice.h"

#include <algorithm>
#include <cmath>

#include "raycast/drawings/canvas.h"
#include "volumes/base/error.h"

namespace supple {

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

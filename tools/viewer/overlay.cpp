#include "tools/viewer/overlay.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "raycast/pictures/colour_map.h"

namespace supple::tools {

namespace {

constexpr double kOverlayShare = 0.55;  // of the colour, over what is seen
constexpr double kHalfStep = 0.5;       // voxels, of a difference
constexpr double kFlat = 1e-6;          // a gradient of less is none
constexpr double kMostShare = 0.99;

double determinant(const GridGradient& g) {
  return g[0].dot(g[1].cross(g[2]));
}

/// Where tissue is turned inside out, or flat, there is none.
std::optional<GridGradient> inverse_of(const GridGradient& g) {
  const double volume = determinant(g);
  if (std::abs(volume) < kFlat) return std::nullopt;
  const Vec3d rows[3] = {g[1].cross(g[2]) / volume, g[2].cross(g[0]) / volume,
                         g[0].cross(g[1]) / volume};
  GridGradient inverse;
  for (int c = 0; c < 3; ++c) {
    inverse[std::size_t(c)] = {rows[0][c], rows[1][c], rows[2][c]};
  }
  return inverse;
}

/// Central differences of at(index, place), a place in voxels; none where those around are not
/// known.
template <class PlaceAt>
std::optional<GridGradient> gradient_at(const Vec3d& index, PlaceAt&& at) {
  GridGradient g;
  for (int a = 0; a < 3; ++a) {
    Vec3d step(0), ahead, behind;
    step[a] = kHalfStep;
    if (!at(index + step, ahead) || !at(index - step, behind)) return std::nullopt;
    g[std::size_t(a)] = (ahead - behind) / (2 * kHalfStep);
  }
  return g;
}

/// Of the deformation at an element; none at the edge of what is known.
std::optional<GridGradient> deformation_gradient(const Displacement& moved, const Vec3i& voxel) {
  return gradient_at(Vec3d(voxel), [&](const Vec3d& index, Vec3d& place) {
    if (!moved.u.sample(index, place)) return false;
    place += index;
    return true;
  });
}

double energy_of_class(const MaterialClasses& classes, int of, const GridGradient& f,
                       const Geometry& geometry) {
  return strain_energy_kpa(f, geometry, classes.physics(of, of).stiffness_kpa,
                           classes.poisson_of_class(of));
}

double share_of(double value, const OverlayRange& range) {
  return std::clamp((value - range.lo) / (range.hi - range.lo), 0., 1.);
}

}  // namespace

Rgb overlay_colour(FieldOverlay overlay, double share) {
  if (overlay != FieldOverlay::det_f) return offset_colour(share);
  const double towards = std::abs(2 * share - 1);
  const Rgb end = share < 0.5 ? Rgb{0.13, 0.4, 0.85} : Rgb{0.84, 0.19, 0.15};
  Rgb colour;
  for (std::size_t c = 0; c < 3; ++c) colour[c] = 0.87 + (end[c] - 0.87) * towards;
  return colour;
}

double strain_energy_kpa(const GridGradient& f, const Geometry& geometry, double young_kpa,
                         double poisson) {
  std::array<Vec3d, 3> columns;  // of F in mm
  for (int a = 0; a < 3; ++a) {
    Vec3d axis(0);
    axis[a] = 1;
    const Vec3d steps = geometry.index_vector_from_world(axis);
    columns[std::size_t(a)] =
        geometry.world_vector_from_index(f[0] * steps.x + f[1] * steps.y + f[2] * steps.z);
  }
  double trace = 0, squares = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      const double strain = (columns[a].dot(columns[b]) - (a == b ? 1 : 0)) / 2;
      trace += a == b ? strain : 0;
      squares += strain * strain;
    }
  }
  const double lambda = young_kpa * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const double mu = young_kpa / (2 * (1 + poisson));
  return lambda / 2 * trace * trace + mu * squares;
}

OverlayField::OverlayField(FieldOverlay overlay, const Session& session, const State& opened,
                           const RestPlaceAt& rest)
    : m_overlay(overlay),
      m_session(session),
      m_opened(opened),
      m_rest(rest),
      m_classes(session.material()) {}

std::optional<double> OverlayField::at(const Vec3d& index) const {
  Vec3d at_rest;
  if (!m_rest(index, at_rest)) return std::nullopt;
  const Vec3i voxel(int(std::lround(at_rest.x)), int(std::lround(at_rest.y)),
                    int(std::lround(at_rest.z)));
  const std::int32_t brick = m_opened.elements.find(voxel);
  if (brick < 0 || !m_opened.elements.is_active(voxel)) return std::nullopt;
  if (m_overlay == FieldOverlay::displacement) {
    return m_opened.geometry.world_vector_from_index(index - at_rest).length();
  }
  const auto rest = gradient_at(index, m_rest);
  const auto f = rest ? inverse_of(*rest) : std::nullopt;
  if (m_overlay == FieldOverlay::det_f) return f ? determinant(*f) : 1;
  if (!f) return std::nullopt;
  const std::size_t slot = std::size_t(brick) * kBrickVoxels + std::size_t(brick_offset(voxel));
  return energy_of_class(m_classes, m_session.body().classes[slot], *f, m_opened.geometry);
}

void paint_overlay(Image& slice, const Geometry& grid, const OverlayField& field,
                   const Geometry& geometry, const OverlayRange& range) {
  tbb::parallel_for(0, slice.height, [&](int y) {
    for (int x = 0; x < slice.width; ++x) {
      const auto value = field.at(geometry.index_from_world(grid.world_from_index(Vec3d(x, y, 0))));
      if (!value) continue;
      const Rgb colour = overlay_colour(field.overlay(), share_of(*value, range));
      std::uint8_t* pixel = &slice.rgba[4 * (std::size_t(y) * slice.width + x)];
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] = std::uint8_t(
            std::lround((1 - kOverlayShare) * pixel[c] + kOverlayShare * 255 * colour[c]));
      }
    }
  });
}

/// By the lightness of what is seen, so that its relief stays.
void paint_overlay(FloatImage& picture, const Camera& camera, const OverlayField& field,
                   const Geometry& geometry, const OverlayRange& range) {
  const Vec3d forward = camera_frame(camera).forward;
  tbb::parallel_for(0, picture.height, [&](int y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::size_t n = std::size_t(y) * picture.width + x;
      const double depth = picture.depth_mm[n];
      if (!std::isfinite(depth)) continue;
      const Ray ray = camera_ray(camera, picture.width, picture.height, x + 0.5, y + 0.5);
      const Vec3d place =
          ray.origin_lps_mm + ray.direction_lps * (depth / ray.direction_lps.dot(forward));
      const auto value = field.at(geometry.index_from_world(place));
      if (!value) continue;
      const Rgb colour = overlay_colour(field.overlay(), share_of(*value, range));
      float* pixel = &picture.rgba[4 * n];
      const double light = std::max({pixel[0], pixel[1], pixel[2]});
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] = float((1 - kOverlayShare) * pixel[c] + kOverlayShare * light * colour[c]);
      }
    }
  });
}

double most_energy_kpa(const Session& session, const Displacement& moved) {
  const BrickTopology& elements = session.body().elements;
  const MaterialClasses classes(session.material());
  std::vector<double> energies;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i voxel = elements.origin(b) + brick_local(offset);
      if (voxel.x % 4 != 0 || voxel.y % 4 != 0 || voxel.z % 4 != 0) return;
      const auto f = deformation_gradient(moved, voxel);
      if (!f) return;
      const int of = session.body().classes[b * kBrickVoxels + std::size_t(offset)];
      energies.push_back(energy_of_class(classes, of, *f, session.geometry()));
    });
  }
  if (energies.empty()) return 0;
  const auto most = energies.begin() + std::ptrdiff_t(kMostShare * double(energies.size() - 1));
  std::nth_element(energies.begin(), most, energies.end());
  return *most;
}

}  // namespace supple::tools

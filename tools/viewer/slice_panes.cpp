#include "tools/viewer/slice_panes.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "raycast/scene/camera.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

namespace {

constexpr double kMostShare = 0.99;

/// Gradient of the deformation at an element; none at the edge of what is known.
std::optional<GridGradient> deformation_gradient(const Displacement& moved, const Vec3i& voxel) {
  return gradient_at(Vec3d(voxel), [&](const Vec3d& index, Vec3d& place) {
    if (!moved.u.sample(index, place)) return false;
    place += index;
    return true;
  });
}

/// Columns of F in mm, on the axes of LPS.
GridGradient columns_mm(const GridGradient& f, const Geometry& geometry) {
  GridGradient columns;
  for (int a = 0; a < 3; ++a) {
    Vec3d axis(0);
    axis[a] = 1;
    const Vec3d steps = geometry.index_vector_from_world(axis);
    columns[std::size_t(a)] =
        geometry.world_vector_from_index(f[0] * steps.x + f[1] * steps.y + f[2] * steps.z);
  }
  return columns;
}

/// E = (F^T F - 1) / 2, its trace and the sum of its squares.
struct GreenStrain {
  explicit GreenStrain(const GridGradient& columns) {
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) {
        at[a][b] = (columns[a].dot(columns[b]) - (a == b ? 1 : 0)) / 2;
        trace += a == b ? at[a][b] : 0;
        squares += at[a][b] * at[a][b];
      }
    }
  }
  std::array<std::array<double, 3>, 3> at;
  double trace = 0, squares = 0;
};

double energy_of_class(const MaterialClasses& classes, int of, const GridGradient& f,
                       const Geometry& geometry) {
  return strain_energy_kpa(f, geometry, classes.physics(of, of).stiffness_kpa,
                           classes.poisson_of_class(of));
}

}  // namespace

ValueColours colours_of(FieldOverlay overlay) {
  return overlay == FieldOverlay::det_f ? ValueColours::about_middle : ValueColours::ascending;
}

double strain_energy_kpa(const GridGradient& f, const Geometry& geometry, double young_kpa,
                         double poisson) {
  const GreenStrain e(columns_mm(f, geometry));
  const double lambda = young_kpa * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const double mu = young_kpa / (2 * (1 + poisson));
  return lambda / 2 * e.trace * e.trace + mu * e.squares;
}

double von_mises_kpa(const GridGradient& f, const Geometry& geometry, double young_kpa,
                     double poisson) {
  const GridGradient columns = columns_mm(f, geometry);
  const GreenStrain e(columns);
  const double lambda = young_kpa * poisson / ((1 + poisson) * (1 - 2 * poisson));
  const double mu = young_kpa / (2 * (1 + poisson));
  const double volume = std::abs(determinant(columns));
  // Cauchy's stress is F S F^T / J with S = lambda tr E + 2 mu E.
  std::array<std::array<double, 3>, 3> stress{};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      const double s = (a == b ? lambda * e.trace : 0) + 2 * mu * e.at[a][b];
      for (int n = 0; n < 3; ++n) {
        for (int m = 0; m < 3; ++m) {
          stress[std::size_t(n)][std::size_t(m)] += columns[a][n] * s * columns[b][m] / volume;
        }
      }
    }
  }
  const double mean = (stress[0][0] + stress[1][1] + stress[2][2]) / 3;
  double squares = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    for (std::size_t m = 0; m < 3; ++m) {
      const double part = stress[n][m] - (n == m ? mean : 0);
      squares += part * part;
    }
  }
  return std::sqrt(1.5 * squares);
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
  const auto f = deformation_at(m_rest, index);
  if (m_overlay == FieldOverlay::det_f) return f ? determinant(*f) : 1;
  if (!f) return std::nullopt;
  const std::size_t slot = std::size_t(brick) * kBrickVoxels + std::size_t(brick_offset(voxel));
  return energy_of_class(m_classes, m_session.body().classes[slot], *f, m_opened.geometry);
}

ValuePaint OverlayField::paint(const ScalarRange& range) const {
  const double at_rest = m_overlay == FieldOverlay::det_f ? 1 : 0;
  return {[this](const Vec3d& index) { return at(index); }, range, colours_of(m_overlay), at_rest};
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

namespace {

/// The grid of a pane's pixels.
Geometry pane_grid(const Geometry& geometry, const SliceSettings& settings, int plane,
                   const PixelSize& size) {
  // An oblique slice has pixels of the same size, so that it does not grow and shrink as it turns.
  const SliceAxes straight = slice_axes(geometry, SlicePlane(plane));
  const SliceAxes axes = settings.turned[std::size_t(plane)].value_or(straight);
  Vec3d lo(1e300), hi(-1e300);
  for (const Vec3d& corner : box_corners_lps_mm(geometry)) {
    const Vec3d at(corner.dot(straight.right), corner.dot(straight.down), 0);
    for (int a = 0; a < 2; ++a) {
      lo[a] = std::min(lo[a], at[a]);
      hi[a] = std::max(hi[a], at[a]);
    }
  }
  const double pixel_mm =
      std::max((hi.x - lo.x) / size[0], (hi.y - lo.y) / size[1]) / settings.zoom;
  const Vec3d cursor = geometry.world_from_index(settings.cursor);
  double across = (lo.x + hi.x) / 2, down = (lo.y + hi.y) / 2;
  if (settings.turned[std::size_t(plane)]) {
    const Vec3d middle = geometry.world_from_index((Vec3d(geometry.dims()) - Vec3d(1)) / 2);
    across = middle.dot(axes.right);
    down = middle.dot(axes.down);
  }
  if (const auto& centre = settings.centre[std::size_t(plane)]) {
    const Vec3d at = geometry.world_from_index(*centre);
    across = at.dot(axes.right);
    down = at.dot(axes.down);
  }
  const Vec3d first =
      cursor + axes.right * (across - cursor.dot(axes.right) - pixel_mm * (size[0] - 1) / 2) +
      axes.down * (down - cursor.dot(axes.down) - pixel_mm * (size[1] - 1) / 2);
  return Geometry({size[0], size[1], 1}, first,
                  {axes.right * pixel_mm, axes.down * pixel_mm, axes.right.cross(axes.down)});
}

}  // namespace

Fields fields(SliceSettings& settings) {
  return {
      Field("cursor", settings.cursor, "Index that all slices pass through").range(-1e5, 1e5),
      Field("window", settings.window, "Densities from black to white").range(1e-6, 1e9),
      Field("level", settings.level, "Density in the middle of them").range(-1e9, 1e9),
      Field("overlay", settings.overlay, {"none", "displacement", "det_f", "energy"},
            "What is painted over the densities"),
      Field("overlay_in_space", settings.overlay_in_space, "Over the view in space, too"),
      Field("outline_in_space", settings.outline_in_space, "Over the view in space, too"),
      Field("outline", settings.outline, "The outline of the body at rest"),
      Field("zoom", settings.zoom, "Magnification").range(0.05, 100),
  };
}

void read_turned(Table& table, SliceSettings& settings) {
  constexpr double kNearly = 1e-6;
  settings.turned = {};
  for (std::size_t plane = 0; plane < 3; ++plane) {
    const char* name = kViewNames[plane + 1];
    auto given = table.table(name);
    if (!given) continue;
    SliceAxes axes{{0, 0, 0}, {0, 0, 0}};
    axes.right = given->require(given->get<Vec3d>("right"), "right", "[L, P, S]");
    axes.down = given->require(given->get<Vec3d>("down"), "down", "[L, P, S]");
    given->finish();
    const double fault =
        std::max({std::abs(axes.right.length() - 1), std::abs(axes.down.length() - 1),
                  std::abs(axes.right.dot(axes.down))});
    if (!(fault < kNearly)) {
      table.fail(name, "other axes", "right and down of length 1 mm at a right angle");
    }
    settings.turned[plane] = axes;
  }
  table.finish();
}

SliceSettings default_slices(const State& state) {
  const SliceChoice choice = effective_slice({}, state.geometry, state.density);
  const auto [lo, hi] = *choice.window;
  SliceSettings settings;
  settings.cursor = *choice.at;
  settings.window = hi - lo;
  settings.level = (lo + hi) / 2;
  return settings;
}

PixelFrame pane_pixels(const Geometry& geometry, const SliceSettings& settings, int plane,
                       const PixelSize& size) {
  const Geometry grid = pane_grid(geometry, settings, plane, size);
  return {grid.origin_lps_mm(), grid.axes_mm()[0], grid.axes_mm()[1]};
}

SlicePane draw_pane(const State& state, const SliceSettings& settings, int plane,
                    const PixelSize& size, const RestPlaceAt& rest, const OverlayField* overlay,
                    const ScalarRange& range, int every) {
  const Geometry& geometry = state.geometry;
  const PixelSize drawn{std::max(1, size[0] / every), std::max(1, size[1] / every)};
  const Geometry grid = pane_grid(geometry, settings, plane, drawn);
  const float outside = state.density.background();
  const DensityAt density = [&](const Vec3d& index) {
    Vec3d at_rest = within_border(index, geometry.dims());
    return !rest || rest(index, at_rest) ? sample_trilinear(state.density, at_rest, outside)
                                         : outside;
  };
  SliceStyle style;
  style.grey_lo = settings.level - settings.window / 2;
  style.grey_hi = settings.level + settings.window / 2;
  if (settings.outline && rest) style.rest = &state.elements;
  style.rest_place = rest;
  if (overlay != nullptr) {
    style.paint = [&](Image& slice) { paint_values(slice, grid, overlay->paint(range), geometry); };
  }
  SlicePane pane;
  pane.image = draw_slice(geometry, grid, density, style);
  pane.pixels = pane_pixels(geometry, settings, plane, size);
  return pane;
}

}  // namespace supple::tools

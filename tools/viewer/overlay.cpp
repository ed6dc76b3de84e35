#include "tools/viewer/overlay.h"

#include <algorithm>
#include <cmath>

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

}  // namespace supple::tools

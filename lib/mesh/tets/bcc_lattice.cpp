#include "lib/mesh/tets/bcc_lattice.h"

#include <cmath>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// Perpendicular axes of unit length, right-handed, the first two as those of the grid as it can be
/// (Gram and Schmidt).
std::array<Vec3d, 3> frame_of(const Geometry& geometry) {
  const std::array<Vec3d, 3> axes = geometry.direction();
  const Vec3d x = axes[0].normalized();
  const Vec3d y = (axes[1] - x * x.dot(axes[1])).normalized();
  return {x, y, x.cross(y)};
}

}  // namespace

BccLattice::BccLattice(const Geometry& geometry, const IndexBox& box, double spacing_mm)
    : m_geometry(geometry), m_spacing(spacing_mm), m_axes(frame_of(geometry)) {
  const auto local_of = [&](const Vec3d& index) {
    const Vec3d from_first = geometry.world_vector_from_index(index);
    return Vec3d(from_first.dot(m_axes[0]), from_first.dot(m_axes[1]), from_first.dot(m_axes[2]));
  };
  Vec3d low(1e300), high(-1e300);
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d index;
    for (int a = 0; a < 3; ++a) {
      index[a] = (corner >> a & 1) != 0 ? box.hi[a] + 1.0 : box.lo[a] - 1.0;
    }
    const Vec3d at = local_of(index);
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], at[a]);
      high[a] = std::max(high[a], at[a]);
    }
  }
  double vertices = 2;
  std::array<double, 3> cubes{};
  for (int a = 0; a < 3; ++a) {
    cubes[std::size_t(a)] = std::ceil((high[a] - low[a]) / spacing_mm) + 2;
    vertices *= cubes[std::size_t(a)] + 1;
  }
  if (!(vertices <= double(kMostVertices))) {
    throw InputError({"", "spacing", number_text(spacing_mm) + " mm",
                      "a larger one: the lattice would have " + number_text(vertices, 3) +
                          " vertices, of at most " + number_text(double(kMostVertices))});
  }
  for (int a = 0; a < 3; ++a) {
    m_cubes[a] = int(cubes[std::size_t(a)]);
    m_origin_mm[a] = (low[a] + high[a] - m_cubes[a] * spacing_mm) / 2;
  }
  m_per_kind = std::int64_t(m_cubes.x + 1) * (m_cubes.y + 1) * (m_cubes.z + 1);
  m_index_origin = geometry.index_from_world(lps_at(Vec3d(0)));
  for (std::size_t a = 0; a < 3; ++a) {
    m_index_axes[a] = geometry.index_vector_from_world(m_axes[a] * (spacing_mm / 2));
  }
}

LatticePlace BccLattice::place(std::int64_t id) const {
  const int odd = id >= m_per_kind ? 1 : 0;
  id -= odd * m_per_kind;
  const int i = int(id % (m_cubes.x + 1));
  id /= m_cubes.x + 1;
  const int j = int(id % (m_cubes.y + 1)), k = int(id / (m_cubes.y + 1));
  return {2 * i + odd, 2 * j + odd, 2 * k + odd};
}

Vec3d BccLattice::index_at(const Vec3d& half_edges) const {
  return m_index_origin + m_index_axes[0] * half_edges.x + m_index_axes[1] * half_edges.y +
         m_index_axes[2] * half_edges.z;
}

Vec3d BccLattice::lps_at(const Vec3d& half_edges) const {
  const Vec3d mm = m_origin_mm + half_edges * (m_spacing / 2);
  return m_geometry.origin_lps_mm() + m_axes[0] * mm.x + m_axes[1] * mm.y + m_axes[2] * mm.z;
}

}  // namespace supple

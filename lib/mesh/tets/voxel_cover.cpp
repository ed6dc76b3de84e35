#include "lib/mesh/tets/voxel_cover.h"

#include <cmath>

namespace supple {

namespace {

/// A tetrahedron in the volume's grid, of either orientation, as four half-spaces.
class IndexTet {
 public:
  explicit IndexTet(const std::array<Vec3d, 4>& corners) : m_lo(1e300), m_hi(-1e300) {
    for (std::size_t f = 0; f < 4; ++f) {
      const Vec3d &a = corners[(f + 1) & 3U], &b = corners[(f + 2) & 3U],
                  &c = corners[(f + 3) & 3U];
      Vec3d normal = (b - a).cross(c - a);
      if (normal.dot(corners[f] - a) < 0) normal = -normal;
      m_normals[f] = normal;
      m_depths[f] = normal.dot(a);
      for (int x = 0; x < 3; ++x) {
        m_lo[x] = std::min(m_lo[x], corners[f][x]);
        m_hi[x] = std::max(m_hi[x], corners[f][x]);
      }
    }
  }

  /// Calls visit(voxel) for the centres within.
  template <class Visit>
  void for_each_voxel(const Visit& visit) const {
    for (int k = int(std::ceil(m_lo.z)); k <= int(std::floor(m_hi.z)); ++k) {
      for (int j = int(std::ceil(m_lo.y)); j <= int(std::floor(m_hi.y)); ++j) {
        double from = m_lo.x, to = m_hi.x;
        for (std::size_t f = 0; f < 4; ++f) {
          const double rest = m_depths[f] - m_normals[f].y * j - m_normals[f].z * k;
          const double along = m_normals[f].x;
          if (along > 0) from = std::max(from, rest / along);
          if (along < 0) to = std::min(to, rest / along);
          if (along == 0 && rest > 0) to = from - 1;
        }
        if (from > to + 2e-9) continue;
        for (int i = int(std::ceil(from - 1e-9)); i <= int(std::floor(to + 1e-9)); ++i) {
          visit(Vec3i(i, j, k));
        }
      }
    }
  }

 private:
  std::array<Vec3d, 4> m_normals;  // inwards
  std::array<double, 4> m_depths{};
  Vec3d m_lo, m_hi;
};

}  // namespace

VoxelCover cover_of(const VoxelMask& mask, const SolidMesh& mesh) {
  // A voxel around the box: elements may reach half a voxel beyond it.
  const Vec3i lo = mask.box.lo - Vec3i(1), dims = mask.dims() + Vec3i(2);
  std::vector<std::uint8_t> is_covered(
      std::size_t(dims.x) * std::size_t(dims.y) * std::size_t(dims.z), 0);
  std::vector<Vec3d> places;
  places.reserve(mesh.nodes_lps_mm.size());
  for (const Vec3d& node : mesh.nodes_lps_mm) {
    places.push_back(mask.geometry.index_from_world(node) - Vec3d(lo));
  }
  for (const auto& tet : mesh.tets) {
    std::array<Vec3d, 4> corners;
    for (std::size_t c = 0; c < 4; ++c) corners[c] = places[std::size_t(tet[c])];
    IndexTet(corners).for_each_voxel([&](const Vec3i& at) {
      for (int a = 0; a < 3; ++a) {
        if (at[a] < 0 || at[a] >= dims[a]) return;
      }
      is_covered[(std::size_t(at.z) * std::size_t(dims.y) + std::size_t(at.y)) *
                     std::size_t(dims.x) +
                 std::size_t(at.x)] = 1;
    });
  }
  std::int64_t covered = 0;
  for (const std::uint8_t is : is_covered) covered += is;
  VoxelCover cover;
  const Vec3i inner = mask.dims();
  std::size_t n = 0;
  for (int k = 0; k < inner.z; ++k) {
    for (int j = 0; j < inner.y; ++j) {
      const std::uint8_t* row =
          is_covered.data() +
          (std::size_t(k + 1) * std::size_t(dims.y) + std::size_t(j + 1)) * std::size_t(dims.x) + 1;
      for (int i = 0; i < inner.x; ++i, ++n) cover.both += mask.inside[n] & row[i];
    }
  }
  cover.lost = mask.count() - cover.both;
  cover.gained = covered - cover.both;
  return cover;
}

}  // namespace supple

// The motion of a solid as vectors on a grid, slice by slice.
#include <algorithm>
#include <cmath>
#include <limits>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/io/vtu/vtu.h"

namespace supple {

namespace {

/// Tolerance of barycentric coordinates: points on a face belong to both of its tetrahedra.
constexpr double kOnFace = 1e-9;

/// A tetrahedron where it is now, in the index frame of the grid.
struct MovedTetrahedron {
  Vec3d origin;
  std::array<Vec3d, 3> rows;  // of the matrix to barycentric coordinates 1 to 3
  std::array<int, 4> points;
  Vec3d low, high;
};

class SolidVectors : public VolumeFile {
 public:
  SolidVectors(const std::string& path, const Geometry& grid) : m_solid(read_vtu(path)) {
    m_header.path = path;
    m_header.format = "vtu";
    m_header.type = ValueType::float64;
    m_header.components = 3;
    m_header.warp_direction = "resample";
    m_header.geometry = grid;
    place_tetrahedra();
    warn_of_turned();
  }

  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    const std::size_t count = std::size_t(dims.x) * std::size_t(dims.y);
    auto* vectors = static_cast<double*>(out);
    std::fill_n(vectors, 3 * count, 0.0);
    std::vector<double> shortest(count, std::numeric_limits<double>::infinity());
    const int k = m_slices_read++;
    for (const std::size_t n : m_of_slice[std::size_t(k)]) {
      fill(m_tetrahedra[n], k, vectors, shortest);
    }
  }

 private:
  /// Six times the volume of a tetrahedron, with a sign, by a place of each point.
  template <class Place>
  static double volume_of(const std::array<int, 4>& points, const Place& place) {
    const Vec3d origin = place(points[0]);
    return (place(points[1]) - origin)
        .dot((place(points[2]) - origin).cross(place(points[3]) - origin));
  }

  /// Motion that turns a cell inside out is no deformation: a simulation has failed there.
  void warn_of_turned() {
    const auto rest = [&](int n) { return m_solid.points_lps_mm[std::size_t(n)]; };
    const auto moved = [&](int n) { return rest(n) + m_solid.moved_mm[std::size_t(n)]; };
    std::size_t turned = 0;
    Vec3d first(0);
    for (const std::array<int, 4>& points : m_solid.tetrahedra) {
      if (volume_of(points, rest) * volume_of(points, moved) >= 0) continue;
      if (turned++ == 0) first = moved(points[0]);
    }
    if (turned == 0) return;
    m_header.warnings.push_back(
        std::to_string(turned) + " of " + std::to_string(m_solid.tetrahedra.size()) +
        " tetrahedra are turned inside out by their motion, the first near LPS " +
        to_text(first, ", ") + " mm: the warp folds there");
  }

  void place_tetrahedra() {
    const Geometry& grid = m_header.geometry;
    m_of_slice.resize(std::size_t(grid.dims().z));
    std::vector<Vec3d> places;
    for (std::size_t n = 0; n < m_solid.points_lps_mm.size(); ++n) {
      places.push_back(grid.index_from_world(m_solid.points_lps_mm[n] + m_solid.moved_mm[n]));
    }
    for (const std::array<int, 4>& points : m_solid.tetrahedra) {
      MovedTetrahedron tetrahedron;
      tetrahedron.points = points;
      tetrahedron.origin = places[std::size_t(points[0])];
      tetrahedron.low = tetrahedron.high = tetrahedron.origin;
      std::array<Vec3d, 3> edges;
      for (std::size_t n = 1; n < 4; ++n) {
        const Vec3d& place = places[std::size_t(points[n])];
        edges[n - 1] = place - tetrahedron.origin;
        for (int a = 0; a < 3; ++a) {
          tetrahedron.low[a] = std::min(tetrahedron.low[a], place[a]);
          tetrahedron.high[a] = std::max(tetrahedron.high[a], place[a]);
        }
      }
      const double volume = edges[0].dot(edges[1].cross(edges[2]));
      if (volume == 0) continue;
      tetrahedron.rows = {edges[1].cross(edges[2]) / volume, edges[2].cross(edges[0]) / volume,
                          edges[0].cross(edges[1]) / volume};
      const double first = std::max(0.0, std::ceil(tetrahedron.low.z - kOnFace));
      const double last = std::min(grid.dims().z - 1.0, std::floor(tetrahedron.high.z + kOnFace));
      for (double k = first; k <= last; ++k) {
        m_of_slice[std::size_t(k)].push_back(m_tetrahedra.size());
      }
      m_tetrahedra.push_back(tetrahedron);
    }
  }

  void fill(const MovedTetrahedron& tetrahedron, int k, double* vectors,
            std::vector<double>& shortest) const {
    const Vec3i& dims = m_header.geometry.dims();
    const auto from = [&](int a) {
      return int(std::max(0.0, std::ceil(tetrahedron.low[a] - kOnFace)));
    };
    const auto to = [&](int a) {
      return int(std::min(dims[a] - 1.0, std::floor(tetrahedron.high[a] + kOnFace)));
    };
    for (int j = from(1); j <= to(1); ++j) {
      for (int i = from(0); i <= to(0); ++i) {
        const Vec3d local = Vec3d(i, j, k) - tetrahedron.origin;
        std::array<double, 4> weights;
        for (std::size_t n = 0; n < 3; ++n) weights[n + 1] = tetrahedron.rows[n].dot(local);
        weights[0] = 1 - weights[1] - weights[2] - weights[3];
        if (*std::min_element(weights.begin(), weights.end()) < -kOnFace) continue;
        Vec3d back(0);
        for (std::size_t n = 0; n < 4; ++n) {
          back -= m_solid.moved_mm[std::size_t(tetrahedron.points[n])] * weights[n];
        }
        const std::size_t pixel = std::size_t(j) * std::size_t(dims.x) + std::size_t(i);
        if (back.length2() >= shortest[pixel]) continue;
        shortest[pixel] = back.length2();
        for (int c = 0; c < 3; ++c) vectors[3 * pixel + std::size_t(c)] = back[c];
      }
    }
  }

  MovedSolid m_solid;
  std::vector<MovedTetrahedron> m_tetrahedra;
  std::vector<std::vector<std::size_t>> m_of_slice;
  int m_slices_read = 0;
};

}  // namespace

std::unique_ptr<VolumeFile> open_vtu(const std::string& path, const Geometry* grid) {
  if (grid == nullptr) {
    throw InputError({path, "grid", "a mesh, which has none", "a grid to evaluate it on"});
  }
  return std::make_unique<SolidVectors>(path, *grid);
}

}  // namespace supple

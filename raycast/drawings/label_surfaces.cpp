#include "raycast/drawings/label_surfaces.h"

#include <algorithm>
#include <array>
#include <map>

namespace supple {

namespace {

constexpr int kSmoothings = 20;
/// Reach of a vertex from its cube's centre, in voxels: it stays inside; triangles keep an area.
constexpr double kReach = 0.49;

using NetFace = std::array<int, 4>;  // vertices, in order around a face between two voxels

/// The vertices of cubes between voxels, and the faces that they span.
class SurfaceNet {
 public:
  SurfaceNet(const Geometry& geometry,
             const std::function<std::int64_t(const Vec3i& voxel)>& label_at)
      : m_dims(geometry.dims()), m_label_at(label_at) {
    std::vector<std::int64_t> below(slice_size(), 0), above;
    m_vertices_above.assign(slice_size(), -1);
    for (int k = 0; k <= m_dims.z; ++k) {
      above = slice(k);
      // The cubes below slice k, and those that reach from it to the next.
      m_vertices_below.swap(m_vertices_above);
      m_vertices_above.assign(slice_size(), -1);
      add_slice(k, below, above);
      below.swap(above);
    }
  }

  /// Gibson's relaxation, all vertices at a time.
  void smooth() {
    const std::vector<Vec3d> centres = m_places;
    std::vector<Vec3d> sum(m_places.size());
    std::vector<int> count(m_places.size());
    for (int n = 0; n < kSmoothings; ++n) {
      std::fill(sum.begin(), sum.end(), Vec3d(0));
      std::fill(count.begin(), count.end(), 0);
      for (const auto& [label, quads] : m_quads) {
        for (const NetFace& quad : quads) {
          for (std::size_t side = 0; side < 4; ++side) {
            const std::size_t a = std::size_t(quad[side]), b = std::size_t(quad[(side + 1) % 4]);
            sum[a] += m_places[b], ++count[a];
            sum[b] += m_places[a], ++count[b];
          }
        }
      }
      for (std::size_t v = 0; v < m_places.size(); ++v) {
        if (count[v] == 0) continue;
        const Vec3d wanted = sum[v] / count[v];
        for (int a = 0; a < 3; ++a) {
          m_places[v][a] = std::clamp(wanted[a], centres[v][a] - kReach, centres[v][a] + kReach);
        }
      }
    }
  }

  std::vector<LabelSurface> surfaces(const Geometry& geometry) const {
    std::vector<LabelSurface> surfaces;
    // A left-handed grid turns the winding round.
    const auto axes = geometry.direction();
    const bool is_mirrored = axes[0].cross(axes[1]).dot(axes[2]) < 0;
    std::vector<int> own(m_places.size(), -1);  // number in the surface of `owner`
    std::vector<std::int64_t> owner(m_places.size(), 0);
    for (const auto& [label, quads] : m_quads) {
      LabelSurface surface{label, {}};
      const auto vertex = [&, label = label](int v) {
        if (owner[std::size_t(v)] != label) {
          owner[std::size_t(v)] = label;
          own[std::size_t(v)] = int(surface.mesh.vertices_lps_mm.size());
          surface.mesh.vertices_lps_mm.push_back(
              geometry.world_from_index(m_places[std::size_t(v)]));
        }
        return own[std::size_t(v)];
      };
      for (NetFace quad : quads) {
        if (is_mirrored) std::swap(quad[1], quad[3]);
        for (int& v : quad) v = vertex(v);
        surface.mesh.triangles.push_back({quad[0], quad[1], quad[2]});
        surface.mesh.triangles.push_back({quad[0], quad[2], quad[3]});
      }
      surfaces.push_back(std::move(surface));
    }
    return surfaces;
  }

 private:
  // A rim of one voxel without a label around each slice.
  std::size_t slice_size() const { return std::size_t(m_dims.x + 2) * std::size_t(m_dims.y + 2); }
  std::size_t at(int i, int j) const {
    return std::size_t(j + 1) * std::size_t(m_dims.x + 2) + std::size_t(i + 1);
  }

  std::vector<std::int64_t> slice(int k) const {
    std::vector<std::int64_t> labels(slice_size(), 0);
    if (k == m_dims.z) return labels;
    for (int j = 0; j < m_dims.y; ++j) {
      for (int i = 0; i < m_dims.x; ++i) labels[at(i, j)] = m_label_at({i, j, k});
    }
    return labels;
  }

  /// The vertex of the cube whose lowest voxel this is, between slices k - 1 and k or above them.
  int vertex(const Vec3i& cube, int k) {
    int& vertex = (cube.z < k ? m_vertices_below : m_vertices_above)[at(cube.x, cube.y)];
    if (vertex < 0) {
      vertex = int(m_places.size());
      m_places.push_back(Vec3d(cube) + Vec3d(0.5));
    }
    return vertex;
  }

  /// The face between a voxel and the next along an axis.
  void add_face(const Vec3i& voxel, int axis, int k, std::int64_t label, std::int64_t next) {
    if (label == next) return;
    Vec3i first(0), second(0);  // right-handed with the axis
    first[(axis + 1) % 3] = 1, second[(axis + 2) % 3] = 1;
    const NetFace quad = {vertex(voxel - first - second, k), vertex(voxel - second, k),
                          vertex(voxel, k), vertex(voxel - first, k)};
    if (label != 0) m_quads[label].push_back(quad);
    if (next != 0) m_quads[next].push_back({quad[0], quad[3], quad[2], quad[1]});
  }

  /// Faces inside slice k and to the one below it.
  void add_slice(int k, const std::vector<std::int64_t>& below,
                 const std::vector<std::int64_t>& above) {
    for (int j = -1; j <= m_dims.y; ++j) {
      for (int i = -1; i <= m_dims.x; ++i) {
        const std::int64_t label = above[at(i, j)];
        if (i < m_dims.x) add_face({i, j, k}, 0, k, label, above[at(i + 1, j)]);
        if (j < m_dims.y) add_face({i, j, k}, 1, k, label, above[at(i, j + 1)]);
        add_face({i, j, k - 1}, 2, k, below[at(i, j)], label);
      }
    }
  }

  Vec3i m_dims;
  const std::function<std::int64_t(const Vec3i& voxel)>& m_label_at;
  std::vector<int> m_vertices_below, m_vertices_above;  // of cubes; -1: none so far
  std::vector<Vec3d> m_places;                          // index frame
  std::map<std::int64_t, std::vector<NetFace>> m_quads;
};

}  // namespace

std::vector<LabelSurface> label_surfaces(
    const Geometry& geometry, const std::function<std::int64_t(const Vec3i& voxel)>& label_at) {
  SurfaceNet net(geometry, label_at);
  net.smooth();
  return net.surfaces(geometry);
}

}  // namespace supple

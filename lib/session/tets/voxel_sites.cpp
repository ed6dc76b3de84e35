#include "lib/session/tets/voxel_sites.h"

#include <algorithm>
#include <cmath>

#include "lib/fem/tet/tet_shape.h"
#include "lib/mesh/tets/element_voxels.h"

namespace supple {

namespace {

/// The largest weight of a corner: parts far from the mesh do not swing like long levers.
constexpr double kFarthest = 2;
/// Steps along each axis in which a node looks for an element.
constexpr int kSearch = 4;

using CornerWeights = std::array<double, 4>;

/// The weights of the corners of a tetrahedron at any place.
class TetWeights {
 public:
  TetWeights(const SolidMesh& mesh, std::size_t tet, const std::vector<Vec3d>& places) {
    const auto& t = mesh.tets[tet];
    const auto at = [&](std::size_t c) { return places[std::size_t(t[c])]; };
    m_from = at(0);
    m_shape = tet_shape(at(0), at(1), at(2), at(3));
  }
  CornerWeights operator()(const Vec3d& place) const {
    const Vec3d way = place - m_from;
    CornerWeights weights{};
    for (std::size_t c = 1; c < 4; ++c) weights[c] = m_shape.gradient[c].dot(way);
    weights[0] = 1 - weights[1] - weights[2] - weights[3];
    return weights;
  }

 private:
  Vec3d m_from;
  TetShape m_shape;
};

double least(const CornerWeights& weights) {
  return *std::min_element(weights.begin(), weights.end());
}

/// Weights that are too large are drawn towards the middle of the tetrahedron; their sum
/// stays 1.
VoxelSite site_of(std::int32_t tet, const CornerWeights& weights) {
  double part = 1;
  for (const double weight : weights) {
    if (weight > kFarthest) part = std::min(part, (kFarthest - 0.25) / (weight - 0.25));
    if (weight < 1 - kFarthest) part = std::min(part, (kFarthest - 0.75) / (0.25 - weight));
  }
  VoxelSite site{tet, {}};
  for (std::size_t c = 0; c < 4; ++c) {
    site.weight[c] = float(0.25 + part * (weights[c] - 0.25));
  }
  return site;
}

/// Voxels that no tetrahedron holds take those of their neighbours.
class Rings {
 public:
  Rings(const SolidMesh& mesh, const std::vector<Vec3d>& places, const BrickTopology& elements,
        const std::vector<std::int32_t>& numbers, const SiteChoice& admits,
        std::vector<VoxelSite>& sites)
      : m_mesh(mesh),
        m_places(places),
        m_elements(elements),
        m_numbers(numbers),
        m_admits(admits),
        m_sites(sites) {}

  /// Returns the number of voxels beyond the near rings.
  std::int64_t fill() {
    std::int64_t far = 0;
    std::vector<Vec3i> waiting;
    for_each_element(m_elements, [&](Slot slot) {
      if (m_sites[std::size_t(m_numbers[slot])].tet < 0) {
        waiting.push_back(voxel_of(m_elements, slot));
      }
    });
    std::size_t before = waiting.size() + 1;
    for (int ring = 1; !waiting.empty() && waiting.size() < before; ++ring) {
      before = waiting.size();
      std::vector<Vec3i> next;
      std::vector<std::pair<std::int32_t, VoxelSite>> found;
      for (const Vec3i& voxel : waiting) {
        if (const auto site = best_beside(voxel)) {
          found.emplace_back(number_at(voxel), *site);
        } else {
          next.push_back(voxel);
        }
      }
      for (const auto& [number, site] : found) m_sites[std::size_t(number)] = site;
      if (ring > kNearRings) far += std::int64_t(found.size());
      waiting = std::move(next);
    }
    return far;
  }

 private:
  std::int32_t number_at(const Vec3i& voxel) const {
    Slot slot;
    return slot_of(m_elements, voxel, slot) ? m_numbers[slot] : -1;
  }

  std::optional<VoxelSite> best_beside(const Vec3i& voxel) const {
    std::int32_t best = -1;
    Slot own = 0;
    slot_of(m_elements, voxel, own);
    CornerWeights of_best{};
    for (int n = 0; n < 27; ++n) {
      const std::int32_t number = number_at(voxel + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
      const std::int32_t tet = number < 0 ? -1 : m_sites[std::size_t(number)].tet;
      if (tet < 0 || tet == best || (m_admits && !m_admits(std::size_t(tet), own))) continue;
      const CornerWeights weights = TetWeights(m_mesh, std::size_t(tet), m_places)(Vec3d(voxel));
      if (best >= 0 && least(weights) <= least(of_best)) continue;
      best = tet;
      of_best = weights;
    }
    if (best < 0) return std::nullopt;
    return site_of(best, of_best);
  }

  const SolidMesh& m_mesh;
  const std::vector<Vec3d>& m_places;
  const BrickTopology& m_elements;
  const std::vector<std::int32_t>& m_numbers;
  const SiteChoice& m_admits;
  std::vector<VoxelSite>& m_sites;
};

}  // namespace

std::vector<std::int32_t> element_numbers(const BrickTopology& elements) {
  std::vector<std::int32_t> numbers(slot_count(elements), -1);
  std::int32_t count = 0;
  for_each_element(elements, [&](Slot slot) { numbers[slot] = count++; });
  return numbers;
}

std::vector<VoxelSite> voxel_sites(const SolidMesh& mesh, const Geometry& geometry,
                                   const BrickTopology& elements, const SiteChoice& admits,
                                   std::int64_t* far) {
  const std::vector<std::int32_t> numbers = element_numbers(elements);
  const std::vector<Vec3d> places = index_places(mesh, geometry);
  std::vector<VoxelSite> sites(std::size_t(elements.active_count()));
  for (std::size_t tet = 0; tet < mesh.tets.size(); ++tet) {
    const TetWeights weights(mesh, tet, places);
    for_each_voxel(mesh, tet, places, [&](const Vec3i& voxel) {
      Slot slot;
      if (!slot_of(elements, voxel, slot) || (admits && !admits(tet, slot))) return;
      VoxelSite& site = sites[std::size_t(numbers[slot])];
      if (site.tet < 0) site = site_of(std::int32_t(tet), weights(Vec3d(voxel)));
    });
  }
  std::int64_t beyond = Rings(mesh, places, elements, numbers, admits, sites).fill();
  if (admits) beyond += Rings(mesh, places, elements, numbers, {}, sites).fill();
  if (far != nullptr) *far = beyond;
  return sites;
}

std::optional<Slot> nearest_slot(const BrickTopology& elements, const Vec3d& index) {
  const Vec3i own = nearest_voxel(index);
  std::optional<Slot> best;
  double least = 0;
  for (int reach = 0; reach <= kSearch; ++reach) {
    // Voxels at `reach` are no nearer than that less a half.
    const double nearest = std::max(0.0, reach - 0.5);
    if (best && least <= nearest * nearest) break;
    for (int k = -reach; k <= reach; ++k) {
      for (int j = -reach; j <= reach; ++j) {
        const bool is_face = std::max(std::abs(k), std::abs(j)) == reach;
        for (int i = -reach; i <= reach; i += is_face || reach == 0 ? 1 : 2 * reach) {
          const Vec3i voxel = own + Vec3i(i, j, k);
          Slot slot;
          if (!slot_of(elements, voxel, slot)) continue;
          const Vec3d way = Vec3d(voxel) - index;
          if (best && way.dot(way) >= least) continue;
          best = slot;
          least = way.dot(way);
        }
      }
    }
  }
  if (least > (kSearch - 0.5) * (kSearch - 0.5)) best.reset();  // others may be nearer
  return best;
}

}  // namespace supple

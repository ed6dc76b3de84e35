#include "lib/session/tets/tet_grips.h"

#include <algorithm>
#include <map>

namespace supple {

namespace {

/// Offsets this near to their linear map, in voxels, are one.
constexpr double kNearlyLinear = 0.02;

/// Across a grip that is thin beyond this there is no slope.
constexpr double kThin = 1e-5;

/// The linear part of the motion of a grip, in voxels per voxel.
class GripSlope {
 public:
  GripSlope(const FemGrip& grip, const BrickTopology& elements) {
    Vec3d place(0), offset(0);
    const auto for_each = [&](auto&& visit) {
      std::size_t n = 0;
      grip.slots.for_each(
          [&](Slot slot) { visit(Vec3d(voxel_of(elements, slot)), grip.offsets[n++]); });
    };
    for_each([&](const Vec3d& x, const Vec3d& u) { place += x, offset += u; });
    const double count = double(grip.offsets.size());
    place /= count;
    offset /= count;
    std::array<Vec3d, 3> spread{Vec3d(0), Vec3d(0), Vec3d(0)},
        along = spread;  // rows of the sums of x x^T and u x^T
    for_each([&](const Vec3d& x, const Vec3d& u) {
      for (int a = 0; a < 3; ++a) {
        spread[std::size_t(a)] += (x - place) * (x[a] - place[a]);
        along[std::size_t(a)] += (x - place) * (u[a] - offset[a]);
      }
    });
    const double size = spread[0].x + spread[1].y + spread[2].z;
    if (size == 0) return;
    for (int a = 0; a < 3; ++a) spread[std::size_t(a)][a] += kThin * size;
    const Vec3d x = spread[1].cross(spread[2]), y = spread[2].cross(spread[0]),
                z = spread[0].cross(spread[1]);
    const double det = spread[0].dot(x);
    for (std::size_t a = 0; a < 3; ++a) {
      m_slope[a] = Vec3d(along[a].dot(x), along[a].dot(y), along[a].dot(z)) / det;
    }
    double largest = 0;
    for_each([&](const Vec3d& at, const Vec3d& u) {
      largest = std::max(largest, (u - offset - along_way(at - place)).length());
    });
    if (!(largest <= kNearlyLinear)) m_slope.fill(Vec3d(0));
  }

  Vec3d along_way(const Vec3d& way) const {
    return {m_slope[0].dot(way), m_slope[1].dot(way), m_slope[2].dot(way)};
  }

 private:
  std::array<Vec3d, 3> m_slope{Vec3d(0), Vec3d(0), Vec3d(0)};  // rows
};

/// Nodes by the element of the body nearest to them.
class NodesOfSlots {
 public:
  NodesOfSlots(const Body& body, const std::vector<Vec3d>& positions) {
    for (std::size_t n = 0; n < positions.size(); ++n) {
      const Vec3d index = body.geometry.index_from_world(positions[n]);
      m_index.push_back(index);
      if (const auto slot = nearest_slot(body.elements, index)) {
        m_nodes.emplace_back(*slot, NodeIndex(n));
      }
    }
    std::sort(m_nodes.begin(), m_nodes.end());
  }

  template <class Visit>
  void for_each(Slot slot, const Visit& visit) const {
    auto at = std::lower_bound(m_nodes.begin(), m_nodes.end(), std::pair(slot, NodeIndex(0)));
    for (; at != m_nodes.end() && at->first == slot; ++at) {
      visit(at->second, m_index[std::size_t(at->second)]);
    }
  }

 private:
  std::vector<Vec3d> m_index;
  std::vector<std::pair<Slot, NodeIndex>> m_nodes;
};

/// Corners for a grip without nodes; several elements share one in their mean.
TetHeld corners_of(const FemGrip& grip, const Body& body, const TetModel& model,
                   const std::vector<VoxelSite>& sites, const std::vector<std::int32_t>& numbers,
                   const std::vector<char>& is_taken) {
  std::map<NodeIndex, std::pair<Vec3d, int>> sums;
  std::size_t n = 0;
  grip.slots.for_each([&](Slot slot) {
    const Vec3d offset = grip.offsets[n++];
    const VoxelSite& site = sites[std::size_t(numbers[slot])];
    if (site.tet < 0) return;
    const NodeIndex* nodes = model.volumes().elements().nodes(std::size_t(site.tet));
    std::size_t best = 4;
    for (std::size_t c = 0; c < 4; ++c) {
      if (is_taken[std::size_t(nodes[c])] != 0) continue;
      if (best == 4 || site.weight[c] > site.weight[best]) best = c;
    }
    if (best == 4) return;
    auto& [sum, count] = sums.try_emplace(nodes[best], Vec3d(0), 0).first->second;
    sum += offset;
    ++count;
  });
  TetHeld held;
  for (const auto& [node, sum] : sums) {
    held.nodes.push_back(node);
    held.displacement_mm.push_back(
        body.geometry.world_vector_from_index(sum.first / double(sum.second)));
  }
  return held;
}

}  // namespace

std::vector<TetHeld> held_nodes(const std::vector<FemGrip>& grips, const Body& body,
                                const TetModel& model, const std::vector<VoxelSite>& sites) {
  const NodesOfSlots nodes(body, model.volumes().positions());
  std::vector<TetHeld> held(grips.size());
  std::vector<char> is_taken(model.place_count(), 0);
  for (std::size_t g = 0; g < grips.size(); ++g) {
    const GripSlope slope(grips[g], body.elements);
    std::size_t n = 0;
    grips[g].slots.for_each([&](Slot slot) {
      const Vec3d offset = grips[g].offsets[n++];
      nodes.for_each(slot, [&](NodeIndex node, const Vec3d& index) {
        const Vec3d way = index - Vec3d(voxel_of(body.elements, slot));
        held[g].nodes.push_back(node);
        held[g].displacement_mm.push_back(
            body.geometry.world_vector_from_index(offset + slope.along_way(way)));
        is_taken[std::size_t(node)] = 1;
      });
    });
  }
  const std::vector<std::int32_t> numbers = element_numbers(body.elements);
  for (std::size_t g = 0; g < grips.size(); ++g) {
    if (!held[g].nodes.empty()) continue;
    held[g] = corners_of(grips[g], body, model, sites, numbers, is_taken);
    for (const NodeIndex node : held[g].nodes) is_taken[std::size_t(node)] = 1;
    if (!held[g].nodes.empty()) continue;
    throw InputError({"", "tets",
                      "no node of the mesh for what is held at voxel " +
                          voxel_text(voxel_of(body.elements, grips[g].slots.first())),
                      "smaller tetrahedra, or larger handles and anchors"});
  }
  return held;
}

}  // namespace supple

#include "lib/mesh/tets/element_regions.h"

#include "lib/mesh/tets/element_voxels.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

using LabelVotes = std::map<std::int32_t, std::int64_t>;

/// Elements with fewer voxel centres are looked at in places within, too.
constexpr std::int64_t kFewVoxels = 12;

/// The label with the largest count; of several the preferred one, else the smallest.
std::int32_t most_frequent(const LabelVotes& counts, std::int32_t preferred = 0) {
  std::int32_t label = 0;
  std::int64_t most = 0;
  for (const auto& [candidate, count] : counts) {
    if (count < most || (count == most && candidate != preferred)) continue;
    most = count;
    label = candidate;
  }
  return label;
}

/// The mean of an element's corners.
Vec3d middle_of(const SolidMesh& mesh, std::size_t element, const std::vector<Vec3d>& places) {
  Vec3d sum(0);
  for_each_corner(mesh, element, [&](std::size_t node) { sum += places[node]; });
  return sum / (element < mesh.tets.size() ? 4 : 8);
}

/// Calls visit(place) for places that share an element evenly.
template <class Visit>
void for_each_place(const SolidMesh& mesh, std::size_t element, const std::vector<Vec3d>& places,
                    const Visit& visit) {
  const bool is_tet = element < mesh.tets.size();
  const auto corner = [&](std::size_t c) {
    const std::int32_t node =
        is_tet ? mesh.tets[element][c] : mesh.hexes[element - mesh.tets.size()][c];
    return places[std::size_t(node)];
  };
  const std::size_t corners = is_tet ? 4 : 8;
  const Vec3d middle = middle_of(mesh, element, places);
  visit(middle);
  for (std::size_t c = 0; c < corners; ++c) {
    visit((middle + corner(c)) / 2);  // weights 5, 1, 1, 1 of 8
    for (std::size_t d = c + 1; is_tet && d < corners; ++d) {
      visit(middle / 2 + (corner(c) + corner(d)) / 4);  // weights 3, 3, 1, 1 of 8
    }
  }
}

}  // namespace

std::map<std::int32_t, std::int64_t> voxels_of_labels(const VoxelMask& mask,
                                                      const VoxelLabel& label_of) {
  LabelVotes counts;
  const Vec3i dims = mask.dims();
  for (std::size_t n = 0; n < mask.inside.size(); ++n) {
    if (mask.inside[n] == 0) continue;
    const std::size_t row = n / std::size_t(dims.x);
    const Vec3i at(int(n % std::size_t(dims.x)), int(row % std::size_t(dims.y)),
                   int(row / std::size_t(dims.y)));
    ++counts[label_of(mask.box.lo + at)];
  }
  return counts;
}

void give_regions(SolidMesh& mesh, const VoxelMask& mask, const VoxelLabel& label_of) {
  const std::vector<Vec3d> places = index_places(mesh, mask.geometry);
  const std::int32_t otherwise = most_frequent(voxels_of_labels(mask, label_of));
  mesh.region_of.assign(mesh.element_count(), otherwise);
  parallel_for(mesh.element_count(), Grain{256}, [&](std::size_t e) {
    LabelVotes votes;
    std::int64_t count = 0;
    const auto add = [&](const Vec3i& voxel) {
      if (!mask.holds(voxel)) return;
      ++votes[label_of(voxel)];
      ++count;
    };
    for_each_voxel(mesh, e, places, add);
    if (count < kFewVoxels) {
      votes.clear();
      for_each_place(mesh, e, places, [&](const Vec3d& place) { add(nearest_voxel(place)); });
    }
    if (votes.empty()) return;
    const Vec3i middle = nearest_voxel(middle_of(mesh, e, places));
    const std::int32_t in_middle = mask.holds(middle) ? label_of(middle) : 0;
    mesh.region_of[e] = most_frequent(votes, in_middle);
  });
}

}  // namespace supple

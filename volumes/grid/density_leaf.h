// Bricks of a density grid to come, each in the memory in which the grid will hold it: densities
// are written once, before it is known which of them become active, and never copied.
// Cost: 2.1 kB per leaf.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "volumes/grid/density_grid.h"

namespace supple {

/// The 512 densities of a brick in brick order.
class DensityLeaf {
 public:
  /// No leaf.
  DensityLeaf() = default;
  /// The brick whose smallest voxel is `origin`, a multiple of 8. Its densities are unset.
  explicit DensityLeaf(const Vec3i& origin);

  explicit operator bool() const { return m_node != nullptr; }
  /// The densities of an existing leaf.
  float* values() const;
  /// Notes the extremes of the voxels that will be active: in passing, while the densities are in
  /// cache. assemble_density_grid() finds those that nobody noted.
  void note_extremes(const BrickMask& active) { m_extremes = find_extremes(values(), active); }

 private:
  friend DensityGrid assemble_density_grid(BrickTopology bricks,
                                           const std::function<DensityLeaf(std::size_t b)>& take,
                                           float background);
  struct Free {
    void operator()(void* node) const;
  };

  std::unique_ptr<void, Free> m_node;  // an openvdb::FloatTree::LeafNodeType
  std::optional<BrickExtremes> m_extremes;
};

/// The grid of these bricks. `take(b)` hands over the leaf of each, once and from several threads;
/// its inactive voxels become the background here.
DensityGrid assemble_density_grid(BrickTopology bricks,
                                  const std::function<DensityLeaf(std::size_t b)>& take,
                                  float background);

}  // namespace supple

// Grids of OpenVDB files: io::Stream over an fstream that throws, never delayed, since OpenVDB 10's
// io::File loses errors on full disks and truncated files. Heavy: include only where grids are
// created, read or written.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "volumes/base/atomic_file.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_topology.h"
#include "volumes/grid/vdb_grid.h"

namespace supple {

inline openvdb::Coord to_coord(const Vec3i& v) {
  return {v.x, v.y, v.z};
}
inline Vec3i to_vec(const openvdb::Coord& c) {
  return {c.x(), c.y(), c.z()};
}

/// A grid with one leaf per brick; `fill(leaf, b)` switches voxels on. Leaves without any are
/// dropped.
template <class Grid, class Fill>
typename Grid::Ptr make_vdb_grid(const char* name, const BrickTopology& bricks,
                                 const typename Grid::ValueType& background, Fill&& fill) {
  using Leaf = typename Grid::TreeType::LeafNodeType;
  std::vector<std::unique_ptr<Leaf>> leaves(bricks.brick_count());
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t b) {
    auto leaf = std::make_unique<Leaf>(to_coord(bricks.origin(b)), background);
    fill(*leaf, b);
    if (!leaf->isEmpty()) leaves[b] = std::move(leaf);
  });
  auto grid = make_grid<Grid>(background);
  grid->setName(name);
  for (auto& leaf : leaves) {
    if (leaf) grid->tree().addLeaf(leaf.release());
  }
  return grid;
}

/// Attaches the affine to LPS mm; a geometry that OpenVDB refuses (tiny voxels) stays in index
/// space.
void attach_affine(openvdb::GridBase& grid, const Geometry& geometry);

/// Writes a complete stream to the temporary name. Throws SystemError.
void write_vdb_stream(const AtomicFile& file, const openvdb::GridCPtrVec& grids,
                      const openvdb::MetaMap& metadata);

struct VdbContent {
  openvdb::GridPtrVec grids;
  openvdb::MetaMap metadata;
};

/// Whether a seal vouches for the file, which is then decoded on all threads, or it may hold
/// anything and is read from one end to the other.
enum class VdbTrust { sealed, foreign };

/// The grids before the first one whose name `stops`; those after it are not decoded.
/// Throws InputError with OpenVDB's message clamped, or as InputFile does; SystemError: not enough
/// memory.
VdbContent read_vdb_grids(const std::string& path, VdbTrust trust,
                          const std::function<bool(const std::string& name)>& stops);

}  // namespace supple

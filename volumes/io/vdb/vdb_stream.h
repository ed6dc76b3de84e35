// Grids of OpenVDB files: io::Stream over an fstream that throws, never delayed, since OpenVDB 10's
// io::File loses errors on full disks and truncated files. Heavy: include only where grids are
// created, read or written.
#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "volumes/base/atomic_file.h"
#include "volumes/base/parallel.h"
#include "volumes/base/progress.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_topology.h"
#include "volumes/grid/density_grid_vdb.h"

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
  parallel_for(leaves.size(), [&](std::size_t b) {
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

/// A grid on its way into a file. Where `write_leaves` is given, the leaves of the grid have masks
/// and no values: these are made one leaf after the other while the file is written.
struct OutgoingGrid {
  openvdb::GridBase::Ptr grid;
  std::function<void(std::ostream&)> write_leaves;
};

/// Makes a grid as make_vdb_grid() does, to be written and not read: `fill(leaf, b)` is asked for
/// the values of all active voxels of a brick when its leaf is written, by one thread. `bricks` and
/// all that `fill` refers to have to last until then. Cost: some 150 bytes per brick.
template <class Grid, class Fill>
OutgoingGrid make_outgoing_grid(const char* name, const BrickTopology& bricks,
                                const typename Grid::ValueType& background, Fill fill) {
  using Leaf = typename Grid::TreeType::LeafNodeType;
  auto grid = make_grid<Grid>(background);
  grid->setName(name);
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    if (mask_count(bricks.mask(b)) == 0) continue;
    auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), to_coord(bricks.origin(b)),
                                       background, false);
    for (int word = 0; word < 8; ++word) {
      leaf->getValueMask().template getWord<openvdb::Index64>(openvdb::Index(word)) =
          bricks.mask(b)[std::size_t(word)];
    }
    grid->tree().addLeaf(leaf.release());
  }
  const Grid* const made = grid.get();
  const auto write = [=, &bricks](std::ostream& out) {
    for (auto place = made->tree().cbeginLeaf(); place; ++place) {
      Leaf leaf(place->origin(), background);
      fill(leaf, std::size_t(bricks.find(to_vec(place->origin()))));
      leaf.writeBuffers(out, made->saveFloatAsHalf());
    }
  };
  return {std::move(grid), write};
}

/// Attaches the affine to LPS mm; a geometry that OpenVDB refuses (tiny voxels) stays in index
/// space.
void attach_affine(openvdb::GridBase& grid, const Geometry& geometry);

/// Writes a complete stream to the temporary name. Throws SystemError, and Cancelled within a
/// megabyte.
void write_vdb_stream(const AtomicFile& file, const std::vector<OutgoingGrid>& grids,
                      const openvdb::MetaMap& metadata, const Progress* progress = nullptr);

struct VdbContent {
  openvdb::GridPtrVec grids;
  openvdb::MetaMap metadata;
};

/// Trust in a file: a seal vouches for it, and it is decoded on all threads, or it may hold
/// anything and is read from one end to the other.
enum class VdbTrust { sealed, foreign };

/// The grids before the first one whose name `stops`; those after it are not decoded.
/// Throws InputError with OpenVDB's message clamped, or as InputFile does; SystemError: not enough
/// memory.
VdbContent read_vdb_grids(const std::string& path, VdbTrust trust,
                          const std::function<bool(const std::string& name)>& stops);

/// The metadata of a file without its grids. Throws as read_vdb_grids().
openvdb::MetaMap read_vdb_metadata(const std::string& path);

}  // namespace supple

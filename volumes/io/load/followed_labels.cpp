#include "volumes/io/load/followed_labels.h"

#include <algorithm>

#include "volumes/base/parallel.h"
#include "volumes/field/dense/grid_positions.h"

namespace supple {

namespace {

/// `find(i, j, k, place)`: LPS mm of the place whose label a voxel takes; false for none.
template <class Find>
LabelSliceSource found_labels(const StoredLabels& labels, const Vec3i& dims, Find find) {
  return [&labels, dims, find = std::move(find)](int k, char* out) {
    const std::size_t bytes = std::size_t(labels.bytes_per_voxel());
    std::fill(out, out + std::size_t(dims.x) * std::size_t(dims.y) * bytes, char(0));
    parallel_for(dims.y, [&](int j) {
      for (int i = 0; i < dims.x; ++i) {
        Vec3d place;
        if (!find(i, j, k, place)) continue;
        labels.nearest(place,
                       out + (std::size_t(j) * std::size_t(dims.x) + std::size_t(i)) * bytes);
      }
    });
  };
}

}  // namespace

LabelSliceSource followed_labels(const StoredLabels& labels, const OffsetField& offsets,
                                 const Geometry& grid) {
  const GridPositions positions(grid, offsets.geometry);
  return found_labels(labels, grid.dims(),
                      [&offsets, positions](int i, int j, int k, Vec3d& place) {
                        Vec3d source;
                        if (!offsets.source_of(positions.at(i, j, k), source)) return false;
                        place = offsets.geometry.world_from_index(source);
                        return true;
                      });
}

LabelSliceSource followed_labels(const StoredLabels& labels, const PointMotion& motion,
                                 const Geometry& grid, std::atomic<std::int64_t>& unresolved) {
  const auto find = [&motion, &unresolved, grid](int i, int j, int k, Vec3d& place) {
    const MovedPoint moved = motion.move(grid.world_from_index(Vec3d(i, j, k)));
    place = moved.to_lps_mm;
    if (moved.kind == PlaceKind::unresolved) ++unresolved;
    return moved.kind != PlaceKind::unresolved && moved.kind != PlaceKind::outside;
  };
  return found_labels(labels, grid.dims(), find);
}

}  // namespace supple

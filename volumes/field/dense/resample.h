// From the sparse offset field to dense grids: warp export and the resampled volume.
//
// Everything is produced slice by slice, so that the memory of an export does not grow with the
// grid. Arguments by reference must outlive the returned source. A grid point within 1e-6 voxel of
// a source voxel takes that voxel's offset exactly. One thread at a time may ask for a slice;
// offsets on the source's own lattice are cheap in ascending order. Cost per voxel and core: 5 ns
// there, 20 to 100 ns on other grids and in the void.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/field/offset_field.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/density_grid.h"

namespace supple {

// Dense slices of a sparse vector field at the voxels of its own lattice. A brick keeps its vectors
// with k fastest, a slice wants i fastest: slabs of eight slices are turned at a time, so that
// every vector is read from memory once. Memory: eight slices. Cost: about 3 ns per voxel and core.

class VectorSlabs {
 public:
  /// Slices of the box of voxels `first` … `first` + `dims` - 1. Bricks whose origin `leaves_out`
  /// are invalid throughout. `field` must outlive this.
  VectorSlabs(const VectorBricks& field, const Vec3i& first, const Vec3i& dims,
              std::function<bool(const Vec3i& origin)> leaves_out);

  /// The vectors of slice k of the box, dims.x * dims.y of them, i fastest; x is NaN where the
  /// field is invalid. Valid until the next call. Cheap when asked for in order.
  const Vec3f* slice(int k);

 private:
  void turn(int slab);
  void turn_brick(const Vec3i& origin);

  const VectorBricks& m_field;
  Vec3i m_first, m_dims;
  std::function<bool(const Vec3i& origin)> m_leaves_out;
  int m_slab;                   // in bricks along k; where the box begins: none yet
  std::vector<Vec3f> m_slices;  // eight
};

/// Writes the vectors of slice k, dims.x * dims.y of them, i fastest, in mm, LPS.
using VectorSliceSource = std::function<void(int k, Vec3f* out)>;
/// Writes the densities of slice k.
using ScalarSliceSource = std::function<void(int k, float* out)>;

/// The resample-direction field on `grid` (the source grid, or another one). `source` holds the
/// elements and shell at rest: voxels that are active there and not reached any more are vacated.
/// Nearest in mm along the axes; where the source box holds no void voxel the vector is 0. Vectors
/// are the world position of the source point minus that of the grid point. `elements`: with
/// `extend`, grid points that read others are air and give way where cells would fold
/// (unfolded_extension.h).
VectorSliceSource dense_offsets(const OffsetField& offsets, const BrickTopology& source,
                                const Geometry& grid, VoidMode mode,
                                const BrickTopology* elements = nullptr);

/// The material-direction field on the source grid: extended u, 0 where nothing is.
VectorSliceSource dense_displacement(const Displacement& extended);

/// Results of those two on the source's own grid, dense_offsets() with VoidMode::nearest, that are
/// not 0: vectors in mm LPS of the voxels of the bricks that move, and of those that tissue left.
/// None where offsets jump, which only positions tell, or where so much moves that slices need less
/// memory. Cost: 12 bytes per voxel of those bricks.
std::optional<VectorBricks> sparse_offsets(const OffsetField& offsets, const BrickTopology& source);
std::optional<VectorBricks> sparse_displacement(const Displacement& extended);

/// A density at a place of the source's index frame.
using SourceDensity = std::function<float(const Vec3d& index)>;
/// The deformed volume on `grid`: the density at x + o(x); void reads `fill`.
ScalarSliceSource dense_resampled(const OffsetField& offsets, const SourceDensity& density,
                                  const Geometry& grid, float fill);
/// The same with trilinear densities.
ScalarSliceSource dense_resampled(const OffsetField& offsets, const DensityGrid& density,
                                  const Geometry& grid, float fill);

/// Voxels X of the material whose place X + u(X) lies beyond the outer voxel faces of `grid`, which
/// a dense output would lose. Takes u on the elements, not extended into the air.
std::int64_t count_outside(const Displacement& material, const Geometry& grid);

/// The source grid grown by `margin_mm` on every side (whole voxels, same affine).
Geometry with_margin(const Geometry& geometry, double margin_mm);

}  // namespace supple

// Peers of the sampling benchmark: trilinear densities along lines through other libraries' grids,
// straight or through an offset grid, as a ray marcher built on them would read them.
#pragma once

#include <memory>

#include "volumes/field/offset_field.h"
#include "volumes/grid/density_grid.h"

namespace supple {

class LineSampler {
 public:
  virtual ~LineSampler() = default;
  /// Sum of the densities at first + n * step + o(first + n * step), n = 0 … count - 1, index
  /// space.
  virtual double sum(const Vec3d& first, const Vec3d& step, int count) = 0;
};

/// openvdb::tools::BoxSampler with accessors. `offsets` may be null.
std::unique_ptr<LineSampler> openvdb_line_sampler(const DensityGrid& density,
                                                  const VectorBricks* offsets);
/// NanoVDB's trilinear sampler, which remembers its cell, on the same grids.
std::unique_ptr<LineSampler> nanovdb_line_sampler(const DensityGrid& density,
                                                  const VectorBricks* offsets);

}  // namespace supple

// A scanned volume: sparse densities, geometry, and the statistics and warnings of its reading.
#pragma once

#include <cstdint>
#include <string>

#include "volumes/geometry/geometry.h"
#include "volumes/grid/density_grid.h"

namespace supple {

/// Facts about a file's values, gathered in the one pass that reads them.
struct VolumeStatistics {
  double min = 0;  // after slope and intercept, NaN left out
  double max = 0;
  double mean = 0;
  std::int64_t nan_count = 0;
  std::int64_t infinite_count = 0;   // values that overflow a float included
  std::int64_t above_min_count = 0;  // voxels with a value > min
};

/// True if densities that reach down to `lowest` are Hounsfield units: air lies at -1000 HU.
inline bool are_hounsfield_units(double lowest) {
  return lowest < -200;
}

/// "3 NaN voxels and 1 infinite voxel"; empty where there are neither. They are void.
std::string void_values_text(const VolumeStatistics& statistics);

struct Volume {
  Geometry geometry;
  DensityGrid density;          // index space, active voxels as asked for when loading
  VolumeStatistics statistics;  // of the whole file
  std::string format;           // "nrrd", "metaimage", "nifti", "png", "tiff", "raw", "vdb"
  std::string value_type;  // numpy name: the stored type, float32 when slope or intercept apply
};

/// Trilinear density at an index-space position; corners that are inactive count as `outside`.
float sample_trilinear(const DensityGrid& grid, const Vec3d& pos_index, float outside);

}  // namespace supple

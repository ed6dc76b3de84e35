// From slices to sparse bricks: memory holds the active voxels and a few slices, never the box.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/grid/density_grid.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

/// Values that `supple info` prints beyond the header.
struct VolumeDigest {
  VolumeStatistics statistics;
  std::string sha256;             // of the stored values, little-endian, i fastest, before slope
  std::int64_t sparse_bytes = 0;  // of load_volume's grid, counted without building it
  std::int64_t bricks = 0;        // of the same
};
VolumeDigest digest_volume(VolumeFile& file, Progress* progress = nullptr);

/// Densities in bins of equal width from the least to the largest, which one pass has found before.
std::vector<std::int64_t> histogram(VolumeFile& file, const VolumeStatistics& statistics, int bins,
                                    Progress* progress = nullptr);

/// Every voxel above the file's minimum becomes active; background is the minimum. NaN, infinity
/// and values that overflow a float are void (statistics.nan_count). Comparisons are those of
/// floats.
Volume load_volume(const std::string& path, const ReadOptions& options = {},
                   Progress* progress = nullptr);
/// The same from an open file of which no slice was read yet.
Volume load_volume(VolumeFile& file, Progress* progress = nullptr);

/// Voxels of the file with a density within [lo, hi], counted on the way.
struct CountedRange {
  double lo, hi;
  std::int64_t voxels = 0;
};

/// Densities within [lo, hi] become elements; `rings` further voxels around them (Chebyshev, inside
/// the box, not NaN; 0 to 8) are kept as the shell of design "The air". Background is the file's
/// minimum.
struct ElementVolume {
  Volume volume;           // active: elements and shell
  BrickTopology elements;  // active: elements
};
/// `components` > 0 keeps that many largest face-connected pieces of the elements; 0 keeps all.
/// Throws InputError when no voxel lies in the range.
ElementVolume load_elements(const std::string& path, const ReadOptions& options, double lo,
                            double hi, int components, int rings = 2, Progress* progress = nullptr);
ElementVolume load_elements(VolumeFile& file, double lo, double hi, int components, int rings = 2,
                            Progress* progress = nullptr,
                            std::vector<CountedRange>* counted = nullptr);

}  // namespace supple

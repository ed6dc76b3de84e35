// Bricks that a volume will fill, counted in slabs here and there before it is read as a whole.
// Slabs lie in strata of equal depth, at places that no period of the body follows. Cost: the
// slabs that are read, about 1 ns per voxel and core; where values are encoded, all before them are
// decoded.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "volumes/base/progress.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

/// Contents of the slabs that were read so far.
struct BrickSample {
  std::int64_t bricks = 0, elements = 0;  // bricks that hold elements
  int slabs = 0, slabs_read = 0;          // of the volume, and of these

  /// The part of the volume that was read.
  double part() const { return slabs == 0 ? 1 : double(slabs_read) / slabs; }
};

/// Counts the voxels with a density within `range`; without one, those above the lowest density up
/// to their slab: no more than are above the lowest of all. Reads at most `most_slabs` slabs, and
/// none after one after which `is_enough`. No slice of the file may have been read yet.
BrickSample sample_bricks(VolumeFile& file, const std::optional<std::pair<double, double>>& range,
                          int most_slabs, const std::function<bool(const BrickSample&)>& is_enough,
                          Progress* progress = nullptr);

}  // namespace supple

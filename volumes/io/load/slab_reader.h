// Eight slices of a volume at a time, as floats after slope and intercept, with the statistics of
// everything read so far. Slabs are as thick as bricks, so that bricks fill from single slabs.
// While one is worked on, a thread of its own reads the next. Cost: sixteen stored slices and eight
// of floats, whatever the volume's length.
#pragma once

#include <future>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/base/sha256.h"
#include "volumes/grid/density_grid.h"
#include "volumes/io/load/slice_values.h"

namespace supple {

/// Slices k0 … k0 + depth - 1, i fastest. Values that are not finite as floats are NaN here: void.
struct Slab {
  int k0 = 0;
  int depth = 0;
  Vec3i dims{0, 0, 0};  // of the volume
  std::vector<float> values;

  int bricks_x() const { return (dims.x + kBrickDim - 1) / kBrickDim; }
  int bricks_y() const { return (dims.y + kBrickDim - 1) / kBrickDim; }
  Vec3i brick_origin(int bi, int bj) const { return {bi * kBrickDim, bj * kBrickDim, k0}; }
  /// The values of row j in slice k0 + k.
  const float* row(int j, int k) const {
    return values.data() + (std::size_t(k) * dims.y + j) * dims.x;
  }
  /// The brick's values in brick order; NaN outside the volume.
  void gather(int bi, int bj, float* out) const;
};

class SlabReader {
 public:
  /// `hash`, where given, is fed the stored values.
  explicit SlabReader(VolumeFile& file, Progress* progress = nullptr, Sha256* hash = nullptr);

  /// Reads the next slab, into the same memory again; false when all slabs were read.
  bool next(Slab& slab);

  VolumeStatistics statistics() const;

 private:
  void read(int k0, std::vector<char>& stored);
  void fetch(int k0);

  VolumeFile& m_file;
  Progress* m_progress;
  Sha256* m_hash;
  std::size_t m_slice_values, m_slice_bytes;
  std::vector<char> m_stored, m_stored_ahead;
  int m_next_k = 0;
  SliceStatistics m_statistics;
  std::future<void> m_reading_ahead;  // into m_stored_ahead; ends before that is gone
};

}  // namespace supple

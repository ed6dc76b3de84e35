// Facts about a whole file in one pass. The memory of the sparse grid is counted, not built: it
// depends on which bricks hold a voxel above the minimum, and the largest density of every brick
// tells that once the minimum is known. Cost: one slab, and 4 bytes per brick of the box.
#include <algorithm>
#include <cmath>
#include <limits>

#include "volumes/io/load/load.h"
#include "volumes/io/load/slab_reader.h"

namespace supple {

namespace {

/// Largest density of every brick, in the order of reading; -inf without a finite voxel.
void append_brick_maxima(const Slab& slab, std::vector<float>& maxima) {
  const std::size_t first = maxima.size();
  const int across = slab.bricks_x();
  maxima.resize(first + std::size_t(across) * slab.bricks_y(),
                -std::numeric_limits<float>::infinity());
  const float* row = slab.values.data();
  for (int k = 0; k < slab.depth; ++k) {
    for (int j = 0; j < slab.dims.y; ++j, row += slab.dims.x) {
      float* line = maxima.data() + first + std::size_t(j / kBrickDim) * across;
      for (int i = 0; i < slab.dims.x; ++i) {
        // A NaN compares false and leaves the maximum alone.
        if (row[i] > line[i / kBrickDim]) line[i / kBrickDim] = row[i];
      }
    }
  }
}

BrickTopology bricks_above(const std::vector<float>& maxima, const Vec3i& dims, float threshold) {
  Slab shape;
  shape.dims = dims;
  BrickMask full;
  full.fill(~std::uint64_t(0));
  std::vector<Vec3i> origins;
  const std::size_t across = std::size_t(shape.bricks_x()), slab = across * shape.bricks_y();
  for (std::size_t n = 0; n < maxima.size(); ++n) {
    if (!(maxima[n] > threshold)) continue;
    origins.emplace_back(int(n % across) * kBrickDim, int(n % slab / across) * kBrickDim,
                         int(n / slab) * kBrickDim);
  }
  std::vector<BrickMask> masks(origins.size(), full);
  return {std::move(origins), std::move(masks)};
}

}  // namespace

VolumeDigest digest_volume(VolumeFile& file, Progress* progress) {
  Sha256 hash;
  SlabReader reader(file, progress, &hash);
  Slab slab;
  std::vector<float> maxima;
  while (reader.next(slab)) append_brick_maxima(slab, maxima);
  VolumeDigest digest;
  digest.statistics = reader.statistics();
  digest.sha256 = hash.hex();
  const BrickTopology occupied =
      bricks_above(maxima, file.header().geometry.dims(), float(digest.statistics.min));
  digest.sparse_bytes = std::int64_t(density_grid_bytes(occupied));
  digest.bricks = std::int64_t(occupied.brick_count());
  return digest;
}

std::vector<std::int64_t> histogram(VolumeFile& file, const VolumeStatistics& statistics, int bins,
                                    Progress* progress) {
  SlabReader reader(file, progress);
  Slab slab;
  std::vector<std::int64_t> counts(std::size_t(bins), 0);
  const double range = statistics.max - statistics.min;
  const double scale = range > 0 ? bins / range : 0;
  while (reader.next(slab)) {
    for (const float value : slab.values) {
      if (std::isnan(value)) continue;
      const int bin = int((double(value) - statistics.min) * scale);
      ++counts[std::size_t(std::clamp(bin, 0, bins - 1))];
    }
  }
  return counts;
}

}  // namespace supple

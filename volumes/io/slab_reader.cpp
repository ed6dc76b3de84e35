#include "volumes/io/slab_reader.h"

#include <algorithm>
#include <array>
#include <limits>

#include <tbb/parallel_for.h>

#include "volumes/io/formats.h"

namespace supple {

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

void Slab::gather(int bi, int bj, float* out) const {
  const Vec3i origin = brick_origin(bi, bj);
  const int width = std::min(kBrickDim, dims.x - origin.x);
  const int height = std::min(kBrickDim, dims.y - origin.y);
  if (width < kBrickDim || height < kBrickDim || depth < kBrickDim) {
    std::fill(out, out + kBrickVoxels, kNaN);
  }
  for (int k = 0; k < depth; ++k) {
    for (int j = 0; j < height; ++j) {
      const float* row =
          values.data() + (std::size_t(k) * dims.y + origin.y + j) * dims.x + origin.x;
      for (int i = 0; i < width; ++i) out[(i << 6) | (j << 3) | k] = row[i];
    }
  }
}

SlabReader::SlabReader(VolumeFile& file, Progress* progress, Sha256* hash)
    : m_file(file), m_progress(progress), m_hash(hash) {
  const VolumeHeader& header = file.header();
  require_scalars(header);
  const Vec3i& dims = header.geometry.dims();
  m_slice_values = std::size_t(dims.x) * dims.y;
  m_slice_bytes = m_slice_values * bytes_of(header.type);
  m_stored.resize(m_slice_bytes * std::min(kBrickDim, dims.z));
  if (m_progress != nullptr) m_progress->stage("reading");
}

bool SlabReader::next(Slab& slab) {
  const VolumeHeader& header = m_file.header();
  const Vec3i& dims = header.geometry.dims();
  if (m_next_k >= dims.z) return false;
  report(m_progress, double(m_next_k) / dims.z);
  slab.k0 = m_next_k;
  slab.depth = std::min(kBrickDim, dims.z - m_next_k);
  slab.dims = dims;
  slab.values.resize(m_slice_values * slab.depth);
  for (int k = 0; k < slab.depth; ++k) m_file.read_slice(&m_stored[m_slice_bytes * k]);
  if (m_hash != nullptr) m_hash->update(m_stored.data(), m_slice_bytes * slab.depth);

  std::array<SliceStatistics, kBrickDim> found;
  tbb::parallel_for(0, slab.depth, [&](int k) {
    found[k] = densities_of(header, &m_stored[m_slice_bytes * k], m_slice_values,
                            &slab.values[m_slice_values * k]);
  });
  for (int k = 0; k < slab.depth; ++k) m_statistics.append(found[k]);
  m_next_k += slab.depth;
  if (m_next_k == dims.z) report(m_progress, 1.0);
  return true;
}

VolumeStatistics SlabReader::statistics() const {
  VolumeStatistics statistics;
  statistics.nan_count = m_statistics.void_count;
  if (m_statistics.finite_count == 0) return statistics;
  statistics.min = m_statistics.min;
  statistics.max = m_statistics.max;
  statistics.mean = m_statistics.sum / double(m_statistics.finite_count);
  statistics.above_min_count = m_statistics.finite_count - m_statistics.min_count;
  return statistics;
}

}  // namespace supple

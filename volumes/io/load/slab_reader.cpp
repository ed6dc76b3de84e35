#include "volumes/io/load/slab_reader.h"

#include <algorithm>
#include <array>
#include <limits>

#include "volumes/base/parallel.h"
#include "volumes/io/format/formats.h"

namespace supple {

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

void Slab::gather(int bi, int bj, float* out) const {
  const Vec3i origin = brick_origin(bi, bj);
  const int width = std::min(kBrickDim, dims.x - origin.x);
  const int height = std::min(kBrickDim, dims.y - origin.y);
  const auto copy = [&](int di, int dj, int dk) {
    for (int k = 0; k < dk; ++k) {
      for (int j = 0; j < dj; ++j) {
        const float* from = row(origin.y + j, k) + origin.x;
        for (int i = 0; i < di; ++i) out[(i << 6) | (j << 3) | k] = from[i];
      }
    }
  };
  // Constant counts let the compiler unroll the loops.
  if (width == kBrickDim && height == kBrickDim && depth == kBrickDim) {
    copy(kBrickDim, kBrickDim, kBrickDim);
  } else {
    std::fill(out, out + kBrickVoxels, kNaN);
    copy(width, height, depth);
  }
}

SlabReader::SlabReader(VolumeFile& file, Progress* progress, Sha256* hash)
    : m_file(file), m_progress(progress), m_hash(hash) {
  const VolumeHeader& header = file.header();
  require_scalars(header);
  const Vec3i& dims = header.geometry.dims();
  m_slice_values = std::size_t(dims.x) * dims.y;
  m_slice_bytes = m_slice_values * bytes_of(header.type);
  if (m_progress != nullptr) m_progress->stage("reading");
}

/// Reads the slab that begins at slice k0.
void SlabReader::read(int k0, std::vector<char>& stored) {
  const int depth = std::min(kBrickDim, m_file.header().geometry.dims().z - k0);
  stored.resize(m_slice_bytes * depth);
  for (int k = 0; k < depth; ++k) m_file.read_slice(&stored[m_slice_bytes * k]);
}

/// Takes the slab that begins at slice k0 into m_stored, and has the one behind it read meanwhile.
void SlabReader::fetch(int k0) {
  if (m_reading_ahead.valid()) {
    m_reading_ahead.get();
    std::swap(m_stored, m_stored_ahead);
  } else {
    read(k0, m_stored);
  }
  const int next_k = k0 + kBrickDim;
  if (next_k >= m_file.header().geometry.dims().z) return;
  // Without a free thread the library reads in get().
  m_reading_ahead = std::async([this, next_k] { read(next_k, m_stored_ahead); });
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
  fetch(slab.k0);
  if (m_hash != nullptr) m_hash->update(m_stored.data(), m_slice_bytes * slab.depth);

  std::array<SliceStatistics, kBrickDim> found;
  parallel_for(slab.depth, [&](int k) {
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
  statistics.nan_count = m_statistics.nan_count;
  statistics.infinite_count = m_statistics.infinite_count;
  if (m_statistics.finite_count == 0) return statistics;
  statistics.min = m_statistics.min;
  statistics.max = m_statistics.max;
  statistics.mean = m_statistics.sum / double(m_statistics.finite_count);
  statistics.above_min_count = m_statistics.finite_count - m_statistics.min_count;
  return statistics;
}

}  // namespace supple

#include "volumes/io/slab_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volumes/io/formats.h"
#include "volumes/io/stored_values.h"

namespace supple {

namespace {

constexpr std::size_t kBlock = 1024;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct BlockStatistics {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  double sum = 0;
  std::size_t finite = 0;
  std::size_t at_min = 0;
};

/// Sums run in eight lanes, which the compiler turns into vectors, in a fixed order.
BlockStatistics statistics_of(const double* values, std::size_t count, float* out) {
  constexpr std::size_t kLanes = 8;
  BlockStatistics block;
  double sums[kLanes] = {};
  for (std::size_t n = 0; n < count; ++n) {
    const float density = float(values[n]);
    const bool finite = std::abs(density) <= std::numeric_limits<float>::max();
    out[n] = finite ? density : kNaN;
    sums[n % kLanes] += finite ? values[n] : 0.0;
    block.finite += finite;
    block.min = finite && values[n] < block.min ? values[n] : block.min;
    block.max = finite && values[n] > block.max ? values[n] : block.max;
  }
  for (const double sum : sums) block.sum += sum;
  block.at_min = std::size_t(std::count(values, values + count, block.min));
  return block;
}

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
    : m_file(file),
      m_progress(progress),
      m_hash(hash),
      m_min(std::numeric_limits<double>::infinity()),
      m_max(-m_min) {
  const VolumeHeader& header = file.header();
  require_scalars(header);
  const Vec3i& dims = header.geometry.dims();
  m_stored.resize(std::size_t(dims.x) * dims.y * bytes_of(header.type));
  if (m_progress != nullptr) m_progress->stage("reading");
}

bool SlabReader::next(Slab& slab) {
  const Vec3i& dims = m_file.header().geometry.dims();
  if (m_next_k >= dims.z) return false;
  report(m_progress, double(m_next_k) / dims.z);
  const std::size_t slice_values = std::size_t(dims.x) * dims.y;
  slab.k0 = m_next_k;
  slab.depth = std::min(kBrickDim, dims.z - m_next_k);
  slab.dims = dims;
  slab.values.resize(slice_values * slab.depth);
  for (int k = 0; k < slab.depth; ++k) {
    m_file.read_slice(m_stored.data());
    if (m_hash != nullptr) m_hash->update(m_stored.data(), m_stored.size());
    convert_slice(slab.values.data() + slice_values * k);
  }
  m_next_k += slab.depth;
  if (m_next_k == dims.z) report(m_progress, 1.0);
  return true;
}

void SlabReader::convert_slice(float* out) {
  const VolumeHeader& header = m_file.header();
  const ScaleValues scale = scale_values_of(header.type);
  const std::size_t width = std::size_t(bytes_of(header.type));
  const std::size_t total = m_stored.size() / width;
  double values[kBlock];
  for (std::size_t start = 0; start < total; start += kBlock) {
    const std::size_t count = std::min(kBlock, total - start);
    scale(m_stored.data() + start * width, count, header.slope, header.intercept, values);
    const BlockStatistics block = statistics_of(values, count, out + start);
    m_void_count += std::int64_t(count - block.finite);
    if (block.finite == 0) continue;
    m_finite_count += std::int64_t(block.finite);
    m_sum += block.sum;
    m_max = std::max(m_max, block.max);
    if (block.min < m_min) m_min_count = 0;
    m_min = std::min(m_min, block.min);
    if (block.min == m_min) m_min_count += std::int64_t(block.at_min);
  }
}

VolumeStatistics SlabReader::statistics() const {
  VolumeStatistics statistics;
  statistics.nan_count = m_void_count;
  if (m_finite_count == 0) return statistics;
  statistics.min = m_min;
  statistics.max = m_max;
  statistics.mean = m_sum / double(m_finite_count);
  statistics.above_min_count = m_finite_count - m_min_count;
  return statistics;
}

}  // namespace supple

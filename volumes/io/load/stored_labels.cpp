#include "volumes/io/load/stored_labels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "volumes/io/bytes/text_header.h"
#include "volumes/io/bytes/value_type.h"

namespace supple {

namespace {

constexpr int kBlockDim = 8;
constexpr std::size_t kBlockVoxels = kBlockDim * kBlockDim * kBlockDim;
// Places this much above the middle between two voxels still count as the middle.
constexpr double kHalf = 0.5 + 1e-6;

bool is_float(ValueType type) {
  return type == ValueType::float32 || type == ValueType::float64;
}

}  // namespace

void count_labels(ValueType type, const void* stored, std::size_t count, LabelCounts& counts) {
  std::vector<double> values(count);
  scale_values_of(type)(static_cast<const char*>(stored), count, 1, 0, values.data());
  for (std::size_t begin = 0; begin < count;) {
    std::size_t end = begin + 1;
    while (end < count && values[end] == values[begin]) ++end;
    if (values[begin] != 0) counts[values[begin]] += std::int64_t(end - begin);
    begin = end;
  }
}

StoredLabels::StoredLabels(VolumeFile& file, Progress* progress)
    : m_header(file.header()), m_bytes(bytes_of(m_header.type)) {
  if (m_header.slope != 1 || m_header.intercept != 0) {
    throw InputError({m_header.path, "slope and intercept",
                      number_text(m_header.slope) + " and " + number_text(m_header.intercept),
                      "1 and 0 in a label volume"});
  }
  if (progress != nullptr) progress->stage("labels");
  const Vec3i& dims = geometry().dims();
  for (int a = 0; a < 3; ++a) m_blocks[a] = (dims[a] + kBlockDim - 1) / kBlockDim;
  m_block.assign(std::size_t(m_blocks.x) * m_blocks.y * m_blocks.z, -1);
  const std::size_t slice = std::size_t(dims.x) * dims.y;
  std::vector<char> slab(slice * kBlockDim * m_bytes);
  for (int first = 0; first < dims.z; first += kBlockDim) {
    const int slices = std::min(kBlockDim, dims.z - first);
    for (int k = 0; k < slices; ++k) {
      char* out = slab.data() + slice * k * m_bytes;
      file.read_slice(out);
      if (is_float(type())) check_whole(out, first + k);
      count_labels(type(), out, slice, m_counts);
    }
    take_slab(slab, first, slices);
    report(progress, double(first + slices) / dims.z);
  }
}

void StoredLabels::check_whole(const char* slice, int k) const {
  const Vec3i& dims = geometry().dims();
  std::vector<double> values(std::size_t(dims.x) * dims.y);
  scale_values_of(type())(slice, values.size(), 1, 0, values.data());
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (std::isfinite(values[n]) && values[n] == std::floor(values[n])) continue;
    throw InputError({m_header.path,
                      "voxel " + std::to_string(n % dims.x) + "," + std::to_string(n / dims.x) +
                          "," + std::to_string(k),
                      number_text(values[n]), "a label: a whole number"});
  }
}

/// Keeps the blocks of a slab that hold anything but zeros.
void StoredLabels::take_slab(const std::vector<char>& slab, int first, int slices) {
  const Vec3i& dims = geometry().dims();
  std::vector<char> block(kBlockVoxels * m_bytes);
  for (int by = 0; by < m_blocks.y; ++by) {
    for (int bx = 0; bx < m_blocks.x; ++bx) {
      std::fill(block.begin(), block.end(), char(0));
      const int rows = std::min(kBlockDim, dims.y - by * kBlockDim);
      const std::size_t row_bytes =
          std::size_t(std::min(kBlockDim, dims.x - bx * kBlockDim)) * m_bytes;
      for (int z = 0; z < slices; ++z) {
        for (int y = 0; y < rows; ++y) {
          const std::size_t from =
              (std::size_t(z) * dims.y + by * kBlockDim + y) * dims.x + std::size_t(bx) * kBlockDim;
          std::memcpy(&block[(std::size_t(z) * kBlockDim + y) * kBlockDim * m_bytes],
                      &slab[from * m_bytes], row_bytes);
        }
      }
      if (std::all_of(block.begin(), block.end(), [](char c) { return c == 0; })) continue;
      m_block[(std::size_t(first / kBlockDim) * m_blocks.y + by) * m_blocks.x + bx] =
          std::int32_t(m_values.size() / block.size());
      m_values.insert(m_values.end(), block.begin(), block.end());
    }
  }
}

void StoredLabels::nearest(const Vec3d& lps_mm, char* out) const {
  std::memset(out, 0, std::size_t(m_bytes));
  const Vec3d pos = geometry().index_from_world(lps_mm);
  Vec3i voxel;
  for (int a = 0; a < 3; ++a) {
    const double nearest = std::ceil(pos[a] - kHalf);
    if (!(nearest >= -1 && nearest < geometry().dims()[a])) return;
    voxel[a] = int(nearest);
    // The outer face of the first voxel belongs to it.
    if (voxel[a] == -1 && pos[a] >= -kHalf) voxel[a] = 0;
    if (voxel[a] < 0) return;
  }
  const std::size_t n =
      (std::size_t(voxel.z / kBlockDim) * m_blocks.y + voxel.y / kBlockDim) * m_blocks.x +
      voxel.x / kBlockDim;
  if (m_block[n] < 0) return;
  const std::size_t local =
      (std::size_t(voxel.z % kBlockDim) * kBlockDim + voxel.y % kBlockDim) * kBlockDim +
      voxel.x % kBlockDim;
  std::memcpy(out, &m_values[(std::size_t(m_block[n]) * kBlockVoxels + local) * m_bytes],
              std::size_t(m_bytes));
}

double StoredLabels::label_at(const Vec3d& lps_mm) const {
  char stored[sizeof(double)];
  nearest(lps_mm, stored);
  double label = 0;
  scale_values_of(type())(stored, 1, 1, 0, &label);
  return label;
}

}  // namespace supple

// A label volume as its file stores it, at hand in any order: the label of any place, by a
// segmentation on any grid.
// Cost: the stored bytes of every 8^3 block with a label, 4 bytes per block of the grid, and eight
// slices while reading.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

/// Voxels by the whole number that they hold; 0 is left out.
using LabelCounts = std::map<double, std::int64_t>;

/// Adds `count` stored values.
void count_labels(ValueType type, const void* stored, std::size_t count, LabelCounts& counts);

class StoredLabels {
 public:
  /// Reads a file of which no slice was read yet. Throws InputError: a value that is no whole
  /// number (names the voxel), values with a slope or an intercept, and as read_slice.
  explicit StoredLabels(VolumeFile& file, Progress* progress = nullptr);

  const Geometry& geometry() const { return m_header.geometry; }
  ValueType type() const { return m_header.type; }
  int bytes_per_voxel() const { return m_bytes; }
  const LabelNames& names() const { return m_header.label_names; }
  const LabelCounts& counts() const { return m_counts; }

  /// Copies the stored value of the voxel nearest to a place; 0 beyond the outer voxel faces. Half
  /// way between two voxels it is that of the lower index.
  void nearest(const Vec3d& lps_mm, char* out) const;
  /// The same as a number.
  double label_at(const Vec3d& lps_mm) const;

 private:
  void take_slab(const std::vector<char>& slab, int first, int slices);
  void check_whole(const char* slice, int k) const;

  VolumeHeader m_header;
  int m_bytes;
  Vec3i m_blocks{0, 0, 0};
  std::vector<std::int32_t> m_block;  // where it lies in m_values, i fastest; -1: no label
  std::vector<char> m_values;
  LabelCounts m_counts;
};

}  // namespace supple

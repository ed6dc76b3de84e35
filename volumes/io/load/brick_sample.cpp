#include "volumes/io/load/brick_sample.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "volumes/base/parallel.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/load/slab_reader.h"

namespace supple {

namespace {

/// Elements of one row of bricks in a slice, added to those of its bricks.
void count_row(const float* row, int voxels, float lo, float hi, std::int32_t* elements) {
  for (int i = 0; i < voxels; ++i) {
    elements[i / kBrickDim] += row[i] >= lo && row[i] <= hi;
  }
}

void count_slab(const Slab& slab, float lo, float hi, BrickSample& sample) {
  const int across = slab.bricks_x();
  std::vector<std::int32_t> elements(std::size_t(across) * slab.bricks_y(), 0);
  parallel_for(slab.bricks_y(), [&](int bj) {
    const int end = std::min(slab.dims.y, (bj + 1) * kBrickDim);
    for (int k = 0; k < slab.depth; ++k) {
      for (int j = bj * kBrickDim; j < end; ++j) {
        count_row(slab.row(j, k), slab.dims.x, lo, hi, &elements[std::size_t(bj) * across]);
      }
    }
  });
  for (const std::int32_t of_brick : elements) {
    sample.bricks += of_brick > 0;
    sample.elements += of_brick;
  }
}

/// The least float that is not below a bound, and the largest that is not above it.
float above(double bound) {
  constexpr float kHighest = std::numeric_limits<float>::infinity();
  const float near = float(bound);
  return double(near) < bound ? std::nextafter(near, kHighest) : near;
}
float below(double bound) {
  return -above(-bound);
}

/// A number that looks like chance and is the same in every run.
std::uint32_t scrambled(std::uint32_t n) {
  n = (n ^ 61U ^ (n >> 16U)) * 9U;
  n = (n ^ (n >> 4U)) * 0x27d4eb2dU;
  return n ^ (n >> 15U);
}

/// Reads slabs in their order.
class SampleReader {
 public:
  explicit SampleReader(VolumeFile& file) : m_file(file) {
    require_scalars(file.header());
    m_slab.dims = file.header().geometry.dims();
    m_slice = std::size_t(m_slab.dims.x) * m_slab.dims.y;
    m_stored.resize(m_slice * kBrickDim * bytes_of(file.header().type));
    m_slab.values.resize(m_slice * kBrickDim);
  }

  const Slab& read(int slab) {
    const std::size_t slice_bytes = m_slice * bytes_of(m_file.header().type);
    m_slab.k0 = slab * kBrickDim;
    m_slab.depth = std::min(kBrickDim, m_slab.dims.z - m_slab.k0);
    m_file.skip_slices(m_slab.k0 - m_next_k);
    for (int k = 0; k < m_slab.depth; ++k) m_file.read_slice(&m_stored[slice_bytes * k]);
    m_next_k = m_slab.k0 + m_slab.depth;
    SliceStatistics found[kBrickDim];
    parallel_for(m_slab.depth, [&](int k) {
      found[k] = densities_of(m_file.header(), &m_stored[slice_bytes * k], m_slice,
                              &m_slab.values[m_slice * k]);
    });
    for (int k = 0; k < m_slab.depth; ++k) m_statistics.append(found[k]);
    return m_slab;
  }

  double lowest() const { return m_statistics.min; }

 private:
  VolumeFile& m_file;
  Slab m_slab;
  std::size_t m_slice;
  std::vector<char> m_stored;
  int m_next_k = 0;
  SliceStatistics m_statistics;
};

}  // namespace

BrickSample sample_bricks(VolumeFile& file, const std::optional<std::pair<double, double>>& range,
                          int most_slabs, const std::function<bool(const BrickSample&)>& is_enough,
                          Progress* progress) {
  constexpr float kHighest = std::numeric_limits<float>::infinity();
  BrickSample sample;
  sample.slabs = (file.header().geometry.dims().z + kBrickDim - 1) / kBrickDim;
  const int strata = std::min(sample.slabs, most_slabs);
  SampleReader reader(file);
  for (int n = 0; n < strata; ++n) {
    poll(progress);
    const auto start_of = [&](int stratum) {
      return int(std::int64_t(sample.slabs) * stratum / strata);
    };
    const int first = start_of(n), depth = start_of(n + 1) - first;
    const Slab& slab = reader.read(first + int(scrambled(std::uint32_t(n)) % std::uint32_t(depth)));
    const float lo = range ? above(range->first) : std::nextafter(float(reader.lowest()), kHighest);
    count_slab(slab, lo, range ? below(range->second) : kHighest, sample);
    ++sample.slabs_read;
    if (is_enough(sample)) break;
  }
  return sample;
}

}  // namespace supple

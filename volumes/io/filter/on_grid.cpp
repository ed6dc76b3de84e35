#include "volumes/io/filter/on_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

class GridVolume : public VolumeFile {
 public:
  /// `vectors`: to the places that are read; empty: voxels read their own.
  GridVolume(VolumeFile& file, const Geometry& grid, VectorSliceSource vectors, bool is_nearest,
             Progress* progress)
      : m_source(file.header().geometry), m_vectors(std::move(vectors)), m_is_nearest(is_nearest) {
    m_header = file.header();
    m_header.geometry = grid;
    load(file, progress);
  }

  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    const int k = m_next++;
    std::vector<double> values(std::size_t(dims.x) * std::size_t(dims.y));
    std::vector<Vec3f> ways(values.size(), Vec3f(0));
    if (m_vectors) m_vectors(k, ways.data());
    parallel_for(dims.y, [&](int j) {
      for (int i = 0; i < dims.x; ++i) {
        const std::size_t n = std::size_t(j) * std::size_t(dims.x) + std::size_t(i);
        const Vec3d place = m_header.geometry.world_from_index(Vec3d(i, j, k)) + Vec3d(ways[n]);
        values[n] = value_at(m_source.index_from_world(place));
      }
    });
    store_values(m_header.type, values.data(), values.size(), static_cast<char*>(out));
  }

 private:
  void load(VolumeFile& file, Progress* progress) {
    const Vec3i& dims = m_source.dims();
    const std::size_t slice = std::size_t(dims.x) * std::size_t(dims.y);
    std::vector<char> stored(slice * std::size_t(bytes_of(m_header.type)));
    m_values.resize(slice * std::size_t(dims.z));
    stage(progress, "reading");
    for (int k = 0; k < dims.z; ++k) {
      file.read_slice(stored.data());
      scale_values_of(m_header.type)(stored.data(), slice, 1, 0, &m_values[slice * std::size_t(k)]);
      report(progress, double(k + 1) / dims.z);
    }
    // The least density counts: a negative slope turns the order of stored values.
    m_outside = std::numeric_limits<double>::infinity();
    for (const double value : m_values) {
      if (std::isfinite(value)) m_outside = std::min(m_outside, m_header.slope * value);
    }
    m_outside = std::isfinite(m_outside) ? m_outside / m_header.slope : 0;
  }

  double stored_at(const Vec3i& voxel) const {
    const Vec3i& dims = m_source.dims();
    return m_values[(std::size_t(voxel.z) * std::size_t(dims.y) + std::size_t(voxel.y)) *
                        std::size_t(dims.x) +
                    std::size_t(voxel.x)];
  }

  double value_at(Vec3d index) const {
    constexpr double kOnFace = 1e-9;
    Vec3i low, high;
    Vec3d part;
    for (int a = 0; a < 3; ++a) {
      const double last = m_source.dims()[a] - 1;
      if (!(index[a] >= -0.5 - kOnFace && index[a] <= last + 0.5 + kOnFace)) return m_outside;
      index[a] = std::clamp(index[a], 0.0, last);
      low[a] = int(m_is_nearest ? std::ceil(index[a] - 0.5) : std::floor(index[a]));
      high[a] = std::min(low[a] + 1, int(last));
      part[a] = index[a] - low[a];
    }
    if (m_is_nearest) return stored_at(low);
    double sum = 0, known = 0;
    for (int corner = 0; corner < 8; ++corner) {
      Vec3i voxel;
      double weight = 1;
      for (int a = 0; a < 3; ++a) {
        const bool is_high = (corner >> a & 1) != 0;
        voxel[a] = is_high ? high[a] : low[a];
        weight *= is_high ? part[a] : 1 - part[a];
      }
      const double value = weight > 0 ? stored_at(voxel) : 0;
      if (weight == 0 || !std::isfinite(value)) continue;
      sum += weight * value;
      known += weight;
    }
    return known >= 0.5 ? sum / known : std::numeric_limits<double>::quiet_NaN();
  }

  Geometry m_source;
  VectorSliceSource m_vectors;
  bool m_is_nearest;
  std::vector<double> m_values;  // as they are stored
  double m_outside = 0;
  int m_next = 0;
};

/// The voxels of the volume that trilinear values at the ends of all vectors read.
IndexBox box_of(const Geometry& volume, const Geometry& grid, const VectorSliceSource& vectors) {
  const Vec3i& dims = grid.dims();
  std::vector<Vec3f> ways(std::size_t(dims.x) * std::size_t(dims.y));
  const double far = std::numeric_limits<double>::infinity();
  Vec3d lo(far), hi(-far);
  for (int k = 0; k < dims.z; ++k) {
    vectors(k, ways.data());
    for (std::size_t n = 0; n < ways.size(); ++n) {
      const std::size_t width = std::size_t(dims.x);
      const Vec3d voxel(Vec3i(int(n % width), int(n / width), k));
      const Vec3d place = grid.world_from_index(voxel) + Vec3d(ways[n]);
      const Vec3d index = volume.index_from_world(place);
      for (int a = 0; a < 3; ++a) {
        lo[a] = std::min(lo[a], index[a]);
        hi[a] = std::max(hi[a], index[a]);
      }
    }
  }
  IndexBox box;
  for (int a = 0; a < 3; ++a) {
    const double last = volume.dims()[a] - 1;
    if (hi[a] < -0.5 || lo[a] > last + 0.5) return {};
    box.lo[a] = int(std::floor(std::clamp(lo[a] - 0.5, 0.0, last)));
    box.hi[a] = int(std::ceil(std::clamp(hi[a] + 0.5, 0.0, last)));
  }
  return box;
}

std::unique_ptr<VolumeFile> grid_volume(std::unique_ptr<VolumeFile> file, const Geometry& grid,
                                        const VectorSliceSource& vectors,
                                        ResampleKernel interpolation, Progress* progress) {
  if (interpolation == ResampleKernel::cubic) {
    throw InputError(
        {file->header().path, "interpolation", "cubic on another grid", "linear or nearest"});
  }
  return std::make_unique<GridVolume>(*file, grid, vectors,
                                      interpolation == ResampleKernel::nearest, progress);
}

}  // namespace

std::int64_t on_grid_bytes(const Geometry& volume) {
  return volume.voxel_count() * std::int64_t(sizeof(double));
}

std::unique_ptr<VolumeFile> on_grid(std::unique_ptr<VolumeFile> file, const Geometry& grid,
                                    ResampleKernel interpolation, Progress* progress) {
  return grid_volume(std::move(file), grid, nullptr, interpolation, progress);
}

std::unique_ptr<VolumeFile> on_grid(std::unique_ptr<VolumeFile> file, const Geometry& grid,
                                    const VectorSliceSource& vectors, ResampleKernel interpolation,
                                    Progress* progress) {
  const IndexBox box = box_of(file->header().geometry, grid, vectors);
  if (box.empty()) {
    throw InputError({file->header().path, "grid", "one whose vectors all lead out of the volume",
                      "one that reads the volume"});
  }
  return grid_volume(crop(std::move(file), box), grid, vectors, interpolation, progress);
}

}  // namespace supple

#include "volumes/io/filter/filters.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/filter/separable_volume.h"
#include "volumes/io/format/formats.h"

namespace supple {

namespace {

constexpr double kMostSigma = 1000;  // voxels

std::string box_text(const IndexBox& box) {
  return to_text(box.lo) + ":" + to_text(box.hi);
}

/// The same axes with the first voxel at `first` (index frame) and other steps.
Geometry moved_grid(const VolumeHeader& header, const Vec3i& dims, const Vec3d& first,
                    const Vec3d& step) {
  std::array<Vec3d, 3> axes = header.geometry.axes_mm();
  for (int a = 0; a < 3; ++a) axes[std::size_t(a)] *= step[a];
  return make_geometry(header.path, dims, header.geometry.world_from_index(first), axes);
}

class CroppedVolume final : public VolumeFile {
 public:
  CroppedVolume(std::unique_ptr<VolumeFile> file, const IndexBox& box)
      : m_file(std::move(file)), m_box(box) {
    m_header = m_file->header();
    m_slice.resize(std::size_t(m_header.geometry.dims().x) *
                   std::size_t(m_header.geometry.dims().y) * voxel_bytes());
    m_header.geometry =
        moved_grid(m_file->header(), box.hi - box.lo + Vec3i(1), Vec3d(box.lo), Vec3d(1));
  }

  void read_slice(void* out) override {
    for (; m_next < m_box.lo.z; ++m_next) m_file->read_slice(m_slice.data());
    m_file->read_slice(m_slice.data());
    ++m_next;
    const std::size_t row = std::size_t(m_header.geometry.dims().x) * voxel_bytes();
    const std::size_t stride = std::size_t(m_file->header().geometry.dims().x) * voxel_bytes();
    const char* from =
        m_slice.data() + std::size_t(m_box.lo.y) * stride + std::size_t(m_box.lo.x) * voxel_bytes();
    for (int j = 0; j < m_header.geometry.dims().y; ++j) {
      std::memcpy(static_cast<char*>(out) + std::size_t(j) * row, from + std::size_t(j) * stride,
                  row);
    }
  }

 private:
  std::size_t voxel_bytes() const {
    return std::size_t(bytes_of(m_header.type)) * std::size_t(m_header.components);
  }

  std::unique_ptr<VolumeFile> m_file;
  IndexBox m_box;
  int m_next = 0;  // slice of the file
  std::vector<char> m_slice;
};

class ThresholdVolume final : public VolumeFile {
 public:
  ThresholdVolume(std::unique_ptr<VolumeFile> file, const Threshold& range, double outside)
      : m_file(std::move(file)), m_range(range) {
    m_header = m_file->header();
    if (range.is_mask) {
      m_header.type = ValueType::uint8;
      m_header.slope = 1;
      m_header.intercept = 0;
    } else {
      outside = (outside - m_header.intercept) / m_header.slope;
    }
    m_outside.resize(std::size_t(bytes_of(m_header.type)));
    store_values(m_header.type, &outside, 1, m_outside.data());
  }

  void read_slice(void* out) override {
    const VolumeHeader& input = m_file->header();
    const std::size_t count =
        std::size_t(input.geometry.dims().x) * std::size_t(input.geometry.dims().y);
    const std::size_t width = m_outside.size();
    m_stored.resize(count * std::size_t(bytes_of(input.type)));
    m_file->read_slice(m_stored.data());
    m_densities.resize(count);
    scale_values_of(input.type)(m_stored.data(), count, input.slope, input.intercept,
                                m_densities.data());
    char* to = static_cast<char*>(out);
    for (std::size_t n = 0; n < count; ++n) {
      const bool stays = m_densities[n] >= m_range.lo && m_densities[n] <= m_range.hi;
      if (!stays) {
        std::memcpy(to + n * width, m_outside.data(), width);
      } else if (m_range.is_mask) {
        to[n] = 1;
      } else {
        std::memcpy(to + n * width, m_stored.data() + n * width, width);
      }
    }
  }

 private:
  std::unique_ptr<VolumeFile> m_file;
  Threshold m_range;
  std::vector<char> m_outside, m_stored;
  std::vector<double> m_densities;
};

}  // namespace

std::unique_ptr<VolumeFile> crop(std::unique_ptr<VolumeFile> file, const IndexBox& box) {
  const IndexBox whole{{0, 0, 0}, file->header().geometry.dims() - Vec3i(1)};
  if (box.empty() || !whole.contains(box.lo) || !whole.contains(box.hi)) {
    throw InputError(
        {file->header().path, "box", box_text(box), "a box within " + box_text(whole)});
  }
  return std::make_unique<CroppedVolume>(std::move(file), box);
}

IndexBox box_of_densities(VolumeFile& file, double lo, double hi, double margin_mm,
                          Progress* progress) {
  const VolumeHeader& header = file.header();
  const Vec3i& dims = header.geometry.dims();
  const std::size_t count = std::size_t(dims.x) * std::size_t(dims.y);
  std::vector<char> stored(count * std::size_t(bytes_of(header.type)));
  std::vector<double> densities(count);
  IndexBox box{dims, {-1, -1, -1}};
  if (progress != nullptr) progress->stage("looking for the densities");
  for (int k = 0; k < dims.z; ++k) {
    file.read_slice(stored.data());
    scale_values_of(header.type)(stored.data(), count, header.slope, header.intercept,
                                 densities.data());
    for (std::size_t n = 0; n < count; ++n) {
      if (!(densities[n] >= lo && densities[n] <= hi)) continue;
      const Vec3i voxel(int(n % std::size_t(dims.x)), int(n / std::size_t(dims.x)), k);
      for (int a = 0; a < 3; ++a) {
        box.lo[a] = std::min(box.lo[a], voxel[a]);
        box.hi[a] = std::max(box.hi[a], voxel[a]);
      }
    }
    report(progress, double(k + 1) / dims.z);
  }
  if (box.empty()) {
    throw InputError({header.path, "range",
                      "no voxel with a density of " + number_text(lo) + " to " + number_text(hi),
                      "densities that the volume has"});
  }
  const Vec3d spacing = header.geometry.spacing_mm();
  for (int a = 0; a < 3; ++a) {
    const int margin = int(std::min(std::ceil(margin_mm / spacing[a]), double(dims[a])));
    box.lo[a] = std::max(0, box.lo[a] - margin);
    box.hi[a] = std::min(dims[a] - 1, box.hi[a] + margin);
  }
  return box;
}

std::unique_ptr<VolumeFile> smooth(std::unique_ptr<VolumeFile> file, double sigma_mm) {
  const Geometry geometry = file->header().geometry;
  std::array<AxisWeights, 3> weights;
  for (int a = 0; a < 3; ++a) {
    const double sigma = sigma_mm / geometry.spacing_mm()[a];
    if (!(sigma > 0 && sigma <= kMostSigma)) {
      throw InputError({file->header().path, "sigma", number_text(sigma_mm),
                        "a length in mm, at most 1000 voxels"});
    }
    weights[std::size_t(a)] = AxisWeights::gaussian(geometry.dims()[a], sigma);
  }
  return std::make_unique<SeparableVolume>(std::move(file), std::move(weights), geometry);
}

std::unique_ptr<VolumeFile> with_spacing(std::unique_ptr<VolumeFile> file, const Vec3d& spacing_mm,
                                         ResampleKernel interpolation) {
  const VolumeHeader& header = file->header();
  const Vec3i& from = header.geometry.dims();
  const Vec3d old = header.geometry.spacing_mm();
  Vec3i to;
  Vec3d step, first;
  std::array<AxisWeights, 3> weights;
  for (int a = 0; a < 3; ++a) {
    step[a] = spacing_mm[a] / old[a];
    const double count = std::max(1.0, std::round(from[a] / step[a]));
    if (!(spacing_mm[a] > 0) || !(count <= kMaxCoordinate)) {
      throw InputError({header.path, "spacing", number_text(spacing_mm[a]),
                        "lengths in mm that give at most 1e9 voxels along an axis"});
    }
    to[a] = int(count);
    first[a] = (step[a] - 1) / 2;
    const auto make = interpolation == ResampleKernel::linear  ? AxisWeights::linear
                      : interpolation == ResampleKernel::cubic ? AxisWeights::cubic
                                                               : AxisWeights::nearest;
    weights[std::size_t(a)] = make(from[a], to[a], step[a]);
  }
  const Geometry grid = moved_grid(header, to, first, step);
  return std::make_unique<SeparableVolume>(std::move(file), std::move(weights), grid);
}

std::unique_ptr<VolumeFile> threshold(std::unique_ptr<VolumeFile> file, const Threshold& range,
                                      double minimum) {
  const double outside = range.is_mask ? 0.0 : range.outside.value_or(minimum);
  return std::make_unique<ThresholdVolume>(std::move(file), range, outside);
}

}  // namespace supple

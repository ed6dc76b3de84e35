#include "volumes/field/inversion/deformation_metrics.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/field/inversion/linked_elements.h"
#include "volumes/field/length_statistics.h"

namespace supple {

namespace {

constexpr double kMovedMm = 1e-6;

/// The squared Frobenius norm of second derivatives in world coordinates. With H of one component
/// of u along the grid's axes and A = dx/di this is |A^-T H A^-1|^2 = tr(H M H M), M = A^-1 A^-T.
class BendingNorm {
 public:
  explicit BendingNorm(const Geometry& geometry) : m_geometry(geometry) {
    for (int a = 0; a < 3; ++a) {
      Vec3d axis(0);
      axis[a] = 1;
      m_gradients[a] = geometry.world_gradient_from_index(axis);
    }
  }

  double operator()(const SecondDerivatives& index) const {
    SecondDerivatives D, DM;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) D[a][b] = m_geometry.world_vector_from_index(index[a][b]);
    }
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        DM[a][b] = Vec3d(0);
        for (int c = 0; c < 3; ++c) DM[a][b] += D[a][c] * m_gradients[c].dot(m_gradients[b]);
      }
    }
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) sum += DM[a][b].dot(DM[b][a]);
    }
    return sum;
  }

 private:
  const Geometry& m_geometry;
  std::array<Vec3d, 3> m_gradients;  // of the index coordinates, 1/mm
};

/// Adds up elements; the percentiles need all lengths.
class Summary {
 public:
  void add(const DeformationMaps& maps, std::size_t b, int offset) {
    const std::size_t slot = b * kBrickVoxels + std::size_t(offset);
    const double jacobian = maps.jacobian[slot], bending = maps.bending_per_mm2[slot];
    const bool is_first = m_lengths.empty();
    m_lengths.push_back(maps.length_mm[slot]);
    m_result.moved += maps.length_mm[slot] > kMovedMm;
    m_result.folded_cells += mask_test(maps.folded[b], offset);
    m_result.min_jacobian = is_first ? jacobian : std::min(m_result.min_jacobian, jacobian);
    m_result.max_jacobian = is_first ? jacobian : std::max(m_result.max_jacobian, jacobian);
    m_jacobians += jacobian;
    if (jacobian > 0) {
      m_logs += std::log(jacobian);
      m_squared_logs += std::log(jacobian) * std::log(jacobian);
    } else {
      ++m_result.nonpositive_jacobians;
    }
    if (!std::isnan(bending)) {
      m_bending += bending;
      ++m_bent;
    }
  }

  DeformationSummary finish(double voxel_mm3) {
    if (m_lengths.empty()) return m_result;
    const LengthStatistics lengths = statistics_of(std::move(m_lengths));
    m_result.elements = lengths.count;
    m_result.mean_mm = lengths.mean_mm;
    m_result.rms_mm = lengths.rms_mm;
    m_result.median_mm = lengths.median_mm;
    m_result.p95_mm = lengths.p95_mm;
    m_result.max_mm = lengths.max_mm;
    m_result.rest_volume_mm3 = double(lengths.count) * voxel_mm3;
    m_result.volume_mm3 = m_jacobians * voxel_mm3;
    const double positive = double(lengths.count - m_result.nonpositive_jacobians);
    if (positive > 0) {
      const double mean = m_logs / positive;
      m_result.sd_log_jacobian = std::sqrt(std::max(m_squared_logs / positive - mean * mean, 0.0));
    }
    if (m_bent > 0) m_result.bending_per_mm2 = m_bending / double(m_bent);
    return m_result;
  }

 private:
  std::vector<float> m_lengths;
  double m_jacobians = 0, m_logs = 0, m_squared_logs = 0, m_bending = 0;
  std::int64_t m_bent = 0;  // elements with second derivatives
  DeformationSummary m_result;
};

/// take(brick, offset) of all elements, or of those whose mask is not 0.
template <class Take>
void for_each_element(const DeformationMaps& maps, const BrickValues* mask, const Take& take) {
  for (std::size_t b = 0; b < maps.elements.brick_count(); ++b) {
    const std::int32_t* const within = mask != nullptr ? mask->brick_or_zero(b) : nullptr;
    for_each_active(maps.elements.mask(b), [&](int offset) {
      if (within == nullptr || within[offset] != 0) take(b, offset);
    });
  }
}

}  // namespace

DeformationMaps map_deformation(const Displacement& u, const BrickTopology& elements,
                                const LinkCuts& cuts) {
  DeformationMaps maps;
  maps.elements = elements;
  const std::size_t slots = elements.brick_count() * kBrickVoxels;
  maps.length_mm.resize(slots, 0.0f);
  maps.jacobian.resize(slots, 1.0f);
  maps.bending_per_mm2.resize(slots, NAN);
  maps.folded.resize(elements.brick_count(), BrickMask{});
  const LinkedElements linked(u, elements, cuts);
  const BendingNorm norm(u.geometry);
  parallel_for(elements.brick_count(), [&](std::size_t b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i voxel = elements.origin(b) + brick_local(offset);
      const Vec3d moved = u.geometry.world_vector_from_index(linked.at(voxel));
      if (!std::isfinite(moved.length())) {
        throw InputError({"", "displacement", "a value that is not finite", "finite numbers"});
      }
      const std::size_t slot = b * kBrickVoxels + offset;
      maps.length_mm[slot] = float(moved.length());
      maps.jacobian[slot] = float(linked.jacobian(voxel));
      SecondDerivatives D;
      if (linked.second_derivatives(voxel, D)) maps.bending_per_mm2[slot] = float(norm(D));
      if (linked.is_folded(voxel)) mask_set(maps.folded[b], offset);
    });
  });
  return maps;
}

DeformationSummary summarize(const DeformationMaps& maps, const Geometry& geometry,
                             const BrickValues* mask) {
  Summary summary;
  for_each_element(maps, mask, [&](std::size_t b, int offset) { summary.add(maps, b, offset); });
  return summary.finish(std::abs(geometry.determinant()));
}

std::map<std::int32_t, DeformationSummary> summarize_labels(const DeformationMaps& maps,
                                                            const BrickValues& labels,
                                                            const Geometry& geometry,
                                                            const BrickValues* mask) {
  std::map<std::int32_t, Summary> sums;
  for_each_element(maps, mask, [&](std::size_t b, int offset) {
    sums[labels.brick_or_zero(b)[offset]].add(maps, b, offset);
  });
  std::map<std::int32_t, DeformationSummary> summaries;
  for (auto& [label, summary] : sums) {
    summaries[label] = summary.finish(std::abs(geometry.determinant()));
  }
  return summaries;
}

Value to_value(const DeformationSummary& summary) {
  Value bending;  // null where no element has all its neighbours
  if (summary.bending_per_mm2) bending = *summary.bending_per_mm2;
  return {{"elements", summary.elements},
          {"moved", summary.moved},
          {"mean_mm", summary.mean_mm},
          {"rms_mm", summary.rms_mm},
          {"median_mm", summary.median_mm},
          {"p95_mm", summary.p95_mm},
          {"max_mm", summary.max_mm},
          {"min_jacobian", summary.min_jacobian},
          {"max_jacobian", summary.max_jacobian},
          {"sd_log_jacobian", summary.sd_log_jacobian},
          {"nonpositive_jacobians", summary.nonpositive_jacobians},
          {"folded_cells", summary.folded_cells},
          {"folded_voxels", summary.folded_cells},  // the former name, for one release
          {"bending_per_mm2", bending},
          {"rest_volume_mm3", summary.rest_volume_mm3},
          {"volume_mm3", summary.volume_mm3},
          {"volume_change_percent", 100 * summary.volume_change()}};
}

std::function<void(int k, float* out)> slices_of(const DeformationMaps& maps, DeformationMap which,
                                                 const Vec3i& dims) {
  const auto value = [&maps, which](std::size_t b, int offset) {
    const std::size_t n = b * kBrickVoxels + std::size_t(offset);
    switch (which) {
      case DeformationMap::length_mm:
        return maps.length_mm[n];
      case DeformationMap::jacobian:
        return maps.jacobian[n];
      case DeformationMap::folded:
        return mask_test(maps.folded[b], offset) ? 1.0f : 0.0f;
      default:
        return std::isnan(maps.bending_per_mm2[n]) ? 0 : maps.bending_per_mm2[n];
    }
  };
  return [&maps, which, dims, value](int k, float* out) {
    const float elsewhere = which == DeformationMap::jacobian ? 1 : 0;
    std::fill(out, out + std::size_t(dims.x) * std::size_t(dims.y), elsewhere);
    for (std::size_t b = 0; b < maps.elements.brick_count(); ++b) {
      const Vec3i& origin = maps.elements.origin(b);
      if (k < origin.z || k >= origin.z + kBrickDim) continue;
      for_each_active(maps.elements.mask(b), [&](int offset) {
        const Vec3i voxel = origin + brick_local(offset);
        if (voxel.z == k) {
          out[std::size_t(voxel.y) * std::size_t(dims.x) + std::size_t(voxel.x)] = value(b, offset);
        }
      });
    }
  };
}

}  // namespace supple

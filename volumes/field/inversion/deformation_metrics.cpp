#include "volumes/field/inversion/deformation_metrics.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "volumes/base/error.h"
#include "volumes/field/inversion/deformed_cell.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

constexpr double kMovedMm = 1e-6;

double determinant(const Vec3d& x, const Vec3d& y, const Vec3d& z) {
  return x.dot(y.cross(z));
}

/// Differences of u between elements that are linked.
class LinkedElements {
 public:
  LinkedElements(const Displacement& u, const BrickTopology& elements, const LinkCuts& cuts)
      : m_u(u.u), m_elements(elements), m_cuts(cuts) {}

  Vec3d at(const Vec3i& voxel) const {
    Vec3f vector(0);
    m_u.at(voxel, vector);
    return Vec3d(vector);
  }

  /// The link from a voxel to the next one along the axis.
  bool is_linked(const Vec3i& voxel, int axis) const {
    Vec3i next = voxel;
    ++next[axis];
    const std::int32_t b = m_elements.find(voxel);
    return b >= 0 && mask_test(m_elements.mask(b), brick_offset(voxel)) &&
           m_elements.is_active(next) && !m_cuts.is_cut(b, brick_offset(voxel), axis);
  }

  /// det F at an element.
  double jacobian(const Vec3i& voxel) const {
    std::array<Vec3d, 3> columns = {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}};
    for (int axis = 0; axis < 3; ++axis) columns[axis] += derivative(voxel, axis);
    return determinant(columns[0], columns[1], columns[2]);
  }

  /// Whether the cell above the voxel is complete and folded.
  bool is_folded(const Vec3i& voxel) const {
    CellCorners corners;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3i step = cell_corner(corner);
      for (int axis = 0; axis < 3; ++axis) {
        if (step[axis] == 0 && !is_linked(voxel + step, axis)) return false;
      }
      const Vec3d place = Vec3d(step) + at(voxel + step);
      for (int c = 0; c < 3; ++c) corners.p[c][corner] = place[c];
    }
    return supple::is_folded(corners);
  }

 private:
  Vec3d derivative(const Vec3i& voxel, int axis) const {
    Vec3i before = voxel, after = voxel;
    --before[axis];
    ++after[axis];
    const bool has_before = is_linked(before, axis), has_after = is_linked(voxel, axis);
    if (!has_before && !has_after) return Vec3d(0);
    const Vec3i& lo = has_before ? before : voxel;
    const Vec3i& hi = has_after ? after : voxel;
    return (at(hi) - at(lo)) * (has_before && has_after ? 0.5 : 1.0);
  }

  const VectorBricks& m_u;
  const BrickTopology& m_elements;
  const LinkCuts& m_cuts;
};

/// Adds up elements; the percentile needs all lengths.
class Summary {
 public:
  void add(float length_mm, double jacobian, bool folded) {
    m_lengths.push_back(length_mm);
    m_sum += length_mm;
    m_squares += double(length_mm) * length_mm;
    m_jacobians += jacobian;
    m_result.moved += length_mm > kMovedMm;
    m_result.folded_cells += folded;
    const bool is_first = m_lengths.size() == 1;
    m_result.min_jacobian = is_first ? jacobian : std::min(m_result.min_jacobian, jacobian);
    m_result.max_jacobian = is_first ? jacobian : std::max(m_result.max_jacobian, jacobian);
  }

  DeformationSummary finish(double voxel_mm3) {
    if (m_lengths.empty()) return m_result;
    const double count = double(m_lengths.size());
    m_result.elements = std::int64_t(m_lengths.size());
    m_result.mean_mm = m_sum / count;
    m_result.rms_mm = std::sqrt(m_squares / count);
    m_result.max_mm = *std::max_element(m_lengths.begin(), m_lengths.end());
    const std::size_t rank = std::size_t(std::ceil(0.95 * count)) - 1;
    std::nth_element(m_lengths.begin(), m_lengths.begin() + rank, m_lengths.end());
    m_result.p95_mm = m_lengths[rank];
    m_result.rest_volume_mm3 = count * voxel_mm3;
    m_result.volume_mm3 = m_jacobians * voxel_mm3;
    return m_result;
  }

 private:
  std::vector<float> m_lengths;
  double m_sum = 0, m_squares = 0, m_jacobians = 0;
  DeformationSummary m_result;
};

template <class Take>
void for_each_element(const DeformationMaps& maps, const Take& take) {
  for (std::size_t b = 0; b < maps.elements.brick_count(); ++b) {
    for_each_active(maps.elements.mask(b),
                    [&](int offset) { take(b, offset, b * kBrickVoxels + offset); });
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
  maps.folded.resize(elements.brick_count(), BrickMask{});
  const LinkedElements linked(u, elements, cuts);
  tbb::parallel_for(std::size_t(0), elements.brick_count(), [&](std::size_t b) {
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i voxel = elements.origin(b) + brick_local(offset);
      const Vec3d moved = u.geometry.world_vector_from_index(linked.at(voxel));
      if (!std::isfinite(moved.length())) {
        throw InputError({"", "displacement", "a value that is not finite", "finite numbers"});
      }
      const std::size_t slot = b * kBrickVoxels + offset;
      maps.length_mm[slot] = float(moved.length());
      maps.jacobian[slot] = float(linked.jacobian(voxel));
      if (linked.is_folded(voxel)) mask_set(maps.folded[b], offset);
    });
  });
  return maps;
}

DeformationSummary summarize(const DeformationMaps& maps, const Geometry& geometry) {
  Summary summary;
  for_each_element(maps, [&](std::size_t b, int offset, std::size_t slot) {
    summary.add(maps.length_mm[slot], maps.jacobian[slot], mask_test(maps.folded[b], offset));
  });
  return summary.finish(std::abs(geometry.determinant()));
}

std::map<std::int32_t, DeformationSummary> summarize_labels(const DeformationMaps& maps,
                                                            const BrickValues& labels,
                                                            const Geometry& geometry) {
  std::map<std::int32_t, Summary> sums;
  for_each_element(maps, [&](std::size_t b, int offset, std::size_t slot) {
    const std::int32_t label = labels.brick_or_zero(b)[offset];
    sums[label].add(maps.length_mm[slot], maps.jacobian[slot], mask_test(maps.folded[b], offset));
  });
  std::map<std::int32_t, DeformationSummary> summaries;
  for (auto& [label, summary] : sums) {
    summaries[label] = summary.finish(std::abs(geometry.determinant()));
  }
  return summaries;
}

}  // namespace supple

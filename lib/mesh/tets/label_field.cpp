#include "lib/mesh/tets/label_field.h"

#include <limits>

namespace supple {

namespace {

/// How far a surface may be moved, in the smallest voxel size; or in the lattice's spacing, where
/// that is more, but no farther than distances are known.
constexpr double kMostVoxels = 0.5, kMostSpacings = 0.125, kMostInAll = 2;

}  // namespace

LabelField::LabelField(const VoxelMask& mask, const VoxelLabel& label_of, double sigma_voxels,
                       double spacing_mm, Progress* progress)
    : m_whole(mask, sigma_voxels, progress) {
  const Vec3d size = mask.geometry.spacing_mm();
  const double voxel = std::min({size.x, size.y, size.z});
  m_most_outwards = std::clamp(kMostSpacings * spacing_mm, kMostVoxels * voxel, kMostInAll * voxel);
  const std::map<std::int32_t, VoxelMask> masks =
      label_of ? masks_of_labels(mask, label_of) : std::map<std::int32_t, VoxelMask>{{1, mask}};
  const std::size_t most = std::numeric_limits<LabelNumber>::max();
  if (masks.size() > most) {
    throw InputError(
        {"", "label", std::to_string(masks.size()) + " labels", "at most " + std::to_string(most)});
  }
  for (const auto& [label, part] : masks) {
    m_labels.push_back(label);
    m_volumes.push_back(part.volume_mm3());
    if (masks.size() == 1) break;
    poll(progress);
    m_parts.emplace_back(part, sigma_voxels);
  }
  m_growth.assign(m_labels.size(), 0);
  m_outwards = m_growth;
}

LabelNumber LabelField::at(const Vec3d& index) const {
  const double whole = m_whole.at(index);
  if (whole > m_most_outwards) return 0;
  LabelNumber best = 1;
  if (!m_parts.empty()) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < m_parts.size(); ++n) {
      const double own = m_parts[n].at(index) - m_growth[n];
      if (own >= least) continue;
      least = own;
      best = LabelNumber(n + 1);
    }
  }
  return whole > m_outwards[best - 1U] ? 0 : best;
}

LabelNumber LabelField::best(const LabelSet& among, const Vec3d& index) const {
  LabelNumber best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (const LabelNumber label : among) {
    if (label == 0) continue;
    const double value = own(label, index);
    if (value >= least) continue;
    least = value;
    best = label;
  }
  const bool is_outside = best != 0 && among.holds(0) && m_whole.at(index) > m_outwards[best - 1U];
  return is_outside ? 0 : best;
}

double LabelField::beyond(const LabelSet& a, const LabelSet& b, const Vec3d& index) const {
  const double far = std::numeric_limits<double>::infinity();
  double least_a = far, least_b = far;
  LabelNumber best = 0;
  const auto take = [&](const LabelSet& set, double& least) {
    for (const LabelNumber label : set) {
      if (label == 0) continue;
      const double value = own(label, index);
      if (value >= least) continue;
      if (value < std::min(least_a, least_b)) best = label;
      least = value;
    }
  };
  take(a, least_a);
  take(b, least_b);
  const double least = std::min(least_a, least_b);
  least_a -= least;
  least_b -= least;
  if (a.holds(0) || b.holds(0)) {
    // Inside, all labels are nearer than what is around.
    const double inwards = m_outwards[best - 1U] - m_whole.at(index);
    double& with_outside = a.holds(0) ? least_a : least_b;
    with_outside = std::min(with_outside, inwards);
  }
  return least_a - least_b;
}

void LabelField::levels(const LabelNumber* labels, int count, const Vec3d& index,
                        double* out) const {
  double mean = 0, outwards = 0;
  int inner = 0;
  for (int n = 0; n < count; ++n) {
    if (labels[n] == 0) continue;
    out[n] = own(labels[n], index);
    mean += out[n];
    outwards += m_outwards[labels[n] - 1U];
    ++inner;
  }
  for (int n = 0; n < count; ++n) {
    out[n] = labels[n] == 0 ? outwards / inner - m_whole.at(index) : out[n] - mean / inner;
  }
}

bool LabelField::grow(const std::vector<double>& outwards_mm) {
  bool moves = false;
  for (std::size_t n = 0; n < m_growth.size(); ++n) {
    const double before = m_growth[n], most = m_most_outwards;
    m_growth[n] = std::clamp(before + outwards_mm[n], -2 * most, 2 * most);
    m_outwards[n] = std::clamp(m_growth[n], -most, most);
    moves |= m_growth[n] != before;
  }
  return moves;
}

}  // namespace supple

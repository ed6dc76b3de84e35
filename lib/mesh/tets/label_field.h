// Which label is at a place between voxels, from the smoothed distances of all labels.
//
// The body as a whole ends where the distance of all its voxels is zero, so that its surface shows
// nothing of the labels inside. Within it a place belongs to the label whose own distance is the
// least; so borders have neither gaps nor overlaps. A label may grow by some part of a voxel.
// Source: J. R. Bronson, J. A. Levine, R. T. Whitaker, Lattice cleaving: conforming tetrahedral
// meshes of multimaterial domains with bounded quality, Proc. 21st International Meshing
// Roundtable, 2013 (the largest of indicator functions).
// Cost: that of one distance per label, in the box around it, and one of the whole.
#pragma once

#include <array>
#include <vector>

#include "lib/mesh/tets/mask_distance.h"

namespace supple {

/// A label by its place among those of the field, from 1 on; 0 is around the body.
using LabelNumber = std::uint16_t;

/// The labels that meet at a node.
class LabelSet {
 public:
  LabelSet() = default;
  explicit LabelSet(LabelNumber only) { add(only); }

  /// Adds a label; what is beyond kMost is left out.
  void add(LabelNumber label) {
    if (!holds(label) && m_count < kMost) m_labels[m_count++] = label;
  }
  void add(const LabelSet& others) {
    for (const LabelNumber label : others) add(label);
  }
  bool holds(LabelNumber label) const { return std::find(begin(), end(), label) != end(); }
  bool meets(const LabelSet& other) const {
    return std::any_of(begin(), end(), [&](LabelNumber label) { return other.holds(label); });
  }
  const LabelNumber* begin() const { return m_labels.data(); }
  const LabelNumber* end() const { return m_labels.data() + m_count; }
  int size() const { return m_count; }

 private:
  static constexpr std::uint8_t kMost = 15;
  std::array<LabelNumber, kMost> m_labels{};
  std::uint8_t m_count = 0;
};

class LabelField {
 public:
  /// `label_of` empty: one label. `sigma_voxels` as MaskDistance has it; `spacing_mm` of the
  /// lattice that is to be cleaved. Throws InputError, field "label", for more labels than a
  /// LabelNumber counts.
  LabelField(const VoxelMask& mask, const VoxelLabel& label_of, double sigma_voxels,
             double spacing_mm, Progress* progress = nullptr);

  /// Labels, ascending, and the volumes of their voxels; the label with number n is the (n - 1)th.
  const std::vector<std::int32_t>& labels() const { return m_labels; }
  const std::vector<double>& volumes_mm3() const { return m_volumes; }

  /// The label at a place of the volume's grid.
  LabelNumber at(const Vec3d& index) const;
  /// The label of a set that is at a place, or nearest to be.
  LabelNumber best(const LabelSet& among, const Vec3d& index) const;
  /// Some mm by which a place is farther from `a` than from `b`: negative on a's side. Sets share
  /// no label.
  double beyond(const LabelSet& a, const LabelSet& b, const Vec3d& index) const;
  /// Distances of a few labels, less what is common to them: equal where labels meet.
  void levels(const LabelNumber* labels, int count, const Vec3d& index, double* out) const;
  /// True if no label grows as far as here.
  bool is_surely_outside(const Vec3d& index) const { return m_whole.at(index) > m_most_outwards; }

  /// Moves the surfaces of labels outwards, each in all by half a voxel at most or, where that is
  /// more, by what a chord of the lattice's spacing cuts off from a circle of its radius, an eighth
  /// of it; false if none moves.
  bool grow(const std::vector<double>& outwards_mm);
  const std::vector<double>& outwards_mm() const { return m_outwards; }

 private:
  double own(LabelNumber label, const Vec3d& index) const {
    return (m_parts.empty() ? 0 : m_parts[label - 1U].at(index)) - m_growth[label - 1U];
  }

  MaskDistance m_whole;
  std::vector<MaskDistance> m_parts;  // of each label; none where there is one alone
  std::vector<std::int32_t> m_labels;
  std::vector<double> m_volumes;
  std::vector<double> m_growth;    // against other labels: a border moves by half their difference
  std::vector<double> m_outwards;  // the same within m_most_outwards
  double m_most_outwards;
};

}  // namespace supple

// Metrics of a deformation at the elements of a body, or at the voxels of a warp: how far they
// moved, how their volume changed, where the material folded, how much the motion bends. All at the
// places that the vectors belong to: those of a body are in the material frame, where the value at
// voxel X is that of the tissue that was at X.
//
// F = I + grad u by central differences over the elements (one-sided at the surface and at cuts, as
// ITK's displacement Jacobians are inside; no difference along an axis where neither neighbour is
// there). Folds are those of trilinear cells: det F <= 0 somewhere in a cell of eight elements
// none of whose links is cut (design.md section 4).
//
// The bending energy density is the squared Frobenius norm of the second derivatives of u in mm by
// mm, mixed ones counted twice: that of Rueckert et al., "Nonrigid registration using free-form
// deformations", IEEE TMI 18 (1999), eq. 4, and of elastix's TransformBendingEnergyPenalty. It is
// taken by central differences where all 18 neighbours by face and edge are there and linked. There
// is none along an axis on which the grid has but one voxel.
// Cost: 150 ns per element and core, 12 bytes per element's brick voxel for the maps.
#pragma once

#include <functional>
#include <map>
#include <optional>

#include "volumes/base/value.h"
#include "volumes/field/offset_field.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_values.h"
#include "volumes/grid/link_cuts.h"

namespace supple {

/// Sums and extremes of a set of elements. Lengths in mm, volumes in mm^3.
struct DeformationSummary {
  std::int64_t elements = 0;
  std::int64_t moved = 0;  // by more than 1e-6 mm
  double mean_mm = 0;
  double rms_mm = 0;
  double median_mm = 0;
  double p95_mm = 0;
  double max_mm = 0;
  double rest_volume_mm3 = 0;
  double volume_mm3 = 0;  // sum of det F times the voxel's volume
  double min_jacobian = 1;
  double max_jacobian = 1;
  double sd_log_jacobian = 0;              // standard deviation of ln det F, where it is above 0
  std::int64_t nonpositive_jacobians = 0;  // elements with det F <= 0
  std::optional<double> bending_per_mm2;   // mean density of the bending energy, where there is one
  std::int64_t folded_cells = 0;           // those whose lowest corner is an element

  /// Relative change of volume: 0.02 is 2 % more.
  double volume_change() const { return volume_mm3 / rest_volume_mm3 - 1; }
};

/// A table of all of it, with units in the names.
Value to_value(const DeformationSummary& summary);

/// Values at the elements, [512 * b + offset] in the order of `elements`.
struct DeformationMaps {
  BrickTopology elements;
  std::vector<float> length_mm;
  std::vector<float> jacobian;
  std::vector<float> bending_per_mm2;  // NaN where neighbours are missing
  std::vector<BrickMask> folded;
};

enum class DeformationMap { length_mm, jacobian, folded, bending_per_mm2 };
/// Writes the map on the grid of voxels 0 to `dims`, slice by slice: 1 around the elements for det
/// F, 0 for all others and where there is no bending. Refers to the maps.
std::function<void(int k, float* out)> slices_of(const DeformationMaps& maps, DeformationMap which,
                                                 const Vec3i& dims);

/// `u` is valid at all elements. Throws InputError when a value is not finite.
DeformationMaps map_deformation(const Displacement& u, const BrickTopology& elements,
                                const LinkCuts& cuts);

/// The summary of all elements, or of those whose `mask` is not 0.
DeformationSummary summarize(const DeformationMaps& maps, const Geometry& geometry,
                             const BrickValues* mask = nullptr);
/// The summary of each label; 0 stands for the elements without one. `labels` may be empty.
std::map<std::int32_t, DeformationSummary> summarize_labels(const DeformationMaps& maps,
                                                            const BrickValues& labels,
                                                            const Geometry& geometry,
                                                            const BrickValues* mask = nullptr);

}  // namespace supple

// Parameters of a relaxation (relaxation.h), its report (lib/model/relax_model.h), and the forces
// on handles that follow from its energy (reaction.h).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "volumes/base/fields.h"
#include "volumes/base/vec.h"

namespace supple {

enum class RelaxMethod {
  plain,        // all nodes at once, whole steps, no limits: the thesis' rule, breaks links
  jacobi,       // all nodes at once, each takes up to half of a link's slack
  red_black,    // every other node at once, up to the whole slack
  accelerated,  // red-black with over-relaxation: far fewer passes to the same energy
};
const char* name_of(RelaxMethod method);

/// True for methods that can conserve volume, in which elements of a cell do not step together.
bool conserves_volume(RelaxMethod method);

/// A number of passes beyond this is taken for a mistake.
constexpr int kMaxPasses = 1000000;

struct RelaxParams {
  RelaxMethod method = RelaxMethod::accelerated;
  int passes = 20;  // at most
  /// Stops after a pass in which no element moved further, in voxels of each axis, once the forces
  /// that are left agree (RelaxModel).
  double tolerance_voxels = 0;
  /// Bulk modulus with which cells keep their rest volume (volume_relaxation.h); 0: they do not.
  /// Only with the methods red_black and accelerated.
  double bulk_modulus_kpa = 0;
  /// Bulk moduli follow from the material instead (cell_moduli.h).
  bool poisson = false;
  /// Ends after the pass in which this many million elements were looked at, one by one in each
  /// pass and coordinate; 0: no limit. Work and not time, so that the result is the same on every
  /// machine. With a budget the forces are asked less often whether they agree.
  double budget_million = 0;
  /// A brick in which a pass steps no further, in voxels, counts as one at rest, so that it and its
  /// neighbours are left out of the next; with diagonal links whose nodes step in turns.
  double still_voxels = 0;

  bool conserves_volume() const { return bulk_modulus_kpa > 0 || poisson; }
  /// Throws InputError: a value out of range.
  void validate() const;
};

/// Relaxation after a drag in tissue whose material asks for it (MaterialTable::relaxes): until it
/// has settled to a hundredth of a voxel, or its budget is spent.
/// `poisson`: as RelaxParams::poisson; MaterialTable::relaxes_by_poisson.
RelaxParams tissue_relaxation(bool poisson = false);

/// The fields of `relax = { … }` in a scene.
Fields fields(RelaxParams& params);

struct CellVolumes {
  std::int64_t cells = 0;
  double rest_mm3 = 0;
  double total_mm3 = 0;
  double smallest = 1, largest = 1;  // of a cell, in its rest volume

  /// Total over rest volume; 1 for a body without cells.
  double ratio() const { return rest_mm3 > 0 ? total_mm3 / rest_mm3 : 1; }
};

/// Reasons why passes ended: as many as were asked for, nothing moved any more, forces and steps
/// agree (RelaxReport::converged), or the work that was allowed is done.
enum class RelaxEnd { passes, at_rest, converged, budget };
const char* name_of(RelaxEnd end);

struct RelaxReport {
  std::int64_t projected_links = 0;  // of an invalid start
  double projected_max_voxels = 0;
  std::int64_t projected_held = 0;  // elements that are held but that it had to move
  /// Links that a diagonal's limit moved back after the last pass where volume is conserved, and
  /// how far. The energy is the one after that. 0 with 6 links.
  std::int64_t diagonal_links = 0;
  double diagonal_max_voxels = 0;
  int passes = 0;
  double looked_at_million = 0;  // elements, in each pass and coordinate by itself
  /// The last pass moved nothing further than the tolerance, and the forces that are left put the
  /// energy within 1 % of the least, or within a millionth of the energy before. Where volume is
  /// conserved, the step alone decides.
  bool converged = false;
  RelaxEnd end = RelaxEnd::passes;
  std::optional<double> energy_excess;         // uJ, at most so far above the least; when looked at
  double energy_before = 0, energy_after = 0;  // uJ (N/m * mm^2)
  double largest_step_voxels = 0;              // of the last pass
  std::int64_t yielded_links = 0;              // whose rest stretch followed
  /// Set where volume is conserved; the modulus is the mean of those that follow from the material.
  double bulk_modulus_kpa = 0;
  std::optional<CellVolumes> volumes_before, volumes_after;
  double milliseconds = 0;  // from the model's making
};

struct Reaction {
  /// Force with which the body pulls at the holder, in N, LPS. Its work on a way dx is force . dx,
  /// also where the grid's axes are not perpendicular.
  Vec3d force_n{0, 0, 0};
  /// Per grid coordinate: links at their limits join this holder to another one. They can carry any
  /// force between the two, which statics does not determine: the force is then a part only.
  std::array<bool, 3> taut{false, false, false};
};

}  // namespace supple

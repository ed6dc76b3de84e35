// Elastic relaxation of a body under the limits of its links (thesis section 4.2.3, "Elastic
// Relaxation"; design.md section 3).
//
// The energy is that of springs at rest in the undeformed body, per coordinate as in the thesis:
//   E = sum over links and coordinates of k (u_b - u_a)^2 / 2
// with k = Young's modulus * area / length. Nodes step towards the stiffness-weighted mean of their
// neighbours. The thesis lets every step be whole, which breaks limits; here a step ends where a
// limit would break: the body is a valid Enhanced ChainMail configuration after every pass, and the
// energy never rises.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/body/slot_set.h"
#include "lib/relax/cell_volume.h"
#include "lib/relax/relax_report.h"
#include "volumes/base/fields.h"
#include "volumes/base/progress.h"

namespace supple {

/// Links of a voxel that are springs, 6, 18 or 26: all that the body has, or those along the axes
/// where volume is conserved.
int spring_links(const Body& body, bool conserves_volume);

/// A bulk modulus beyond this is taken for a mistake: water has 2.2e6 kPa.
constexpr double kMaxBulkModulusKpa = 1e9;
/// Throws InputError for a value outside 0 to kMaxBulkModulusKpa.
void check_bulk_modulus(double kpa);

struct CellModuli;
class CoordinateRelaxation;
class VolumeRelaxation;

/// Relaxes one body. Between passes nothing is lost: the body's offsets and their fractions are
/// those of the last finished pass once store() was called.
class Relaxation {
 public:
  /// `held.anchored` and `fixed` stay; elements of push handles stay at or beyond where they were
  /// pushed to. The body is a valid one (for method plain any) and must not change while this
  /// lives. Throws InputError: params out of range, springs that yield in a body with diagonals.
  Relaxation(Body& body, const SlotSet& fixed, const Holds& held, const RelaxParams& params);
  /// The same with the moduli of these parameters (moduli_of()), where they are known already.
  Relaxation(Body& body, const SlotSet& fixed, const Holds& held, const RelaxParams& params,
             const CellModuli& moduli);
  ~Relaxation();

  /// Makes a pass over all coordinates that have moved, or all where volume is conserved; returns
  /// the largest step in voxels.
  double pass();
  /// Energy before the last pass, in uJ, cells included: known after each pass.
  double energy_before_pass() const { return m_energy; }
  /// Energy now, in uJ; as much work as a pass.
  double energy();
  /// An upper bound of how far the energy is above the least, in uJ, from the forces that are left
  /// (excess_energy.h); none where volume is conserved.
  std::optional<double> excess() const;
  /// Writes the offsets to the body: again a valid configuration, with fractions and without.
  void store();
  /// Elements looked at so far, each coordinate by itself.
  double work() const { return m_work; }
  std::size_t bytes() const;

 private:
  Body& m_body;
  std::array<std::unique_ptr<CoordinateRelaxation>, 3> m_coordinates;
  std::unique_ptr<VolumeRelaxation> m_volume;  // in their stead
  double m_energy = 0;
  double m_work = 0;
};

/// The elements that stay: those of the regions and of two-sided handles. Throws InputError: a
/// region without element.
SlotSet anchored_elements(const Body& body, const std::vector<Region>& fixed, const Holds& held);

}  // namespace supple

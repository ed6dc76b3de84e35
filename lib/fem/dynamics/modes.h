// The lowest modes of vibration of a body (thesis appendix A):
//
//   K phi = omega^2 M phi,  phi^T M phi = 1
//
// with phi = 0 where the body is held. A body that nothing holds has six rigid motions per piece,
// which are recognised and left out.
//
// Shift-invert Lanczos with implicit restarts (Spectra): vectors are multiplied by (K + s M)^-1 M,
// which conjugate gradients with the multigrid cycle do without a matrix (conjugate_gradients.h). s
// is 0 where the body is held, and small against the lowest omega^2 of a compact body otherwise.
// Krylov spaces of one vector see one mode of several alike, as a square bar has them, until
// rounding shows the others. So what was found is taken out, and the lowest of the rest is sought:
// where it is lower than the last one found, it is taken in and the search repeated.
//
// Cost: some 30 solutions for ten modes. Memory: 16 bytes per unknown and mode for the results, 8
// for each of the 20 or 2 count + 1 vectors of Lanczos, and that of one solution.
#pragma once

#include <vector>

#include "lib/fem/dynamics/mass.h"
#include "lib/fem/elastic_solid.h"
#include "lib/fem/fem_solution.h"

namespace supple {

struct ModeParams {
  int count = 10;
  /// Largest |K phi - omega^2 M phi| relative to |K phi|.
  double tolerance = 1e-5;
  int max_iterations = 400;                 // of each linear system
  LooseIslands loose = LooseIslands::hold;  // of a body that is held somewhere

  /// Throws InputError.
  void validate() const;
};

struct VibrationMode {
  double frequency_hz = 0;
  double eigenvalue_per_s2 = 0;  // omega^2
  double residual = 0;           // |K phi - omega^2 M phi| / |K phi|
  /// phi^T M e for a motion by 1 along each axis of LPS, in kg^1/2; its squares are the masses that
  /// take part.
  Vec3d participation_kg_half{0, 0, 0};
  /// phi in kg^-1/2, three per node of the mesh; its largest component is positive.
  std::vector<double> shape;

  Vec3d effective_mass_kg() const { return participation_kg_half * participation_kg_half; }
};

struct VibrationModes {
  std::vector<VibrationMode> modes;  // ascending
  ModesReport report;
};

/// The lowest modes of the body with the `held` components of nodes at rest.
/// Throws InputError (more modes than half of what can move, a value out of range, loose islands
/// that are refused), NotConverged, Cancelled.
VibrationModes lowest_modes(const ElasticSolid& solid, const MassDensities& density, HeldBits held,
                            const ModeParams& params = {}, Progress* progress = nullptr);

}  // namespace supple

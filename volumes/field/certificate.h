// The certificate of an inversion: residuals, folds, unresolved voxels.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/base/value.h"

namespace supple {

/// Worst cases of an inversion; see design.md section 4.
struct InversionCertificate {
  double residual_max = 0;        // max |x + o + u(x + o) - x| in voxels over valid nodes off folds
  double residual_p999 = 0;       // its 99.9th percentile
  std::int64_t cells = 0;         // source cells with eight valid corners
  std::int64_t folded_cells = 0;  // cells with det F <= 0 somewhere
  std::int64_t folded_air_cells = 0;   // of them, those with a corner outside the material
  std::int64_t unresolved_voxels = 0;  // covered by a deformed cell's tetrahedra, yet no solution
  std::vector<Vec3i> unresolved;       // at most 1000 of them
  double min_det = 1;           // smallest det F = det(I + grad u) at a corner of a cell of tissue
  std::int64_t torn_cells = 0;  // cells that a cut has opened (cut_offsets.h)
  std::int64_t overlapped_voxels = 0;  // voxels that tissue from several places covers
  std::int64_t hidden_elements = -1;  // elements that are not seen where they went; -1: not counted
  bool of_part = false;               // only some offsets were wanted, and all counts are of these
};

/// Without the list of unresolved voxels.
Value to_value(const InversionCertificate& certificate);

}  // namespace supple

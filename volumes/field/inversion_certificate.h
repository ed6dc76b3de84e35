// The independent measurement of an inversion: u is evaluated anew at x + o(x), by look-up, with
// none of the solver's cell coordinates. Cost: about 50 ns per moved node, 2 ns per unmoved one.
#pragma once

#include "volumes/field/vector_bricks.h"

namespace supple {

/// Fills residual_max and residual_p999 over the nodes of `o` whose source cell is not in
/// `folded` (cells per brick of u). The percentile is the upper end of a histogram bin, at most
/// 12.5 % too large.
void measure_residuals(const VectorBricks& u, const VectorBricks& o,
                       const std::vector<BrickMask>& folded, InversionCertificate& certificate);

}  // namespace supple

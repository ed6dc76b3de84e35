// How long an explicit step may be: from the largest eigenvalues of M^-1 K and M^-1 D.
//
// A spring's second derivative is at most k in every direction where it is not compressed, and less
// across it where it is: whatever the configuration, K is at most the graph Laplacian of the
// stiffnesses, times the identity in three dimensions. The Laplacian is at most its signless twin,
// a matrix without negative entries, whose largest eigenvalue lambda lies by Collatz and Wielandt
// below max_i (A x)_i / x_i for every positive x, tighter with every power iteration. Both are
// equal on bipartite meshes (chains, lattices without diagonals); elsewhere the limit is on the
// safe side.
#pragma once

#include "lib/springs/spring_system.h"
#include "volumes/base/progress.h"

namespace supple {

/// Upper bounds, with held nodes at rest; closer than 0.1 % to the signless eigenvalue, or as close
/// as 1000 iterations come.
struct SpectralBounds {
  double stiffness_1_s2 = 0;  // of M^-1 K: omega^2
  double damping_1_s = 0;     // of M^-1 D, mass damping included
};
/// Throws Cancelled.
SpectralBounds spectral_bounds(const SpringSystem& system, const Progress* progress = nullptr);

/// Largest stable step of symplectic Euler in s: dt^2 omega^2 + 2 dt gamma < 4; infinite when
/// nothing moves. For an undamped mass on a spring k dt^2 / m < 4; for a wide square membrane
/// k dt^2 / m < 0.5.
double stable_step_s(const SpectralBounds& bounds);

}  // namespace supple

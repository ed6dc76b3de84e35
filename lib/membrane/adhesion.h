// Adhesion: a link from every node that clings to its place at rest, an isotropic spring of
// k = 2 G A / d^2 for the energy per area G, the node's area A and the breaking stretch d. It
// breaks at the force 2 G A / d, at which it holds the energy G A.
//
// Energy of a peeled area is G as long as breaking links lose no more than they hold. A lifted
// strip of length L stretches by its own stiffness E t under the force 2 G s of a row that breaks
// (rows s apart), and loses that energy, too: 2 G s L / (d^2 E t) of what the row held. The mean
// force of peeling is therefore G per width only where d >= s sqrt(2 G L / (0.05 s E t)) or so;
// links that are stiffer peel harder than G says.
#pragma once

#include "lib/membrane/sheet.h"

namespace supple {

/// Breaks links whose force of a substep of `h` seconds passes their limit. They never come back.
/// Adds an event.
void break_links(Sheet& sheet, const MembraneParams& params, double h, MembraneReport& report);

/// Sets multipliers of links by their stretch alone, as if a substep of `h` had ended at rest.
void load_links(Sheet& sheet, const MembraneParams& params, double h);

}  // namespace supple

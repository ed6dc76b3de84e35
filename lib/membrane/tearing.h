// Tears along edges. A node splits where an edge at it carries more than the strength: its fan
// of triangles parts along the edges that are most perpendicular to the load (after M. Mueller et
// al., Position based dynamics, 2007, section 4.3, whose plane of splitting these edges stand
// for). Nodes at which the fan then falls apart split as well, so that the mesh stays a manifold
// with boundary and has no triangle that it did not have before.
#pragma once

#include "lib/membrane/sheet.h"

namespace supple {

/// Tears where multipliers of a substep of `h` seconds pass the strength, the highest load first,
/// at each node once. The forceps keep one side of a node that splits there; where neither end of
/// an edge can split, both slip out of them. Adds an event.
void tear(Sheet& sheet, const MembraneParams& params, double h, MembraneReport& report);

/// Removes torn-off pieces below the smallest area. Adds an event for each.
void lose_pieces(Sheet& sheet, const MembraneParams& params, MembraneReport& report);

}  // namespace supple

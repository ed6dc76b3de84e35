// The volume of cells: a cell is spanned by 8 adjacent elements that all of its 12 links join
// (thesis section 4.2.4).
//
// Its faces are bilinear patches, so that cells leave no gaps between them, and its volume is that
// of the trilinear hexahedron, exactly. Such a volume is linear in each corner: with
// e1, e2, e3 the corners along its edges and f12, f23, f31 those across its faces, all relative to
// corner p and right-handed,
//   dV/dp = -sum over the three faces of ((e1 - e2) x f12 + e1 x e2) / 12,
// which does not depend on p.
#pragma once

#include <array>
#include <cstdint>

#include "lib/body/body.h"
#include "lib/relax/relax_report.h"

namespace supple {

/// Corner 4 i + 2 j + k of a cell lies (i, j, k) steps from its lowest one.
using Hexahedron = std::array<Vec3d, 8>;

/// Signed volume: negative where the cell is inside out. Grandy 1997, "Efficient computation of
/// volume of hexahedral cells".
double hexahedron_volume(const Hexahedron& corners);
/// Derivative of the volume by the place of one corner; the opposite corner has no part in it.
Vec3d hexahedron_gradient(const Hexahedron& corners, int corner);

/// Sums the volumes of all cells of the body, in parallel; costs only where something moved.
CellVolumes cell_volumes(const Body& body);

}  // namespace supple

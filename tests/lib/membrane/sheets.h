// Sheets, forceps and judges that tests of membranes share.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lib/membrane/membrane.h"

namespace supple::test {

/// A flat sheet at z = 0 of rows along y, `length` cells long along x and `width` wide, which winds
/// counter-clockwise seen from +z.
TriangleMesh flat_sheet(int length, int width, double cell_mm);

/// Ground below z = 0.
Obstacle plane_ground();

/// Forceps without parts whose grip is a ball about the tip; they close below 5 degrees and open
/// above 8.
Instrument ball_forceps(double radius_mm);

InstrumentPose pose_at(const Vec3d& tip_mm, double opening_degrees);

/// A motion of instrument 0.
std::vector<ToolMotion> motion(const Instrument& instrument, const InstrumentPose& from,
                               const InstrumentPose& to);

std::int64_t count_of(const MembraneReport& report, MembraneEvent::Kind kind);

/// What makes the membrane's mesh no manifold with boundary, from its triangles alone; empty:
/// nothing. Looks at sides, fans, links, areas at rest and positions.
std::string fault_of(const MeshBody& body);

/// Corners at rest of all triangles, ascending: what tears part keeps its shape.
std::vector<std::array<double, 9>> rest_triangles(const MeshBody& body);

/// Triangles that face against the mean of those beside them or have no area, from triangles and
/// places alone.
int facing_back(const MeshBody& body);

/// Ends of edges of one triangle only that had two in a mesh before, by their places at rest.
std::vector<Vec3d> torn_places(const MeshBody& before, const MeshBody& after);

}  // namespace supple::test

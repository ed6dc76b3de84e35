// State of a membrane in flat arrays: nodes, springs along edges, links of adhesion.
//
// A spring's stiffness follows from the sheet's: k = E t A / L^2 with the area A of the triangles
// at the edge and its length L at rest (A. Van Gelder, Approximate simulation of elastic membranes
// by triangulated spring meshes, 1998). Regular triangles give E t sqrt(3) / 2. The width that an
// edge stands for is A / L: in regular triangles under tension along one edge direction, springs
// along it carry E t times the strain times that width, and the others nothing.
//
// Units: mm, kg, s. Stiffnesses in N/m are forces in mN per mm; multipliers are forces times h^2.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/membrane/membrane.h"
#include "lib/mesh/mesh_body.h"

namespace supple {

struct SheetSpring {
  int a, b;
  double rest_mm, stiffness_n_m;
  double width_mm;        // that it stands for; 0: a spring of bending
  double multiplier = 0;  // of this substep, in kg mm
};

/// All per node but where said.
struct Sheet {
  MeshBody body;
  std::vector<Vec3d> start_mm;  // of this substep
  std::vector<double> area_mm2, mass_kg;
  std::vector<double> mobility;  // 1 / mass; 0 where held
  std::vector<int> holder;       // tool that grips it, -1: none
  std::vector<Vec3d> grip_mm;    // place in the frame of its tool
  std::vector<char> clings, is_torn;
  std::vector<Vec3d> anchor_mm;
  std::vector<Vec3d> link_multiplier;          // of this substep, in kg mm
  std::vector<double> triangle_mm2;            // per triangle, at rest
  std::vector<std::vector<int>> triangles_at;  // ascending
  std::vector<std::vector<int>> springs_at;    // no springs of bending
  std::vector<SheetSpring> springs, bending;
  std::int64_t version = 0;
  double torn_mm = 0;

  int node_count() const { return int(body.pos_mm.size()); }
};

/// Throws InputError: a mesh that is no manifold with boundary, that winds both ways, or that has a
/// triangle without an area.
Sheet make_sheet(const TriangleMesh& mesh, const MembraneParams& params);

/// Set mass and mobility by area and grip.
void weigh(Sheet& sheet, int node, const MembraneParams& params);

/// Corner of a triangle that follows `node`, and the one after that.
int corner_after(const TriangleNodes& triangle, int node);
int corner_before(const TriangleNodes& triangle, int node);

/// Neighbours of a node in the order in which its triangles wind; triangle n lies between
/// neighbours n and n + 1. Closed fans go on from the last one to the first.
struct NodeFan {
  std::vector<int> neighbours, triangles;
  bool is_closed = false;
};
/// Fans of a node, one where the mesh is a manifold.
std::vector<NodeFan> fans_of(const Sheet& sheet, int node);

/// Make springs of bending and the body's links anew after triangles have changed.
void renew_bending(Sheet& sheet, const MembraneParams& params);
void renew_links(Sheet& sheet);

/// Triangles that face against the mean of those beside them, or have no area.
int inverted_triangles(const Sheet& sheet);

double link_stiffness_n_m(const MembraneParams& params, double area_mm2);
MembraneEnergy energy_of(const Sheet& sheet, const MembraneParams& params);

}  // namespace supple

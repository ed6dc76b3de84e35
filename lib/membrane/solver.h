// Substeps of a membrane of springs by XPBD (lib/springs/xpbd.h has the formulas).
//
// Sweeps alternate in direction. Each goes over springs, links of adhesion (isotropic, so that
// their multiplier is a vector), tools and the ground, which has the last word. Few sweeps leave
// the sheet softer than it is: what breaks then depends on the substep, which is therefore fixed.
#pragma once

#include "lib/membrane/sheet_ground.h"
#include "lib/membrane/tool_push.h"

namespace supple {

struct SubstepSurroundings {
  SheetGround& ground;
  ToolPush& tools;
};

/// Moves all nodes that no one holds by velocity, of which damping takes a part.
void predict(Sheet& sheet, const MembraneParams& params);

/// Solves one substep and sets velocities; held nodes are in their places already.
void solve(Sheet& sheet, const MembraneParams& params, SubstepSurroundings around);

/// Adds the forces in mN of springs and links at held nodes, each times `weight`, by tool.
void add_grip_forces(const Sheet& sheet, double h, double weight, std::vector<Vec3d>& by_tool_mn);

}  // namespace supple

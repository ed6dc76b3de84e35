// Cuts: removing the links that a surface crosses, so that both sides move independently.
//
// A cut is made in the undeformed body: surfaces are taken at rest, in the material frame, however
// far the elements have moved since. Vertices go to index space, are shifted by (3.0, 3.3, 3.7)e-5
// voxel, so that no lattice-aligned plane passes through voxel centres, and rounded to 2^-24 voxel.
// From there on everything is exact in integers: per triangle and axis, the lattice lines inside
// its projection (edges included) are intersected with it and the link floor(t) is crossed. Shared
// vertices round alike, so a closed surface leaves no link between its inside and its outside. Each
// cut link keeps where it was crossed, so that faces are where the surface was; of several surfaces
// through one link the first counts.
//
// Cost: about 100 ns per lattice line that the projections of a triangle cover inside the bounds of
// the elements; nothing depends on the volume.
#pragma once

#include <cstdint>
#include <functional>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

/// A parallelogram in LPS mm: corner + s edge1 + t edge2, s and t in 0…1, edges included: it cuts
/// the links through them.
struct PlanePatch {
  Vec3d corner_lps_mm;
  Vec3d edge1_lps_mm;
  Vec3d edge2_lps_mm;
};

struct CutReport {
  std::int64_t crossed = 0;     // links between elements that the surface crosses
  std::int64_t newly_cut = 0;   // those of them that were not cut before
  std::int64_t degenerate = 0;  // triangles without area, which cross nothing
};

/// Adds the crossed links to body.cuts. Throws InputError, with the body unchanged, for a vertex
/// that is not finite or beyond +-131,071 voxels.
CutReport cut(Body& body, const TriangleMesh& surface);
CutReport cut(Body& body, const PlanePatch& patch);

/// Cuts the links of which exactly one end is `inside`: the boundary of a label.
CutReport cut_boundary(Body& body, const std::function<bool(Slot)>& inside);
/// Cuts the links whose ends `parts` chooses.
CutReport cut_links(Body& body, const std::function<bool(Slot low, Slot high)>& parts);

}  // namespace supple

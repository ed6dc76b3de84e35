// The mesh of tetrahedra of a body, ready for a step: regions, materials, named faces, and where
// the elements of the body are in it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lib/body/body.h"
#include "lib/session/tet_step.h"
#include "lib/session/tets/voxel_sites.h"
#include "volumes/base/progress.h"

namespace supple {

struct TetBody {
  SolidMesh mesh;
  std::vector<VoxelSite> sites;
  std::vector<double> density_kg_m3;               // per material of the mesh
  std::vector<std::array<std::int32_t, 3>> outer;  // faces of the surface, seen from outside
  double voxels_ml = 0;
  std::int64_t unmeshed = 0, far = 0;  // voxels, as TetRecord
};

/// A mesh and what it was made of: settings and material as text, elements and cuts.
struct KeptTets {
  std::string key;
  BrickTopology elements;
  LinkCuts cuts;
  TetBody body;
};

/// Throws InputError: an opening without faces, hexahedra, a mesh that is not of the body, a
/// material without stiffness, as make_tets() and read_solid_mesh(); Cancelled.
TetBody make_tet_body(const TetStep& step, const Body& body, const DensityGrid& density,
                      const BrickValues& labels, Progress* progress);

/// The name of the faces between two labels of a mesh with labels.
std::string border_name(std::int32_t first, std::int32_t second);
/// The outer faces at these elements of the body, those within 60 degrees of `facing` where it is
/// given, under a name. Throws InputError where there is none.
FaceSet loaded_faces(const std::string& name, const SlotSet& elements,
                     const std::optional<Vec3d>& facing, const Body& body, const TetBody& tets);

}  // namespace supple

// CalculiX solves a mesh of tissue with stiffness from densities, as it was written; skipped where
// calculix-ccx is not installed.
#include <cmath>
#include <random>
#include <sstream>

#include <gtest/gtest.h>

#include "lib/fem/tet/tet_fem.h"
#include "lib/mesh/tets/element_materials.h"
#include "lib/mesh/tets/make_solid.h"
#include "tests/support/program.h"
#include "volumes/grid/voxel_sets.h"
#include "volumes/io/solid/solid_mesh_file.h"

namespace supple::test {
namespace {

const Vec3i kTissueDims(24, 16, 16);

/// Tissue of densities between 0 and 100 that vary smoothly, with a hard inclusion.
DensityGrid uneven_tissue() {
  const BrickTopology bricks = box_topology(kTissueDims);
  return fill_density_grid(
      bricks,
      [&](std::size_t b, float* out) {
        for (int n = 0; n < kBrickVoxels; ++n) {
          const Vec3d at(bricks.origin(b) + brick_local(n));
          const bool is_hard = (at - Vec3d(12, 8, 7)).length() < 4;
          out[n] = is_hard ? 100 : float(30 + 25 * std::sin(at.x / 4) * std::cos(at.y / 3));
        }
      },
      -1);
}

/// Nodes whose x is that of an end of the body.
std::vector<NodeIndex> end_nodes(const SolidMesh& mesh, bool last) {
  double end = last ? -1e9 : 1e9;
  for (const Vec3d& node : mesh.nodes_lps_mm) {
    end = last ? std::max(end, node.x) : std::min(end, node.x);
  }
  std::vector<NodeIndex> nodes;
  for (std::size_t n = 0; n < mesh.nodes_lps_mm.size(); ++n) {
    if (std::abs(mesh.nodes_lps_mm[n].x - end) < 1e-3) nodes.push_back(NodeIndex(n));
  }
  return nodes;
}

}  // namespace

TEST(InteropMeshJudges, CalculixFindsTheReactionOfUnevenTissueThatTheOwnSolverFinds) {
  if (!runs("command -v ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  const Geometry geometry(kTissueDims, Vec3d(0), {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1.5}});
  const VoxelMask mask = mask_of(geometry, box_topology(kTissueDims));
  SolidParams params;
  params.spacing_mm = 2.5;
  params.keeps_volume = false;
  params.smooth_voxels = 0;
  SolidMesh mesh = make_tets(mask, params);
  const ElasticOfLabels elastic = {{Curve{{{0, 2}, {100, 60}}}, Curve{{{0, 0.45}, {100, 0.3}}}},
                                   {}};
  give_materials(mesh, mask, uneven_tissue(), elastic, {}, 12);
  ASSERT_GT(mesh.materials.size(), 6u);
  const std::vector<NodeIndex> fixed = end_nodes(mesh, false), led = end_nodes(mesh, true);
  ASSERT_GT(fixed.size(), 20u);
  ASSERT_GT(led.size(), 20u);

  TetLoads loads;
  loads.held.push_back({fixed});
  loads.held.push_back({led, kAllHeld, {Vec3d(0.5, 0.2, 0)}});
  const TetSolution own = TetModel(mesh, TetElement::linear).solve(loads);

  const TemporaryFolder folder;
  write_solid_mesh(folder / "mesh.inp", mesh);
  std::ostringstream deck;
  deck << "*INCLUDE, INPUT=mesh.inp\n*NSET, NSET=led\n";
  for (const NodeIndex node : led) deck << node + 1 << ",\n";
  deck << "*STEP\n*STATIC\n*BOUNDARY\n";
  for (const NodeIndex node : fixed) deck << node + 1 << ", 1, 3, 0\n";
  for (const NodeIndex node : led) {
    deck << node + 1 << ", 1, 1, 0.5\n" << node + 1 << ", 2, 2, 0.2\n" << node + 1 << ", 3, 3, 0\n";
  }
  deck << "*NODE PRINT, NSET=led, TOTALS=ONLY\nRF\n*END STEP\n";
  write_text(folder / "pull.inp", deck.str());
  ASSERT_TRUE(runs("cd " + (folder / "") + " && ccx pull > log 2>&1")) << read_text(folder / "log");
  std::istringstream lines(read_text(folder / "pull.dat"));
  Vec3d total(0);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    Vec3d force;
    if (words >> force.x >> force.y >> force.z) total = force;
  }
  const Vec3d expected = own.reactions[1].force_n * -1000.0;  // mN; the body's pull, not the hold's
  EXPECT_GT(expected.length(), 10);
  EXPECT_LT((total - expected).length(), 1e-4 * expected.length()) << total << expected;
}

}  // namespace supple::test

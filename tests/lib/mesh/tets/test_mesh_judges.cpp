// Other programs read and solve a mesh of a cheek with stiffness from densities, as it was written;
// skipped where calculix-ccx or Python are not installed.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "lib/fem/tet/tet_fem.h"
#include "lib/mesh/tets/element_materials.h"
#include "lib/mesh/tets/make_solid.h"
#include "tests/support/program.h"
#include "volumes/grid/voxel_sets.h"
#include "volumes/io/solid/solid_mesh_file.h"
#include "volumes/phantom/phantom.h"

namespace supple::test {
namespace {

/// The left cheek of the head phantom: skin, fat, muscle, cheek bone and jaw.
class Cheek {
 public:
  Cheek() : m_head(head_phantom(Vec3i(96, 96, 54))) {
    const BrickTopology bricks = box_topology(m_head.geometry.dims());
    m_density = fill_density_grid(
        bricks,
        [&](std::size_t b, float* out) {
          for (int n = 0; n < kBrickVoxels; ++n) {
            const Vec3i v = bricks.origin(b) + brick_local(n);
            out[n] = m_head.density(v.x, v.y, v.z);
          }
        },
        -1000);
    std::vector<Vec3i> voxels;
    for (int k = kLo.z; k <= kHi.z; ++k) {
      for (int j = kLo.y; j <= kHi.y; ++j) {
        for (int i = kLo.x; i <= kHi.x; ++i) {
          if (m_density.at({i, j, k}) > -300) voxels.push_back({i, j, k});
        }
      }
    }
    m_mask = mask_of(m_head.geometry, topology_of(voxels));
    SolidParams params;
    params.spacing_mm = 5;
    m_mesh = make_tets(m_mask, params, 1, "cheek");
    const ElasticOfLabels elastic = {
        {Curve{{{-300, 3}, {60, 12}, {200, 40}, {1500, 4000}}}, Curve{{{0, 0.45}, {400, 0.3}}}},
        {}};
    give_materials(m_mesh, m_mask, m_density, elastic, {}, 24);
  }

  const SolidMesh& mesh() const { return m_mesh; }
  /// Nodes at the lower or upper end of the part.
  std::vector<NodeIndex> end_nodes(bool upper) const {
    std::vector<NodeIndex> nodes;
    for (std::size_t n = 0; n < m_mesh.nodes_lps_mm.size(); ++n) {
      const double k = m_mask.geometry.index_from_world(m_mesh.nodes_lps_mm[n]).z;
      if (upper ? k > m_mask.box.hi.z - 0.5 : k < m_mask.box.lo.z + 0.5) {
        nodes.push_back(NodeIndex(n));
      }
    }
    return nodes;
  }

 private:
  static constexpr int kBox[2][3] = {{58, 56, 8}, {80, 80, 26}};
  const Vec3i kLo{kBox[0][0], kBox[0][1], kBox[0][2]}, kHi{kBox[1][0], kBox[1][1], kBox[1][2]};
  Phantom m_head;
  DensityGrid m_density;
  VoxelMask m_mask;
  SolidMesh m_mesh;
};

const char* const kCompareDecks = R"(
import xml.etree.ElementTree as tree
nodes, tets, of_set, young, section = {}, {}, {}, {}, {}
block, head = None, {}
for line in open('mesh.inp'):
    line = line.strip()
    if line.startswith('**'): continue
    if line.startswith('*'):
        words = [w.strip() for w in line[1:].split(',')]
        block, head = words[0], dict(w.split('=') for w in words[1:])
        if block == 'SOLID SECTION': section[head['ELSET']] = head['MATERIAL']
        if block == 'MATERIAL': material = head['NAME']
        continue
    values = line.split(',')
    if block == 'NODE': nodes[int(values[0])] = [float(v) for v in values[1:]]
    if block == 'ELEMENT':
        tets[int(values[0])] = [int(v) for v in values[1:]]
        of_set[int(values[0])] = head['ELSET']
    if block == 'ELASTIC': young[material] = tuple(float(v) for v in values)
model = tree.parse('mesh.feb').getroot()
feb_nodes = {int(n.get('id')): [float(v) for v in n.text.split(',')] for n in model.find('Mesh/Nodes')}
assert feb_nodes == nodes and len(nodes) > 1000
constants = {m.get('name'): (float(m.find('E').text), float(m.find('v').text))
             for m in model.findall('Material/material')}
assert constants == young and len(young) > 12, (constants, young)
domain = {d.get('name'): d.get('mat') for d in model.findall('MeshDomains/SolidDomain')}
def element(corners, constants): return tuple(corners), constants
inp = sorted(element(tets[t], young[section[of_set[t]]]) for t in tets)
feb = sorted(element([int(v) for v in e.text.split(',')], constants[domain[part.get('name')]])
             for part in model.findall('Mesh/Elements') for e in part)
assert inp == feb and len(inp) > 5000
)";

}  // namespace

TEST(InteropMeshJudges, CalculixFindsTheReactionOfACheekThatTheOwnSolverFinds) {
  if (!runs("command -v ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  const Cheek cheek;
  const SolidMesh& mesh = cheek.mesh();
  ASSERT_GT(mesh.tets.size(), 5000u);
  ASSERT_GT(mesh.materials.size(), 12u);
  ASSERT_GT(mesh.materials.back().young_kpa, 50 * mesh.materials.front().young_kpa);
  const std::vector<NodeIndex> fixed = cheek.end_nodes(true), led = cheek.end_nodes(false);
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
  EXPECT_LT((total - expected).length(), 2e-6 * expected.length()) << total << expected;
}

TEST(InteropMeshJudges, ADeckForFebioHasTheNodesElementsAndStiffnessOfThatForCalculix) {
  if (!runs("/usr/bin/python3 -c 'import xml'")) GTEST_SKIP() << "python3 is not installed";
  const Cheek cheek;
  const TemporaryFolder folder;
  write_solid_mesh(folder / "mesh.inp", cheek.mesh());
  write_solid_mesh(folder / "mesh.feb", cheek.mesh());
  write_text(folder / "script.py", kCompareDecks);
  EXPECT_TRUE(runs("cd " + (folder / "") + " && /usr/bin/python3 script.py > log 2>&1"))
      << read_text(folder / "log");
}

}  // namespace supple::test

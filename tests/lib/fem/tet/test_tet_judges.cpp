// CalculiX solves the same tetrahedra; skipped where calculix-ccx is not installed.
#include <cmath>
#include <cstdio>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/lib/fem/tet/tet_fixtures.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Our ten nodes in the order of C3D10: corners, then the middles of 01, 12, 02, 03, 13, 23.
constexpr std::size_t kC3d10Order[10] = {0, 1, 2, 3, 4, 7, 5, 6, 8, 9};

template <class... Values>
void append(std::string& text, const char* format, Values... values) {
  char line[200];
  std::snprintf(line, sizeof line, format, values...);
  text += line;
}

/// A block of two materials, held at one end and at a few nodes led elsewhere, with forces.
struct JudgedBlock {
  SolidMesh mesh;
  std::unique_ptr<TetModel> model;
  TetLoads loads;

  JudgedBlock(TetElement element, double poisson) : mesh(tet_block({5, 4, 3}, {50, 36, 30}, 0.2)) {
    mesh.materials = {{"soft", 6, poisson}, {"firm", 80, 0.3}};
    for (const auto& tet : mesh.tets) {
      mesh.material_of.push_back(mesh.nodes_lps_mm[std::size_t(tet[0])].y > 17);
    }
    model = std::make_unique<TetModel>(mesh, element);
    TetHeld held;
    held.nodes = model->nodes_of_faces("x-");
    loads.held.push_back(held);
    loads.held.push_back(held_where(*model, [](const Vec3d& x) { return x == Vec3d(50, 36, 30); }));
    loads.held.back().displacement_mm = {Vec3d(1, -2, 0.5)};
    loads.held.back().components = 5;
    loads.pressures.push_back({"z+", 0.3});
    loads.gravity_m_s2 = Vec3d(0, 0, -9.81);
    loads.density_kg_m3 = {1040, 1100};
  }

  std::string deck(const char* type) const {
    std::string text = "*NODE, NSET=ALL\n", step;
    const NodalLoads nodal = model->nodal_loads(loads);
    for (std::size_t n = 0; n < model->place_count(); ++n) {
      const Vec3d& x = model->volumes().positions()[n];
      append(text, "%zu, %.12e, %.12e, %.12e\n", n + 1, x.x, x.y, x.z);
      for (std::size_t a = 0; a < 3; ++a) {
        if ((nodal.held[n] >> a & 1) == 0) continue;
        append(step, "%zu, %zu, %zu, %.12e\n", n + 1, a + 1, a + 1, nodal.u_mm[3 * n + a]);
      }
    }
    step += "*CLOAD\n";
    for (std::size_t at = 0; at < nodal.force_mn.size(); ++at) {
      append(step, "%zu, %zu, %.12e\n", at / 3 + 1, at % 3 + 1, nodal.force_mn[at]);
    }
    std::string materials;
    for (std::size_t of = 0; of < mesh.materials.size(); ++of) {
      append(text, "*ELEMENT, TYPE=%s, ELSET=E%zu\n", type, of);
      for (std::size_t e = 0; e < model->volumes().element_count(); ++e) {
        if (std::size_t(model->volumes().material_of(e)) != of) continue;
        append(text, "%zu", e + 1);
        const std::size_t count = model->volumes().elements().count(e);
        for (std::size_t n = 0; n < count; ++n) {
          append(text, ", %d", model->volumes().elements().nodes(e)[kC3d10Order[n]] + 1);
        }
        text += "\n";
      }
      append(materials, "*MATERIAL, NAME=M%zu\n*ELASTIC\n%.12e, %.12e\n", of,
             mesh.materials[of].young_kpa, mesh.materials[of].poisson);
      append(materials, "*SOLID SECTION, ELSET=E%zu, MATERIAL=M%zu\n", of, of);
    }
    return text + materials + "*STEP\n*STATIC\n*BOUNDARY\n" + step +
           "*NODE PRINT, NSET=ALL\nU\n*END STEP\n";
  }
};

std::vector<double> calculix_displacements(const std::string& deck) {
  const TemporaryFolder folder;
  write_text(folder / "block.inp", deck);
  EXPECT_TRUE(runs("cd " + (folder / "") + " && ccx block"));
  std::istringstream lines(read_text(folder / "block.dat"));
  std::vector<double> u;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    int node;
    double x, y, z;
    if (words >> node >> x >> y >> z) u.insert(u.end(), {x, y, z});
  }
  return u;
}

}  // namespace

TEST(InteropTet, CalculixFindsTheSameDisplacementsOfFourAndTenNodes) {
  if (!runs("which ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  for (const double poisson : {0.3, 0.48}) {
    for (const bool is_quadratic : {false, true}) {
      const JudgedBlock block(is_quadratic ? TetElement::quadratic : TetElement::linear, poisson);
      const std::vector<double> ours = block.model->solve(block.loads).u_mm;
      const std::vector<double> theirs =
          calculix_displacements(block.deck(is_quadratic ? "C3D10" : "C3D4"));
      ASSERT_EQ(ours.size(), theirs.size());
      double most = 0, off = 0;
      for (std::size_t n = 0; n < ours.size(); ++n) {
        most = std::max(most, std::abs(theirs[n]));
        off = std::max(off, std::abs(ours[n] - theirs[n]));
      }
      EXPECT_LE(off, 1e-6 * most) << "nu " << poisson << (is_quadratic ? ", ten nodes" : "");
      EXPECT_GT(most, 0.5);
    }
  }
}

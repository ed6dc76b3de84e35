// CalculiX bends the same plates by its shells; skipped where calculix-ccx is not installed.
#include <algorithm>
#include <array>
#include <map>

#include <gtest/gtest.h>

#include "tests/lib/fem/tet/calculix_decks.h"
#include "tests/lib/fem/tet/tet_fixtures.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A plate under pressure, whose rim lies on a support or is clamped.
struct JudgedPlate {
  static constexpr double kSide_mm = 100, kThickness_mm = 1, kYoung_kpa = 2500, kPoisson = 0.3,
                          kPressure_kpa = 1e-4;
  SolidMesh mesh;
  bool is_clamped;

  JudgedPlate(int n, bool clamped)
      : mesh(sheet_mesh(tet_block({n, n, 1}, {kSide_mm, kSide_mm, 1}), {"z-"})),
        is_clamped(clamped) {}

  static bool is_rim(const Vec3d& x) {
    return x.x == 0 || x.y == 0 || x.x == kSide_mm || x.y == kSide_mm;
  }
  std::vector<double> displacements() const {
    const TetModel model(mesh, TetElement::linear,
                         {{"sheet", SheetKind::both, kYoung_kpa, kPoisson, kThickness_mm}});
    TetLoads loads;
    loads.held.push_back(held_where(model, is_rim));
    loads.held.back().holds_turns = is_clamped;
    loads.pressures.push_back({"sheet", kPressure_kpa});
    std::vector<double> u = model.solve(loads, exact_params()).u_mm;
    u.resize(3 * model.place_count());
    return u;
  }
  /// The triangles as S6, with nodes in the middles of their edges.
  std::string deck() const {
    std::string nodes = "*NODE, NSET=CORNERS\n", middles = "*NODE\n", elements, held;
    std::map<std::array<std::int32_t, 2>, std::size_t> middle_of;
    std::size_t count = 0;
    const auto add = [&](const Vec3d& x, std::string& text) {
      append(text, "%zu, %.12e, %.12e, %.12e\n", ++count, x.x, x.y, x.z);
      if (is_rim(x)) append(held, "%zu, 1, %d\n", count, is_clamped ? 6 : 3);
    };
    for (const Vec3d& x : mesh.nodes_lps_mm) add(x, nodes);
    for (std::size_t t = 0; t < mesh.faces[0].triangles.size(); ++t) {
      const auto& corners = mesh.faces[0].triangles[t];
      append(elements, "%zu", t + 1);
      for (const std::int32_t corner : corners) append(elements, ", %d", corner + 1);
      for (std::size_t e = 0; e < 3; ++e) {
        const std::int32_t a = corners[e], b = corners[(e + 1) % 3];
        std::size_t& middle = middle_of[{std::min(a, b), std::max(a, b)}];
        if (middle == 0) {
          add((mesh.nodes_lps_mm[std::size_t(a)] + mesh.nodes_lps_mm[std::size_t(b)]) / 2, middles);
          middle = count;
        }
        append(elements, ", %zu", middle);
      }
      elements += "\n";
    }
    std::string section;
    append(section, "*MATERIAL, NAME=M\n*ELASTIC\n%g, %g\n", kYoung_kpa, kPoisson);
    append(section, "*SHELL SECTION, ELSET=E, MATERIAL=M\n%g\n*BOUNDARY\n", kThickness_mm);
    std::string step = "*STEP\n*STATIC\n";
    append(step, "*DLOAD\nE, P, %g\n*NODE PRINT, NSET=CORNERS\nU\n*END STEP\n", -kPressure_kpa);
    return nodes + middles + "*ELEMENT, TYPE=S6, ELSET=E\n" + elements + section + held + step;
  }
};

}  // namespace

// Shells of CalculiX are wedges with ten unknowns for one of ours, and have shear.
TEST(InteropTet, SheetsBendAsShellsOfCalculixToThreePartsInAHundred) {
  LEFT_OUT_WHEN_SANITIZED();
  if (!runs("which ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  for (const bool is_clamped : {false, true}) {
    std::vector<double> off;
    for (const int n : {16, 40}) {
      const JudgedPlate plate(n, is_clamped);
      off.push_back(difference(plate.displacements(), calculix_displacements(plate.deck())));
    }
    EXPECT_LE(off[1], 0.03) << ::testing::PrintToString(off);
    EXPECT_LE(off[1], off[0] / 2) << ::testing::PrintToString(off);
  }
}

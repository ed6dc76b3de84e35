// CalculiX solves the same tetrahedra; skipped where calculix-ccx is not installed.
#include <algorithm>
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "lib/fem/dynamics/modes.h"
#include "lib/fem/dynamics/newmark.h"
#include "lib/fem/tet/tet_system.h"
#include "tests/lib/fem/tet/calculix_decks.h"
#include "tests/lib/fem/tet/tet_fixtures.h"
#include "tests/support/program.h"
#include "volumes/base/units.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Our ten nodes in the order of C3D10: corners, then the middles of 01, 12, 02, 03, 13, 23.
constexpr std::size_t kC3d10Order[10] = {0, 1, 2, 3, 4, 7, 5, 6, 8, 9};

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

  /// Nodes, elements and materials, with `of_material` of each behind its name.
  template <class OfMaterial>
  std::string body_text(const OfMaterial& of_material) const {
    std::string text = "*NODE, NSET=ALL\n", materials;
    for (std::size_t n = 0; n < model->place_count(); ++n) {
      const Vec3d& x = model->volumes().positions()[n];
      append(text, "%zu, %.12e, %.12e, %.12e\n", n + 1, x.x, x.y, x.z);
    }
    const bool is_quadratic = model->volumes().element() == TetElement::quadratic;
    for (std::size_t of = 0; of < mesh.materials.size(); ++of) {
      append(text, "*ELEMENT, TYPE=%s, ELSET=E%zu\n", is_quadratic ? "C3D10" : "C3D4", of);
      for (std::size_t e = 0; e < model->volumes().element_count(); ++e) {
        if (std::size_t(model->volumes().material_of(e)) != of) continue;
        append(text, "%zu", e + 1);
        const std::size_t count = model->volumes().elements().count(e);
        for (std::size_t n = 0; n < count; ++n) {
          append(text, ", %d", model->volumes().elements().nodes(e)[kC3d10Order[n]] + 1);
        }
        text += "\n";
      }
      append(materials, "*MATERIAL, NAME=M%zu\n", of);
      materials += of_material(of);
      append(materials, "*SOLID SECTION, ELSET=E%zu, MATERIAL=M%zu\n", of, of);
    }
    return text + materials;
  }
  std::string elastic_text(std::size_t of) const {
    std::string text;
    append(text, "*ELASTIC\n%.12e, %.12e\n", mesh.materials[of].young_kpa,
           mesh.materials[of].poisson);
    return text;
  }
  /// What is held, as loads have it or at rest.
  std::string held_text(bool is_at_rest) const {
    std::string text = "*BOUNDARY\n";
    const NodalLoads nodal = model->nodal_loads(loads);
    for (std::size_t at = 0; at < nodal.u_mm.size(); ++at) {
      if ((nodal.held[at / 3] >> at % 3 & 1) == 0) continue;
      append(text, "%zu, %zu, %zu, %.12e\n", at / 3 + 1, at % 3 + 1, at % 3 + 1,
             is_at_rest ? 0 : nodal.u_mm[at]);
    }
    return text;
  }
  std::string force_text() const {
    std::string text = "*CLOAD\n";
    const NodalLoads nodal = model->nodal_loads(loads);
    for (std::size_t at = 0; at < nodal.force_mn.size(); ++at) {
      append(text, "%zu, %zu, %.12e\n", at / 3 + 1, at % 3 + 1, nodal.force_mn[at]);
    }
    return text;
  }

  std::string equilibrium(StrainTheory strain) const {
    const std::string loaded =
        held_text(false) + force_text() + "*NODE PRINT, NSET=ALL\nU\n*END STEP\n";
    if (strain == StrainTheory::linear) {
      return body_text([&](std::size_t of) { return elastic_text(of); }) + "*STEP\n*STATIC\n" +
             loaded;
    }
    const auto neo_hooke = [&](std::size_t of) {
      const TetModuli& moduli = model->moduli()[of];
      std::string text;
      append(text, "*HYPERELASTIC, NEO HOOKE\n%.12e, %.12e\n", moduli.shear_kpa / 2,
             2 / moduli.bulk_kpa);
      return text;
    };
    // The second control is that of corrections; the first steps are a fifth of the load.
    return body_text(neo_hooke) +
           "*STEP, NLGEOM, INC=1000\n*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-7\n"
           "*STATIC\n0.2, 1, 1e-5, 0.2\n" +
           loaded;
  }
  /// All but the step, with what is held at rest.
  std::string moving_text(const RayleighDamping& damping) const {
    return body_text([&](std::size_t of) {
             std::string text = elastic_text(of);
             append(text, "*DENSITY\n%.12e\n", loads.density_kg_m3[of] * 1e-9);
             if (!damping.empty()) {
               append(text, "*DAMPING, ALPHA=%.12e, BETA=%.12e\n", damping.mass_per_s,
                      damping.stiffness_s[of]);
             }
             return text;
           }) +
           held_text(true);
  }
  MassDensities densities() const {
    MassDensities out{};
    std::copy(loads.density_kg_m3.begin(), loads.density_kg_m3.end(), out.begin());
    return out;
  }
};

/// Cycles per second of the modes in the first table.
std::vector<double> calculix_frequencies(const std::string& deck) {
  std::istringstream lines(judged_text(deck));
  std::vector<double> hz;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("P A R T I C I P A T I O N") != std::string::npos) break;
    std::istringstream words(line);
    double number, eigenvalue, rad_per_s, cycles;
    if (words >> number >> eigenvalue >> rad_per_s >> cycles) hz.push_back(cycles);
  }
  return hz;
}

/// The tetrahedra with the mass that CalculiX 2.20 gives them: by one point of integration of four
/// nodes, by four of ten, where the consistent mass needs more.
class CalculixMass final : public ElasticSolid {
 public:
  explicit CalculixMass(const TetModel& model) : m_model(model) {}

  std::int64_t element_count() const override { return m_model.element_count(); }
  std::int64_t node_count() const override { return m_model.node_count(); }
  std::vector<Vec3d> node_positions() const override { return m_model.node_positions(); }
  std::vector<Vec3d> node_positions(const std::vector<NodeIndex>& nodes) const override {
    return m_model.node_positions(nodes);
  }
  NodePieces node_pieces() const override { return m_model.node_pieces(); }
  LooseCount hold_loose(bool holds, HeldBits& held) const override {
    return m_model.hold_loose(holds, held);
  }
  const Operator& matrix() const override { return m_model.matrix(); }
  std::unique_ptr<Operator> weighted(const ElementWeights& weights) const override {
    return std::make_unique<BlockCsr>(sum_of(weights));
  }
  std::unique_ptr<LinearSystem> system(const ElementWeights* weights, const HeldBits& held,
                                       Progress*) const override {
    if (weights == nullptr) return std::make_unique<TetSystem>(m_model.stiffness(), held);
    return std::make_unique<TetSystem>(sum_of(*weights), held);
  }
  std::size_t bytes() const override { return m_model.bytes(); }

 private:
  BlockCsr sum_of(const ElementWeights& weights) const {
    const TetVolumes& volumes = m_model.volumes();
    BlockCsr out = m_model.stiffness();
    out.set_zero();
    std::vector<TetModuli> moduli = m_model.moduli();
    for (std::size_t n = 0; n < moduli.size(); ++n) {
      moduli[n].shear_kpa *= weights.stiffness_parts[n];
      moduli[n].bulk_kpa *= weights.stiffness_parts[n];
    }
    volumes.add_to(out, moduli);
    out.add_sets(volumes.elements(), [&](std::size_t e, std::int32_t a, Matrix9* blocks) {
      const double mass = weights.density[std::size_t(volumes.material_of(e))] * kM3PerMm3 *
                          volumes.volume_mm3(e) * weights.mass_part_per_s2;
      for (std::size_t b = 0; b < volumes.elements().count(e); ++b) {
        double product = 0;
        for (std::size_t p = 0; p < volumes.point_count(); ++p) {
          product += shape(p, std::size_t(a)) * shape(p, b) / double(volumes.point_count());
        }
        blocks[b] = Matrix9{};
        for (std::size_t m = 0; m < 3; ++m) blocks[b][4 * m] = mass * product;
      }
    });
    return out;
  }
  /// Shape function of a node at a point.
  double shape(std::size_t point, std::size_t node) const {
    if (m_model.volumes().point_count() == 1) return 0.25;
    const double near = 0.58541019662496845446, far = 0.13819660112501051518;
    const auto at = [&](std::size_t corner) { return corner == point ? near : far; };
    constexpr std::size_t kEnds[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    if (node < 4) return at(node) * (2 * at(node) - 1);
    return 4 * at(kEnds[node - 4][0]) * at(kEnds[node - 4][1]);
  }

  const TetModel& m_model;
};

void judge_block(TetElement element, double poisson, StrainTheory strain) {
  JudgedBlock block(element, poisson);
  TetParams params;
  params.strain = strain;
  if (strain == StrainTheory::finite) {
    // Strains over 10 %, turns over 10 degrees.
    block.loads.held.back().displacement_mm = {Vec3d(4, -6, -8)};
    params.tolerance = 1e-10;
  }
  const TetSolution solution = block.model->solve(block.loads, params);
  const std::vector<double>& ours = solution.u_mm;
  const std::vector<double> theirs = calculix_displacements(block.equilibrium(strain));
  EXPECT_LE(difference(ours, theirs), 1e-6) << "nu " << poisson << ", element " << int(element);
  if (strain == StrainTheory::linear) return;
  EXPECT_GT(solution.report.largest_rotation_deg, 10);
  EXPECT_GT(solution.report.largest_strain, 0.1);
}

}  // namespace

TEST(InteropTet, CalculixFindsTheSameDisplacementsOfFourAndTenNodes) {
  if (!runs("which ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  for (const double poisson : {0.3, 0.48}) {
    for (const TetElement element : {TetElement::linear, TetElement::quadratic}) {
      judge_block(element, poisson, StrainTheory::linear);
    }
  }
}

TEST(InteropTet, CalculixFindsTheSameAtFiniteStrain) {
  if (!runs("which ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  for (const TetElement element : {TetElement::linear, TetElement::quadratic}) {
    judge_block(element, 0.4, StrainTheory::finite);
  }
}

// The consistent mass of ten nodes is nearly that of CalculiX. One point gives four nodes too
// little inertia for all but even motions.
TEST(InteropTet, CalculixFindsTheSameModes) {
  if (!runs("which ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  for (const TetElement element : {TetElement::linear, TetElement::quadratic}) {
    const JudgedBlock block(element, 0.45);
    const std::vector<double> theirs = calculix_frequencies(
        block.moving_text({}) + "*STEP\n*FREQUENCY\n10\n*NODE FILE\nU\n*END STEP\n");
    const HeldBits held = block.model->nodal_loads(block.loads).held;
    const VibrationModes same = lowest_modes(CalculixMass(*block.model), block.densities(), held);
    const VibrationModes ours = lowest_modes(*block.model, block.densities(), held);
    const double most_below = element == TetElement::quadratic ? 0.003 : 0.05;
    ASSERT_EQ(theirs.size(), 10u);
    for (std::size_t m = 0; m < 10; ++m) {
      EXPECT_NEAR(same.modes[m].frequency_hz / theirs[m], 1, 1e-6) << m << ", " << int(element);
      const double below = 1 - ours.modes[m].frequency_hz / theirs[m];
      EXPECT_GT(below, 0) << m << ", " << int(element);
      EXPECT_LT(below, most_below) << m << ", " << int(element);
    }
  }
}

TEST(InteropTet, CalculixMovesTheSameInTime) {
  if (!runs("which ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  constexpr double kStep_s = 2e-3;
  constexpr int kSteps = 10;
  for (const TetElement element : {TetElement::linear, TetElement::quadratic}) {
    for (const bool is_damped : {false, true}) {
      const JudgedBlock block(element, 0.45);
      RayleighDamping damping;
      damping.mass_per_s = is_damped ? 20 : 0;
      // One beta: with one per material CalculiX 2.20 damps differently.
      damping.stiffness_s[0] = damping.stiffness_s[1] = is_damped ? 4e-4 : 0;
      std::string step = "*STEP, INC=100000\n*DYNAMIC, DIRECT, ALPHA=0\n";
      append(step, "%.12e, %.12e\n", kStep_s, kSteps * kStep_s);
      const std::vector<double> theirs =
          calculix_displacements(block.moving_text(damping) + step + block.force_text() +
                                 "*NODE PRINT, NSET=ALL\nU\n*END STEP\n");
      NodalLoads loads = block.model->nodal_loads(block.loads);
      std::fill(loads.u_mm.begin(), loads.u_mm.end(), 0.0);
      NewmarkParams params;
      params.step_s = kStep_s;
      params.tolerance = 1e-9;
      const CalculixMass same(*block.model);
      Newmark motion(same, block.densities(), damping, loads, params);
      motion.start(loads.u_mm, loads.u_mm);
      for (int n = 0; n < kSteps; ++n) motion.step({});
      EXPECT_LE(difference(motion.u_mm(), theirs), 2e-3) << int(element) << is_damped;
    }
  }
}

// CalculiX and DOLFINx solve the same hexahedra; skipped where calculix-ccx or python3-dolfinx is
// not installed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>

#include "lib/fem/dynamics/modes.h"
#include "lib/fem/dynamics/newmark.h"
#include "lib/fem/voxel/finite_strain.h"
#include "lib/fem/voxel/hinges.h"
#include "lib/fem/voxel/loose_islands.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/support/program.h"
#include "volumes/base/parallel.h"

using namespace supple;
using namespace supple::test;

namespace {

/// C3D8 has no mean dilatation.
constexpr Dilatation kAsC3d8 = Dilatation::pointwise;

/// Common nodes of voxels that touch by an edge or a corner alone.
const ElementChoice kAsBoneLaboratories(Dilatation::pointwise, Touching::joined);

/// Single voxels at random, of two materials, many of which touch by edges and corners alone.
Body scattered_body(std::mt19937& random) {
  const std::uint32_t seed = std::uint32_t(random());
  const double filled = pick(random, 0.25, 0.5);
  const Geometry sheared = random_fem_body(random, Vec3i(8, 7, 9)).geometry;
  Body body = fem_body(9, [&](const Vec3i& voxel) {
    std::seed_seq seeds{seed, std::uint32_t(voxel.x), std::uint32_t(voxel.y),
                        std::uint32_t(voxel.z)};
    std::mt19937 own(seeds);
    return pick(own, 0, 1) < filled ? int(own() % 2) : -1;
  });
  body.geometry = Geometry(body.geometry.dims(), Vec3d(1, 2, 3),
                           {sheared.axes_mm()[0], sheared.axes_mm()[1], sheared.axes_mm()[2]});
  return body;
}

/// A body of two materials that is held and moved at random places and carries a field of force.
struct JudgedBody {
  ElementChoice choice;
  Body body;
  ElasticTable elastic;
  FemLoads loads;
  NodalLoads nodal;  // with what nothing holds at rest
  FemSolution solution;
  std::vector<double> force_mn;  // K(u)

  JudgedBody(std::mt19937& random, StrainTheory strain, const ElementChoice& as = kAsC3d8)
      : choice(as),
        body(as.touching == Touching::joined ? scattered_body(random)
                                             : random_fem_body(random, Vec3i(8, 7, 9))),
        elastic(ElasticTable::uniform(2, 0.3)) {
    for (std::uint8_t& of : body.classes) of = std::uint8_t(of % 2);
    elastic.young_kpa[1] = 60;
    elastic.poisson[1] = 0.42;
    if (as.touching == Touching::joined) {
      elastic.young_kpa[1] = std::pow(10, pick(random, 0, 3));
      elastic.poisson[0] = pick(random, 0, 0.4);
    }
    const double most = strain == StrainTheory::linear ? 0.1 : 0.3;
    const Vec3d slope(pick(random, -most, most), pick(random, -most, most),
                      pick(random, -most, most));
    const Vec3d wave(pick(random, 3, 9), pick(random, 3, 9), pick(random, 3, 9));
    loads.held.push_back(hold_where(
        body, [wave](const Vec3d& x) { return std::sin(wave.dot(x)) > 0.8; },
        [slope](const Vec3d& x) { return slope * x.x + Vec3d(0.2, 0, -0.1); }));
    loads.body_force = [slope](const Vec3d& x) { return slope * (1 + 0.1 * x.y); };
    const FemModel model(body, elastic, choice);
    hold_hinges(model);
    FemParams params;
    params.strain = strain;
    params.tolerance = 1e-9;
    solution = model.solve(loads, params);
    if (strain == StrainTheory::linear) {
      model.apply(solution.u_mm, force_mn);
    } else {
      force_mn.resize(solution.u_mm.size());
      FiniteStrain(model.mesh(), model.material())
          .add_forces(solution.u_mm.data(), force_mn.data());
    }
    nodal = nodal_loads(model.mesh(), model.material(), loads);
    hold_loose_islands(model.mesh(), true, nodal.held);
  }

  /// CalculiX solves no singular equations.
  void hold_hinges(const FemModel& model) {
    if (choice.touching == Touching::apart) return;
    HeldBits held = held_bits(model.mesh(), loads.held);
    model.hold_loose(true, held);
    const std::vector<bool> hinged = hinged_elements(model.mesh(), held);
    if (hinged.empty()) return;
    std::vector<Slot> elements;
    std::size_t e = 0;
    for_each_element(body.elements, [&](Slot slot) {
      if (hinged[e++]) elements.push_back(slot);
    });
    loads.held.emplace_back().elements = SlotSet(std::move(elements));
  }
};

class WarningsKept final : public Progress {
 public:
  std::vector<std::string> lines;
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return false; }
  void warn(const std::string& line) override { lines.push_back(line); }
};

template <class... Values>
void print(std::string& text, const char* format, Values... values) {
  char line[200];
  std::snprintf(line, sizeof line, format, values...);
  text += line;
}

/// Corners 4 di + 2 dj + dk of a right-handed hexahedron in the order of C3D8.
constexpr int kCornerOrder[8] = {0, 4, 6, 2, 1, 5, 7, 3};

/// Bodies side by side in one file, so that CalculiX starts once. It reads 20 characters of a
/// number.
class CalculixDeck {
 public:
  explicit CalculixDeck(StrainTheory strain) : m_is_finite(strain == StrainTheory::finite) {}

  void add(const JudgedBody& judged) {
    const FemModel model(judged.body, judged.elastic, judged.choice);
    const HexMesh& mesh = model.mesh();
    const std::vector<Vec3d> positions = node_positions(mesh);
    const bool is_left_handed = mesh.geometry.determinant() < 0;
    for (std::size_t n = 0; n < positions.size(); ++n) {
      const Vec3d& x = positions[n];
      print(m_nodes, "%d, %.12e, %.12e, %.12e\n", number(n), x.x, x.y, x.z);
      for (int a = 0; a < 3; ++a) {
        const std::size_t at = 3 * n + std::size_t(a);
        if ((judged.nodal.held[n] >> a & 1) != 0) {
          print(m_held, "%d, %d, %d, %.12e\n", number(n), a + 1, a + 1, judged.nodal.u_mm[at]);
        } else {
          print(m_forces, "%d, %d, %.12e\n", number(n), a + 1, judged.nodal.force_mn[at]);
        }
      }
    }
    for (int of = 0; of < 2; ++of) {
      print(m_elements, "*ELEMENT, TYPE=C3D8, ELSET=E%d_%d\n", m_bodies, of);
      for (std::int32_t e = 0; e < mesh.element_count(); ++e) {
        if (model.material().classes[std::size_t(e)] != of) continue;
        const Corners corners = mesh.corners(e);
        print(m_elements, "%d", ++m_element_count);
        for (int c = 0; c < 8; ++c) {
          const int corner = kCornerOrder[c] ^ (is_left_handed ? 1 : 0);
          print(m_elements, ", %d", number(std::size_t(corners[corner])));
        }
        m_elements += "\n";
      }
      const double young = judged.elastic.young_kpa[of], poisson = judged.elastic.poisson[of];
      print(m_materials, "*MATERIAL, NAME=M%d_%d\n", m_bodies, of);
      if (m_is_finite) {
        const ElasticModuli moduli = elastic_moduli(young, poisson);
        print(m_materials, "*HYPERELASTIC, NEO HOOKE\n%.12e, %.12e\n", moduli.shear_kpa / 2,
              2 / moduli.bulk_kpa);
      } else {
        print(m_materials, "*ELASTIC\n%.12e, %.12e\n", young, poisson);
      }
      print(m_materials, "*SOLID SECTION, ELSET=E%d_%d, MATERIAL=M%d_%d\n", m_bodies, of, m_bodies,
            of);
    }
    ++m_bodies;
    m_first += int(positions.size());
  }

  /// The ten lowest modes with all that is held at rest; densities per class in kg/m^3.
  std::string text_of_modes(const double (&density)[2]) const {
    return text_with_mass(density, {}) + "*STEP\n*FREQUENCY\n10\n*NODE FILE\nU\n*END STEP\n";
  }

  /// Text of steps of time from rest under the forces, with all that is held at rest.
  std::string text_of_motion(const double (&density)[2], const RayleighDamping& damping,
                             double step_s, int steps) const {
    std::string motion = "*STEP, INC=100000\n*DYNAMIC, DIRECT, ALPHA=0\n";
    print(motion, "%.12e, %.12e\n", step_s, steps * step_s);
    return text_with_mass(density, damping) + motion + "*CLOAD\n" + m_forces +
           "*NODE PRINT, NSET=ALL\nU, V\n*END STEP\n";
  }

  /// The equilibrium at finite strain.
  std::string text_of_equilibrium() const {
    // The second control is that of corrections; the first steps are a fifth of the load.
    const std::string step =
        "*STEP, NLGEOM, INC=1000\n*CONTROLS, PARAMETERS=FIELD\n1e-9, 1e-7\n"
        "*STATIC\n0.2, 1, 1e-5, 0.2\n";
    return "*NODE, NSET=ALL\n" + m_nodes + m_elements + m_materials + step + "*BOUNDARY\n" +
           m_held + "*CLOAD\n" + m_forces + "*NODE PRINT, NSET=ALL\nU, RF\n*END STEP\n";
  }

 private:
  /// All but the step.
  std::string text_with_mass(const double (&density)[2], const RayleighDamping& damping) const {
    std::string materials = m_materials, held;
    for (int of = 0; of < 2; ++of) {
      const std::string name = "*MATERIAL, NAME=M0_" + std::to_string(of) + "\n";
      std::string text = name;
      print(text, "*DENSITY\n%.12e\n", density[of] * 1e-9);
      if (!damping.empty()) {
        print(text, "*DAMPING, ALPHA=%.12e, BETA=%.12e\n", damping.mass_per_s,
              damping.stiffness_s[std::size_t(of)]);
      }
      materials.replace(materials.find(name), name.size(), text);
    }
    std::istringstream lines(m_held);
    for (std::string line; std::getline(lines, line);)
      held += line.substr(0, line.rfind(',')) + "\n";
    return "*NODE, NSET=ALL\n" + m_nodes + m_elements + materials + "*BOUNDARY\n" + held;
  }
  int number(std::size_t node) const { return m_first + int(node) + 1; }

  bool m_is_finite;
  int m_first = 0, m_element_count = 0, m_bodies = 0;
  std::string m_nodes, m_elements, m_materials, m_held, m_forces;
};

/// The blocks of a `.dat`: three values per node each.
std::vector<std::vector<double>> blocks_of(const std::string& dat) {
  std::vector<std::vector<double>> blocks;
  std::istringstream lines(dat);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    int node;
    double x, y, z;
    if (line.find(" for set ") != std::string::npos) blocks.emplace_back();
    if (blocks.empty() || !(words >> node >> x >> y >> z)) continue;
    blocks.back().insert(blocks.back().end(), {x, y, z});
  }
  return blocks;
}

double largest_of(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

/// Runs CalculiX on the deck; the two blocks that are printed after the last increment.
std::vector<std::vector<double>> judge(const std::string& deck) {
  const TemporaryFolder folder;
  write_text(folder / "bodies.inp", deck);
  EXPECT_TRUE(runs("cd " + (folder / "") + " && ccx bodies"));
  std::vector<std::vector<double>> blocks = blocks_of(read_text(folder / "bodies.dat"));
  EXPECT_GE(blocks.size(), 2u);
  blocks.erase(blocks.begin(),
               blocks.end() - std::min<std::ptrdiff_t>(2, std::ptrdiff_t(blocks.size())));
  return blocks;
}

/// Cycles per second of modes 1, 2, ..., and the masses that take part along x, y and z in kg.
struct CalculixModes {
  std::vector<double> frequency_hz;
  std::vector<Vec3d> effective_mass_kg;
};

CalculixModes judge_modes_of(const std::string& deck) {
  const TemporaryFolder folder;
  write_text(folder / "modes.inp", deck);
  EXPECT_TRUE(runs("cd " + (folder / "") + " && ccx modes"));
  std::istringstream lines(read_text(folder / "modes.dat"));
  CalculixModes modes;
  std::string table;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("E I G E N") != std::string::npos) table = "frequencies";
    if (line.find("P A R T I C I P A T I O N") != std::string::npos) table = "factors";
    if (line.find("E F F E C T I V E") != std::string::npos) table = "masses";
    if (line.find("T O T A L") != std::string::npos) table = "total";
    std::istringstream words(line);
    std::size_t number;
    double a, b, c;
    if (!(words >> number >> a >> b >> c)) continue;
    if (table == "frequencies") modes.frequency_hz.push_back(c);
    if (table == "masses") modes.effective_mass_kg.emplace_back(a, b, c);
  }
  return modes;
}

/// Compares one body with its part of the blocks from `at` on, which goes behind it.
void compare(const JudgedBody& judged, const std::vector<std::vector<double>>& blocks,
             std::size_t& at) {
  const std::vector<double>& u = judged.solution.u_mm;
  const double u_scale = largest_of(u), force_scale = largest_of(judged.force_mn);
  ASSERT_LE(at + u.size(), blocks[0].size());
  ASSERT_EQ(blocks[0].size(), blocks[1].size());
  double off_mm = 0, off_mn = 0;
  for (std::size_t n = 0; n < u.size(); ++n) {
    off_mm = std::max(off_mm, std::abs(u[n] - blocks[0][at + n]));
    off_mn = std::max(off_mn, std::abs(judged.force_mn[n] - blocks[1][at + n]));
  }
  EXPECT_LT(off_mm, 1e-6 * u_scale);
  EXPECT_LT(off_mn, 1e-6 * force_scale);
  // The body pulls at what holds it, less the loads that act there.
  const FemReaction& reaction = judged.solution.reactions.front();
  Vec3d held_n(0.0);
  double lengths_n = 0;
  for (std::size_t n = 0; n < judged.nodal.held.size(); ++n) {
    if (!std::binary_search(judged.nodal.nodes_of[0].begin(), judged.nodal.nodes_of[0].end(),
                            NodeIndex(n))) {
      continue;
    }
    Vec3d pull(0.0);
    for (std::size_t a = 0; a < 3; ++a) {
      pull[int(a)] = (judged.nodal.force_mn[3 * n + a] - blocks[1][at + 3 * n + a]) * 1e-3;
    }
    held_n += pull;
    lengths_n += pull.length();
  }
  EXPECT_LT((reaction.force_n - held_n).length(), 1e-6 * lengths_n);
  at += u.size();
}

}  // namespace

namespace {

/// Displacements, forces and energy of the judged body by another program, within `accuracy` of the
/// largest.
void expect_same(const JudgedBody& judged, const FemSolution& found, double accuracy) {
  const std::vector<double>& u = judged.solution.u_mm;
  double off_mm = 0;
  ASSERT_EQ(found.u_mm.size(), u.size());
  for (std::size_t at = 0; at < u.size(); ++at) {
    off_mm = std::max(off_mm, std::abs(u[at] - found.u_mm[at]));
  }
  EXPECT_LT(off_mm, accuracy * largest_of(u));
  EXPECT_LT(found.report.residual_max, accuracy);
  const Vec3d off_n = found.reactions.front().force_n - judged.solution.reactions.front().force_n;
  EXPECT_LT(off_n.length(), accuracy * largest_of(judged.force_mn));
  EXPECT_NEAR(found.report.energy_mj, judged.solution.report.energy_mj,
              accuracy * judged.solution.report.energy_mj);
}

/// Six bodies, on left- and right-handed grids, solved by another program.
void judge_bodies(const ElementChoice& choice, EquationSolver solver, double tolerance) {
  std::mt19937 random(21);
  bool has_left = false, has_right = false;
  for (int n = 0; n < 6; ++n) {
    const JudgedBody judged(random, StrainTheory::linear, choice);
    (judged.body.geometry.determinant() < 0 ? has_left : has_right) = true;
    FemParams params;
    params.solver = solver;
    params.tolerance = tolerance;
    const FemModel model(judged.body, judged.elastic, choice);
    EXPECT_EQ(choice.touching == Touching::joined,
              model.mesh().node_count() < hex_mesh(judged.body).node_count());
    expect_same(judged, model.solve(judged.loads, params), 1e-6);
  }
  EXPECT_TRUE(has_left && has_right);
}

bool has_dolfinx() {
  return runs("/usr/bin/python3 -c 'import dolfinx'");
}

}  // namespace

TEST(InteropFem, CalculixFindsTheSameDisplacementsAndForcesOnTheSameHexahedra) {
  if (!runs("command -v ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  judge_bodies(kAsC3d8, EquationSolver::calculix, FemParams().residual_limit());
}

TEST(InteropFem, CalculixFindsTheSameOnCommonNodesOfVoxelsThatTouchByEdgesAndCorners) {
  if (!runs("command -v ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  judge_bodies(kAsBoneLaboratories, EquationSolver::calculix, 1e-9);
}

TEST(InteropFem, DolfinxFindsTheSameDisplacementsAndForcesOnTheSameHexahedra) {
  if (!has_dolfinx()) GTEST_SKIP() << "python3-dolfinx is not installed";
  judge_bodies(Dilatation::mean, EquationSolver::dolfinx, 1e-9);
  const ThreadLimit one(1);
  judge_bodies(kAsC3d8, EquationSolver::dolfinx, 1e-9);
}

/// DOLFINx's rest on nodes is a warning; a goal out of its reach is an error with the numbers.
TEST(InteropFem, DolfinxSaysHowFarItGot) {
  if (!has_dolfinx()) GTEST_SKIP() << "python3-dolfinx is not installed";
  std::mt19937 random(5);
  const JudgedBody judged(random, StrainTheory::linear, Dilatation::mean);
  const FemModel model(judged.body, judged.elastic);
  FemParams params;
  params.solver = EquationSolver::dolfinx;
  params.tolerance = 1e-2;
  WarningsKept warnings;
  const FemReport report = model.solve(judged.loads, params, &warnings).report;
  EXPECT_GT(report.iterations, 0);
  EXPECT_GT(report.bytes, 1e6);
  EXPECT_GT(report.residual_max, params.tolerance);
  ASSERT_EQ(warnings.lines.size(), 1u);
  EXPECT_NE(warnings.lines[0].find("DOLFINx left forces of up to"), std::string::npos);
  params.tolerance = 1e-12;
  params.max_iterations = 1;
  EXPECT_THROW(model.solve(judged.loads, params), NotConverged);
}

TEST(InteropFem, CalculixsIterationsEndNearby) {
  if (!runs("command -v ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  const Body body = fem_cube(8);
  FemLoads loads;
  loads.held.push_back(hold_where(
      body, [](const Vec3d& x) { return x.z < 1; }, [](const Vec3d&) { return Vec3d(0); }));
  loads.gravity_m_s2 = {3, 0, -9.81};
  loads.mass_density.fill(1000);
  const FemModel model(body, ElasticTable::uniform(10, 0.3), kAsC3d8);
  FemParams params;
  const FemSolution own = model.solve(loads, params);
  params.solver = EquationSolver::calculix_iterative;
  WarningsKept warnings;
  const FemSolution found = model.solve(loads, params, &warnings);
  EXPECT_GT(found.report.residual_max, params.tolerance);
  ASSERT_EQ(warnings.lines.size(), 1u);
  EXPECT_NE(warnings.lines[0].find("CalculiX left forces of up to"), std::string::npos);
  EXPECT_NEAR(found.report.energy_mj, own.report.energy_mj, 0.01 * own.report.energy_mj);
  EXPECT_LT((found.reactions[0].force_n - own.reactions[0].force_n).length(),
            0.01 * own.reactions[0].force_n.length());
}

TEST(InteropFem, OtherProgramsAreMissedAndRefusedInOneLine) {
  const Body body = fem_cube(3);
  const FemModel model(body, ElasticTable::uniform(10, 0.3));
  FemParams params;
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  for (const EquationSolver solver : {EquationSolver::calculix, EquationSolver::dolfinx}) {
    params.solver = solver;
    EXPECT_THROW(model.solve({}, params), InputError);
  }
  ::setenv("PATH", path.c_str(), 1);
  params.solver = EquationSolver::calculix;
  params.strain = StrainTheory::finite;
  EXPECT_THROW(model.solve({}, params), InputError);
  params = {};
  params.solver = EquationSolver::calculix;
  params.doublings = 1;
  EXPECT_THROW(model.solve({}, params), InputError);
}

TEST(InteropFem, CalculixFindsTheSameAtFiniteStrain) {
  if (!runs("command -v ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  std::mt19937 random(23);
  std::vector<JudgedBody> bodies;
  CalculixDeck deck(StrainTheory::finite);
  for (int n = 0; n < 2; ++n) {
    bodies.emplace_back(random, StrainTheory::finite);
    deck.add(bodies.back());
    EXPECT_GT(bodies.back().solution.report.largest_strain, 0.1);
    EXPECT_GT(bodies.back().solution.report.largest_rotation_deg, 10);
  }
  const std::vector<std::vector<double>> blocks = judge(deck.text_of_equilibrium());
  ASSERT_EQ(blocks.size(), 2u);
  std::size_t at = 0;
  for (const JudgedBody& judged : bodies) compare(judged, blocks, at);
  EXPECT_EQ(at, blocks[0].size());
}

TEST(InteropFem, CalculixFindsTheSameTenLowestModes) {
  if (!runs("command -v ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  std::mt19937 random(24);
  constexpr double kDensity[2] = {900, 1800};
  for (int judged_bodies = 0; judged_bodies < 2;) {
    const JudgedBody judged(random, StrainTheory::linear);
    if (judged.solution.report.unknowns < 100) continue;
    ++judged_bodies;
    CalculixDeck deck(StrainTheory::linear);
    deck.add(judged);
    const CalculixModes expected = judge_modes_of(deck.text_of_modes(kDensity));
    ASSERT_EQ(expected.frequency_hz.size(), 10u);
    ASSERT_EQ(expected.effective_mass_kg.size(), 10u);
    MassDensities density{};
    density.fill(1);
    density[0] = kDensity[0];
    density[1] = kDensity[1];
    const FemModel model(judged.body, judged.elastic, kAsC3d8);
    const VibrationModes found =
        lowest_modes(model, density, held_bits(model.mesh(), judged.loads.held));
    const MassMatrix mass(model, density);
    for (std::size_t m = 0; m < 10; ++m) {
      EXPECT_NEAR(found.modes[m].frequency_hz, expected.frequency_hz[m],
                  1e-6 * expected.frequency_hz[m]);
      // CalculiX counts no mass of what is held.
      const std::vector<double> inertia = mass.times(found.modes[m].shape);
      Vec3d participation(0.0);
      for (std::size_t n = 0; n < inertia.size(); ++n) {
        if ((judged.nodal.held[n / 3] >> n % 3 & 1) == 0) participation[int(n % 3)] += inertia[n];
      }
      const Vec3d off = participation * participation - expected.effective_mass_kg[m];
      EXPECT_LT(off.length(), 1e-4 * found.report.mass_kg) << m;
    }
  }
}

TEST(InteropFem, CalculixMovesTheSameInTime) {
  if (!runs("command -v ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  std::mt19937 random(25);
  constexpr double kDensity[2] = {900, 1800};
  for (int judged_bodies = 0; judged_bodies < 2;) {
    const JudgedBody judged(random, StrainTheory::linear);
    if (judged.solution.report.unknowns < 100) continue;
    const bool is_damped = judged_bodies++ == 1;
    CalculixDeck deck(StrainTheory::linear);
    deck.add(judged);
    RayleighDamping damping;
    damping.mass_per_s = is_damped ? 20 : 0;
    // One beta: with one per material CalculiX 2.20 damps differently.
    damping.stiffness_s[0] = is_damped ? 4e-4 : 0;
    damping.stiffness_s[1] = is_damped ? 4e-4 : 0;
    constexpr double kStep_s = 5e-5;
    constexpr int kSteps = 40;
    const std::vector<std::vector<double>> blocks =
        judge(deck.text_of_motion(kDensity, damping, kStep_s, kSteps));
    ASSERT_EQ(blocks.size(), 2u);
    MassDensities density{};
    density.fill(1);
    density[0] = kDensity[0];
    density[1] = kDensity[1];
    const FemModel model(judged.body, judged.elastic, kAsC3d8);
    NodalLoads loads = judged.nodal;
    std::fill(loads.u_mm.begin(), loads.u_mm.end(), 0.0);
    NewmarkParams params;
    params.step_s = kStep_s;
    params.tolerance = 1e-9;
    Newmark motion(model, density, damping, loads, params);
    motion.start(loads.u_mm, loads.u_mm);
    for (int n = 0; n < kSteps; ++n) motion.step({});
    ASSERT_EQ(blocks[0].size(), loads.u_mm.size());
    for (std::size_t which = 0; which < 2; ++which) {
      const std::vector<double>& found = which == 0 ? motion.u_mm() : motion.v_mm_s();
      const double scale = largest_of(found);
      EXPECT_GT(scale, 0);
      double off = 0;
      for (std::size_t n = 0; n < found.size(); ++n) {
        off = std::max(off, std::abs(found[n] - blocks[which][n]));
      }
      EXPECT_LT(off, (which == 0 ? 1e-5 : 1e-4) * scale) << which;
    }
  }
}

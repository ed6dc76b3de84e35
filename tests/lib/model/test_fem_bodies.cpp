// Voxel finite elements of bodies that are cut, in pieces, or held by handles that turn and scale.
#include <array>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "lib/fem/voxel/fem_results.h"
#include "lib/model/fem_model.h"
#include "lib/model/refined_shape.h"
#include "lib/model/relax_model.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

using Place = std::array<int, 3>;
/// Displacements of the corners of each voxel, mm.
using CornerMotion = std::map<Place, std::array<Vec3d, 8>>;

CornerMotion corner_motion(const HexMesh& mesh, const std::vector<double>& u_mm) {
  CornerMotion motion;
  for (std::size_t b = 0; b < mesh.block_count(); ++b) {
    for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
      const Vec3i voxel = mesh.origin[b] + brick_local(mesh.offset[std::size_t(e)]);
      auto& of_corners = motion[{voxel.x, voxel.y, voxel.z}];
      const Corners corners = mesh.corners_in(b, e);
      for (std::size_t c = 0; c < 8; ++c) {
        const double* u = &u_mm[3 * std::size_t(corners[c])];
        of_corners[c] = Vec3d(u[0], u[1], u[2]);
      }
    }
  }
  return motion;
}

/// Both ends along x held, the far one moved.
FemLoads pulled_along_x(const Body& body, double from, double to, const Vec3d& by_mm) {
  FemLoads loads;
  loads.held.push_back(hold_where(body, [from](const Vec3d& x) { return x.x < from; }));
  loads.held.push_back(hold_where(
      body, [to](const Vec3d& x) { return x.x > to; }, [by_mm](const Vec3d&) { return by_mm; }));
  return loads;
}

/// Elements of a block for which `where` holds, their links cut between x = plane - 1 and plane
/// where `is_cut` says so.
Body parted_block(const Vec3i& dims, int plane, const std::function<bool(const Vec3i&)>& where,
                  const std::function<bool(const Vec3i&)>& is_cut) {
  Block block = homogeneous(dims, 1.5, 0.5, 0.5);
  block.cut.assign(std::size_t(block.size()), 0);
  for (int n = 0; n < block.size(); ++n) {
    const Vec3i voxel = block.voxel(n);
    block.element[std::size_t(n)] = where(voxel);
    if (voxel.x == plane - 1 && is_cut(voxel)) block.cut[std::size_t(n)] = 1;
  }
  return body_of(block);
}

bool everywhere(const Vec3i&) {
  return true;
}
bool nowhere(const Vec3i&) {
  return false;
}

}  // namespace

TEST(PropertyFem, ABodyThatIsCutThroughIsTwoBodies) {
  const Vec3i dims(11, 6, 7);
  const int plane = 5;
  const ElasticTable elastic = ElasticTable::uniform(4, 0.4);
  FemParams params;
  params.tolerance = 1e-9;
  // Each side is held at its end and pulled towards the other one.
  const auto solve = [&](const Body& body) {
    FemLoads loads;
    loads.held.push_back(hold_where(body, [](const Vec3d& x) { return x.x < 0 || x.x > 10; }));
    loads.body_force = [](const Vec3d& x) {
      return Vec3d(x.x < 4.5 ? 0.1 : -0.2, 0.05 * x.y, 0.1);
    };
    const FemModel model(body, elastic);
    return corner_motion(model.mesh(), model.solve(loads, params).u_mm);
  };
  const auto is_low = [](const Vec3i& voxel) { return voxel.x < plane; };
  const auto is_high = [](const Vec3i& voxel) { return voxel.x >= plane; };
  const CornerMotion whole = solve(parted_block(dims, plane, everywhere, everywhere));
  CornerMotion parts = solve(parted_block(dims, plane, is_low, nowhere));
  parts.merge(solve(parted_block(dims, plane, is_high, nowhere)));
  ASSERT_EQ(whole.size(), parts.size());
  double most = 0, joined = 0;
  for (const auto& [voxel, corners] : whole) {
    for (std::size_t c = 0; c < 8; ++c) {
      most = std::max(most, corners[c].length());
      EXPECT_LT((corners[c] - parts.at(voxel)[c]).length(), 1e-7);
    }
  }
  EXPECT_GT(most, 0.1);
  // The result without the cut is another.
  for (const auto& [voxel, corners] : solve(parted_block(dims, plane, everywhere, nowhere))) {
    joined = std::max(joined, (corners[0] - parts.at(voxel)[0]).length());
  }
  EXPECT_GT(joined, 0.1 * most);
}

TEST(PropertyFem, LipsOfACutOpenTowardsItsMouth) {
  // A slit from the top half way down, in the middle of a block that is pulled at both ends.
  const Vec3i dims(12, 4, 8);
  const int plane = 6, tip = 4;
  const Body body =
      parted_block(dims, plane, everywhere, [](const Vec3i& voxel) { return voxel.z >= tip; });
  const FemModel model(body, ElasticTable::uniform(4, 0.4));
  const FemSolution solution = model.solve(pulled_along_x(body, -0.4, 11.4, {0.5, 0, 0}));
  const CornerMotion motion = corner_motion(model.mesh(), solution.u_mm);
  double below = 0;
  for (int k = tip; k < dims.z; ++k) {
    // The upper corners of both sides, 4 di + 2 dj + dk.
    const double gap = motion.at({plane, 1, k})[1].x - motion.at({plane - 1, 1, k})[5].x;
    EXPECT_GT(gap, below);
    below = gap;
  }
  EXPECT_GT(below, 0.2);
  // The tip is one node, whose sides go together.
  EXPECT_EQ(motion.at({plane, 1, tip})[0], motion.at({plane - 1, 1, tip})[4]);
  const Body uncut = parted_block(dims, plane, everywhere, nowhere);
  const FemSolution before = FemModel(uncut, ElasticTable::uniform(4, 0.4))
                                 .solve(pulled_along_x(uncut, -0.4, 11.4, {0.5, 0, 0}));
  EXPECT_LT(-solution.reactions[1].force_n.x, -0.8 * before.reactions[1].force_n.x);
}

TEST(PropertyFem, PiecesThatNothingHoldsAreCountedAndStayAtRest) {
  const Vec3i dims(11, 4, 4);
  // Two bars, and a voxel that touches the first of them by an edge alone.
  Body body = parted_block(
      dims, 1,
      [](const Vec3i& v) { return v.x < 5 ? v.y < 3 && v.z < 3 : v.x > 6 || v == Vec3i(5, 3, 1); },
      nowhere);
  const std::vector<Region> anchors{Region(IndexBox{{0, 0, 0}, {0, 3, 3}})};
  Holds holds;
  FemLoads loads;
  loads.gravity_m_s2 = {0, 0, -9.81};
  loads.mass_density.fill(1000);
  VoxelFemModel model({body, anchors, holds}, ElasticTable::uniform(8, 0.4), loads);
  model.move({{Vec3i(4, 1, 1), {kVoxel / 8, 0, 0}}}, 1, nullptr);
  EXPECT_EQ(model.report().islands, 3);
  EXPECT_EQ(model.report().loose_islands, 2);
  EXPECT_EQ(model.report().loose_elements, 4 * 4 * 4 + 1);
  model.store();
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(body.offset({5, 3, 1}, c), 0);
    EXPECT_EQ(body.offset({9, 2, 2}, c), 0);
  }
  EXPECT_GT(body.offset({3, 1, 1}, 0), 0);

  FemParams params;
  params.loose = LooseIslands::refuse;
  VoxelFemModel strict({body, anchors, holds}, ElasticTable::uniform(8, 0.4), {}, params);
  const std::string refused = input_error([&] {
    strict.move({{Vec3i(4, 1, 1), {0, 0, 0}}}, 1, nullptr);
  });
  EXPECT_NE(refused.find("2 pieces of 65 elements that nothing holds"), std::string::npos)
      << refused;
}

TEST(PropertyFem, CornersOfAHandleThatTurnsAndScalesTurnAndScaleToo) {
  // The elements inside of the handle have the strain and the turn of its motion, although a handle
  // says no more than where centres go.
  const double angle = 0.05, scale = 1.02;
  Body body = fem_cube(9);
  const std::vector<Region> anchors{Region(IndexBox{{0, 0, 0}, {8, 8, 0}})};
  Holds holds;
  const IndexBox grabbed{{2, 2, 4}, {6, 6, 8}};
  Handle handle{Region(grabbed), {0, 0, 0}};
  elements_in(body, grabbed).for_each([&](Slot slot) {
    const Vec3d arm = Vec3d(voxel_of(body.elements, slot)) - Vec3d(4, 4, 6);
    const Vec3d there(std::cos(angle) * arm.x - std::sin(angle) * arm.y,
                      std::sin(angle) * arm.x + std::cos(angle) * arm.y, arm.z);
    const Vec3d by = there * scale - arm;
    handle.each_by_q.push_back({std::int32_t(std::lround(by.x * kFixedOne)),
                                std::int32_t(std::lround(by.y * kFixedOne)),
                                std::int32_t(std::lround(by.z * kFixedOne))});
  });
  VoxelFemModel model({body, anchors, holds}, ElasticTable::uniform(8, 0.4));
  model.move({handle}, 1, nullptr);
  const HexMesh& mesh = model.solid().mesh();
  int inside = 0;
  for (std::size_t b = 0; b < mesh.block_count(); ++b) {
    for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
      if (!grabbed.contains(mesh.origin[b] + brick_local(mesh.offset[std::size_t(e)]))) continue;
      const ElementState state =
          element_state(mesh, model.solid().material(), model.displacement_mm(), e);
      EXPECT_NEAR(state.rotation_rad.z, scale * std::sin(angle), 1e-4);
      EXPECT_NEAR(state.strain[0], scale * std::cos(angle) - 1, 1e-4);
      EXPECT_NEAR(state.strain[2], scale - 1, 1e-4);
      EXPECT_NEAR(state.strain[3], 0, 1e-4);
      ++inside;
    }
  }
  EXPECT_EQ(inside, 5 * 5 * 5);
}

TEST(PropertyFem, ABodyThatIsHeldAltogetherIsWhereItIsHeld) {
  Body body = fem_cube(3);
  Holds holds;
  const std::vector<Region> none;
  VoxelFemModel model({body, none, holds}, ElasticTable::uniform(8, 0.4));
  const std::vector<Handle> all{{IndexBox{{0, 0, 0}, {2, 2, 2}}, {kVoxel, 0, -kVoxel / 2}}};
  model.move(all, 1, nullptr);
  EXPECT_EQ(model.report().unknowns, 0);
  model.store();
  EXPECT_EQ(body.offset({1, 2, 0}, 0), kVoxel);
  EXPECT_EQ(body.offset({2, 0, 1}, 2), -kVoxel / 2);
  EXPECT_LT(model.reactions(all).front().force_n.length(), 1e-9);
}

TEST(PropertyFemRefined, PartsOfVoxelsHaveTheirPlaceClassAndCuts) {
  std::mt19937 random(51);
  for (const int halvings : {1, 2}) {
    const Body body = random_fem_body(random, Vec3i(11, 10, 9));
    const RefinedShape refined(body, halvings);
    const Body& fine = refined.body();
    const int parts = 1 << halvings;
    EXPECT_EQ(fine.elements.active_count(), body.elements.active_count() * parts * parts * parts);
    EXPECT_NEAR(fine.geometry.determinant() * parts * parts * parts, body.geometry.determinant(),
                1e-12);
    std::int64_t cut = 0, cut_inside = 0;
    for_each_element(fine.elements, [&](Slot slot) {
      const Vec3i voxel = voxel_of(fine.elements, slot);
      const Vec3d in_body =
          body.geometry.index_from_world(fine.geometry.world_from_index(Vec3d(voxel)));
      Vec3i coarse;
      for (int c = 0; c < 3; ++c) coarse[c] = int(std::lround(in_body[c]));
      EXPECT_LT((in_body - Vec3d(coarse)).length(), 0.87);
      Slot of = 0;
      ASSERT_TRUE(slot_of(body.elements, coarse, of));
      EXPECT_EQ(fine.classes[slot], body.classes[of]);
      for (int axis = 0; axis < 3; ++axis) {
        Slot beside = 0;
        Vec3i next = voxel;
        next[axis] += 1;
        if (!slot_of(fine.elements, next, beside)) continue;
        const bool is_cut = fine.cuts.is_cut(slot / kBrickVoxels, int(slot % kBrickVoxels), axis);
        const bool is_border = (voxel[axis] + 1) % parts == 0;
        cut += is_cut;
        cut_inside += is_cut && !is_border;
        if (!is_border) continue;
        EXPECT_EQ(is_cut, body.cuts.is_cut(of / kBrickVoxels, int(of % kBrickVoxels), axis));
      }
    });
    EXPECT_GT(cut, 0);
    EXPECT_EQ(cut_inside, 0);
    // Neither a gap nor a bridge.
    EXPECT_EQ(find_islands(hex_mesh(fine)).count, find_islands(hex_mesh(body)).count);
  }
}

TEST(PropertyFemRefined, CentresPartsAndSetsFindEachOther) {
  std::mt19937 random(52);
  const Body body = random_fem_body(random, Vec3i(6, 5, 6));
  const RefinedShape refined(body, 2);
  const HexMesh mesh = hex_mesh(refined.body());
  std::vector<double> places;
  for (const Vec3d& x : node_positions(mesh)) places.insert(places.end(), {x.x, x.y, x.z});
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    const Vec3d centre = body.geometry.world_from_index(Vec3d(voxel));
    EXPECT_LT((refined.at_centre(mesh, places, voxel) - centre).length(), 1e-9);
    const std::vector<std::int32_t> parts = refined.parts_of(mesh, voxel);
    ASSERT_EQ(parts.size(), 64u);
    Vec3d mean(0.0);
    for (const std::int32_t part : parts) mean += centre_displacement(mesh, places, part) / 64;
    EXPECT_LT((mean - centre).length(), 1e-9);
    EXPECT_EQ(refined.parts_of(SlotSet(std::vector<Slot>{slot}), body.elements).size(), 64u);
  });
}

TEST(ConvergenceFemRefined, TurnsOfHandlesAreExactAndEnergyFallsTowardsItsLimit) {
  LEFT_OUT_WHEN_SANITIZED();
  // A block whose end is turned by a few degrees: lines between corners stay lines.
  Body body = fem_cube(6);
  const std::vector<Region> anchors{IndexBox{{0, 0, 0}, {5, 5, 0}}};
  std::vector<std::array<std::int32_t, 3>> each;
  Handle handle(Region(IndexBox{{0, 0, 5}, {5, 5, 5}}), {0, 0, 0});
  elements_in(body, {{0, 0, 5}, {5, 5, 5}}).for_each([&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    each.push_back({int(-0.05 * (voxel.y - 2.5) * kFixedOne),
                    int(0.05 * (voxel.x - 2.5) * kFixedOne), int(0.1 * kFixedOne)});
  });
  handle.each_by_q = each;
  std::vector<double> energies, moments;
  for (const int halvings : {0, 1, 2, 3}) {
    Body turned = body;
    Holds holds;
    VoxelFemModel model({turned, anchors, holds}, ElasticTable::uniform(5, 0.3), {}, {}, nullptr,
                        halvings);
    model.move({handle}, 1, nullptr);
    model.store();
    energies.push_back(model.report().energy_mj);
    moments.push_back(
        model.reactions(std::vector<SlotSet>{elements_in(body, {{0, 0, 5}, {5, 5, 5}})})[0]
            .moment_nmm.z);
    EXPECT_NEAR(turned.offset({0, 5, 5}, 0) / kFixedOne, -0.125, 1e-4);
    // Every node of the handle goes where the turn takes it.
    const std::vector<Vec3d> places = node_positions(model.solid().mesh());
    for (std::size_t n = 0; n < places.size(); ++n) {
      if (places[n].z < 4.5 - 1e-9) continue;
      const Vec3d u(model.displacement_mm()[3 * n], model.displacement_mm()[3 * n + 1],
                    model.displacement_mm()[3 * n + 2]);
      EXPECT_LT((u - Vec3d(-0.05 * (places[n].y - 2.5), 0.05 * (places[n].x - 2.5), 0.1)).length(),
                1e-4);
    }
  }
  for (std::size_t n = 1; n < energies.size(); ++n) {
    EXPECT_LT(energies[n], energies[n - 1]);
    EXPECT_LT(std::abs(moments[n]), std::abs(moments[n - 1]));
  }
  // Edges of what is held are singular: the order is about 1.
  EXPECT_GT((energies[1] - energies[2]) / (energies[2] - energies[3]), 1.7);
}

namespace {

/// Root mean square of the distance of elements from where finite elements have them, of their way.
double distance_of(const Body& relaxed, const Body& solved) {
  const HexMesh mesh = hex_mesh(solved);
  const std::vector<Vec3d> found = element_displacements(mesh, relaxed);
  const std::vector<Vec3d> wanted = element_displacements(mesh, solved);
  double off = 0, way = 0;
  for (std::size_t e = 0; e < wanted.size(); ++e) {
    off += (found[e] - wanted[e]).length2();
    way += wanted[e].length2();
  }
  return std::sqrt(off / way);
}

RelaxParams to_the_end(double bulk_modulus_kpa) {
  RelaxParams params;
  params.passes = 4000;
  params.tolerance_voxels = 1e-6;
  params.bulk_modulus_kpa = bulk_modulus_kpa;
  return params;
}

Body relaxed_from(Body body, const std::vector<Region>& anchors, const Handle& handle,
                  const RelaxParams& params) {
  Holds holds;
  RelaxModel model({body, anchors, holds}, params);
  model.move({handle}, 1, nullptr);
  run_model(model, params.passes);
  return body;
}

}  // namespace

TEST(ConvergenceElasticRelaxation, WithItsSurfaceHeldABodyObeysNavier) {
  // u = (x^2, 0, 0) / 10 n on the surface of a cube, whose inside is 3 kPa and nu = 0.45.
  constexpr double kYoung = 3, kPoisson = 0.45;
  std::vector<double> of_theory;
  for (const int n : {8, 16}) {
    Block block = homogeneous(Vec3i(n), 10, 0.05, 5);
    block.table.stiffness = Curve{{{0, kYoung}}};
    block.table.poisson = Curve{{{0, kPoisson}}};
    const Body rest = body_of(block);
    std::vector<Vec3i> surface;
    std::vector<std::array<std::int32_t, 3>> ways;
    for_each_element(rest.elements, [&](Slot slot) {
      const Vec3i v = voxel_of(rest.elements, slot);
      const auto is_end = [n](int at) { return at == 0 || at == n - 1; };
      if (!is_end(v.x) && !is_end(v.y) && !is_end(v.z)) return;
      surface.push_back(v);
      ways.push_back({int(0.1 * v.x * v.x / n * kFixedOne), 0, 0});
    });
    Handle handle(Region::of_points(surface, "surface"), {0, 0, 0});
    handle.each_by_q = ways;
    Body solved = rest;
    Holds holds;
    const std::vector<Region> nothing;
    VoxelFemModel fem({solved, nothing, holds}, ElasticTable::uniform(kYoung, kPoisson));
    fem.move({handle}, 1, nullptr);
    fem.store();
    RelaxParams by_material = to_the_end(0);
    by_material.poisson = true;
    EXPECT_NEAR(moduli_by_poisson(rest).kpa, kYoung / (1 - 2 * kPoisson), 1e-6 * kYoung);
    EXPECT_TRUE(moduli_by_poisson(rest).compliance.empty());
    of_theory.push_back(distance_of(relaxed_from(rest, {}, handle, by_material), solved));
    if (n == 8) continue;
    for (const double factor : {0.0, 0.2, 5.0}) {
      const RelaxParams other = to_the_end(factor * kYoung / (1 - 2 * kPoisson));
      EXPECT_GT(distance_of(relaxed_from(rest, {}, handle, other), solved), 1.5 * of_theory.back())
          << factor;
    }
  }
  // Elements hold the corners of the surface's voxels, half a voxel further in: of order 1.
  EXPECT_LT(of_theory[1], 0.06);
  EXPECT_LT(of_theory[1], 0.6 * of_theory[0]);
}

TEST(ConvergenceElasticRelaxation, APulledBlockNarrowsAlmostAsAnElasticOne) {
  Block block = homogeneous(Vec3i(12), 10, 0.05, 5);
  block.table.stiffness = Curve{{{0, 1}}};
  block.table.poisson = Curve{{{0, 0.48}}};
  const Body rest = body_of(block);
  const std::vector<Region> foot{IndexBox{{0, 0, 0}, {11, 11, 0}}};
  const Handle pull(Region(IndexBox{{0, 0, 11}, {11, 11, 11}}), {0, 0, int(0.3 * kFixedOne)});
  Body solved = rest;
  Holds holds;
  VoxelFemModel fem({solved, foot, holds}, ElasticTable::uniform(1, 0.48));
  fem.move({pull}, 1, nullptr);
  fem.store();
  RelaxParams by_material = to_the_end(0);
  by_material.poisson = true;
  EXPECT_LT(distance_of(relaxed_from(rest, foot, pull, by_material), solved), 0.06);
  EXPECT_GT(distance_of(relaxed_from(rest, foot, pull, to_the_end(0)), solved), 0.3);
}

// Effect of handles, anchors and rigid pieces on the corners of their voxels, however thin they are
// and whatever lies beside them. Oracles are motions in closed form, prescribed node by node.
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "lib/body/rigid_links.h"
#include "lib/fem/voxel/fem_results.h"
#include "lib/model/fem_model.h"
#include "lib/model/fem_motion.h"
#include "lib/session/handles/drag_handles.h"
#include "tests/lib/fem_fixtures.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Allowance for offsets, which are rounded to 2^-16 voxel.
constexpr double kRounded = 5e-5;

Body even_block(const Vec3i& dims) {
  Block block = homogeneous(dims, 1.5, 0.5, 0.5);
  block.spacing_mm = {1, 0.8, 1.3};
  return body_of(block);
}

ElasticTable soft_tissue() {
  return ElasticTable::uniform(6, 0.3);
}

FemParams exactly() {
  FemParams params;
  params.tolerance = 1e-10;
  return params;
}

Region region_in(const Body& body, const std::function<bool(const Vec3i&)>& where) {
  std::vector<Slot> slots;
  for_each_element(body.elements, [&](Slot slot) {
    if (where(voxel_of(body.elements, slot))) slots.push_back(slot);
  });
  return region_of(SlotSet(std::move(slots)), body.elements, "set");
}

Drag turned(const Region& region, const Vec3d& about_mm, double angle_deg,
            const Vec3d& scale = Vec3d(1)) {
  Drag drag{region, {0.2, -0.1, 0.15}};
  drag.motion.about_lps_mm = about_mm;
  drag.motion.axis_lps = {0.3, 1, -0.4};
  drag.motion.angle_deg = angle_deg;
  drag.motion.scale = scale;
  return drag;
}

std::vector<Handle> handles_of_drags(const Body& body, const std::vector<Drag>& drags,
                                     const Body* start = nullptr,
                                     const std::vector<Drag>* earlier = nullptr) {
  static const DensityGrid density;
  static const LinkCuts none;
  std::vector<Region> regions;
  for (const Drag& drag : drags) regions.push_back(drag.region);
  return handles_of(drags, regions,
                    {body, density, none, {}, HandleKind::two_sided, nullptr, 1, start, earlier});
}

/// Way to where the drag has a place, from that place.
std::function<Vec3d(const Vec3d&)> way_of(const Body& body, const Drag& drag) {
  const HandleMotion motion = drag.motion;
  const Turn turn = turn_about(motion.axis_lps, motion.angle_deg);
  const Vec3d shift =
      body.geometry.world_vector_from_index(drag.by_mm / body.geometry.spacing_mm());
  return [=](const Vec3d& rest_mm) {
    const Vec3d arm = rest_mm - *motion.about_lps_mm;
    return turn(arm * motion.scale) - arm + shift;
  };
}

/// The solution for motions at all nodes of their elements.
FemSolution expected(const Body& body, const std::vector<Drag>& drags, const IndexBox& fixed,
                     const FemParams& params) {
  FemLoads loads;
  for (const Drag& drag : drags) {
    HeldElements& held = loads.held.emplace_back();
    held.elements = elements_of(body, drag.region, "grab");
    held.displacement_mm = way_of(body, drag);
  }
  loads.held.emplace_back().elements = elements_in(body, fixed);
  return FemModel(body, soft_tissue()).solve(loads, params);
}

double most_apart(const std::vector<double>& a, const std::vector<double>& b) {
  double most = a.size() == b.size() ? 0 : 1e9;
  for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n) {
    most = std::max(most, std::abs(a[n] - b[n]));
  }
  return most;
}

/// Largest distance of nodes of the elements from where `wanted` has them, mm.
double most_off(const FemModel& model, const std::vector<double>& u_mm, const SlotSet& elements,
                const std::function<Vec3d(const Vec3d&)>& wanted) {
  const std::vector<Vec3d> places = node_positions(model.mesh());
  double most = 0;
  elements.for_each([&](Slot slot) {
    const std::size_t block = slot / kBrickVoxels;
    const std::int32_t e = element_at(model.mesh(), block, int(slot % kBrickVoxels));
    for (const NodeIndex node : model.mesh().corners_in(block, e)) {
      const std::size_t n = std::size_t(node);
      const Vec3d u(u_mm[3 * n], u_mm[3 * n + 1], u_mm[3 * n + 2]);
      most = std::max(most, (u - wanted(places[n])).length());
    }
  });
  return most;
}

const IndexBox kFoot{{0, 0, 0}, {2, 2, 0}};

struct ThinCase {
  const char* name;
  IndexBox grabbed;
};
const ThinCase kThin[] = {{"a voxel", {{1, 1, 8}, {1, 1, 8}}},
                          {"a row", {{0, 1, 8}, {2, 1, 8}}},
                          {"a layer", {{0, 0, 8}, {2, 2, 8}}},
                          {"two layers", {{0, 0, 7}, {2, 2, 8}}}};

}  // namespace

TEST(PropertyFemGrips, CornersFollowTheMotionOfAHandleHoweverThinItIs) {
  const Body rest = even_block({3, 3, 9});
  for (const ThinCase& thin : kThin) {
    for (const Vec3d& scale : {Vec3d(1), Vec3d(1.1, 0.95, 1.2)}) {
      SCOPED_TRACE(thin.name);
      const std::vector<Drag> drags{turned(Region(thin.grabbed), {1, 0.5, 9}, 10, scale)};
      const FemSolution wanted = expected(rest, drags, kFoot, exactly());
      Body body = rest;
      Holds holds;
      const std::vector<Region> anchors{kFoot};
      VoxelFemModel model({body, anchors, holds}, soft_tissue(), {}, exactly());
      model.move(handles_of_drags(body, drags), 1, nullptr);
      EXPECT_LT(most_apart(model.displacement_mm(), wanted.u_mm), kRounded);
      EXPECT_NEAR(model.report().energy_mj, wanted.report.energy_mj,
                  2e-4 * wanted.report.energy_mj);
      const std::vector<SlotSet> grabbed{elements_in(body, thin.grabbed)};
      const Vec3d moment = model.reactions(grabbed)[0].moment_nmm;
      EXPECT_LT((moment - wanted.reactions[0].moment_nmm).length(),
                1e-3 * wanted.reactions[0].moment_nmm.length());
    }
  }
}

TEST(PropertyFemGrips, LargerElementsKeepTheCornersOfAThinHandle) {
  const Body rest = even_block({12, 12, 12});
  const IndexBox foot{{0, 0, 0}, {11, 11, 0}};
  FemParams params;
  params.doublings = 1;
  for (const IndexBox& grabbed : {IndexBox{{5, 5, 11}, {5, 5, 11}}, {{2, 2, 11}, {9, 9, 11}}}) {
    const std::vector<Drag> drags{turned(Region(grabbed), {5, 4, 14}, 8)};
    const FemSolution wanted = expected(rest, drags, foot, params);
    Body body = rest;
    Holds holds;
    const std::vector<Region> anchors{foot};
    VoxelFemModel model({body, anchors, holds}, soft_tissue(), {}, params);
    model.move(handles_of_drags(body, drags), 1, nullptr);
    EXPECT_LT(most_apart(model.displacement_mm(), wanted.u_mm), 2 * kRounded);
    EXPECT_LT(most_off(model.solid(), model.displacement_mm(), elements_in(rest, grabbed),
                       way_of(rest, drags[0])),
              kRounded);
  }
}

TEST(PropertyFemGrips, AThinHandleThatTurnsFarIsExactAtFiniteStrainAndOfSmallerElements) {
  LEFT_OUT_WHEN_SANITIZED();
  const Body rest = even_block({3, 3, 9});
  for (const ThinCase& thin : kThin) {
    SCOPED_TRACE(thin.name);
    const std::vector<Drag> drags{turned(Region(thin.grabbed), {1, 0.8, 10.4}, 40)};
    FemParams params = exactly();
    params.strain = StrainTheory::finite;
    const FemSolution wanted = expected(rest, drags, kFoot, params);
    Body body = rest;
    Holds holds;
    const std::vector<Region> anchors{kFoot};
    VoxelFemModel model({body, anchors, holds}, soft_tissue(), {}, params);
    model.move(handles_of_drags(body, drags), 1, nullptr);
    EXPECT_LT(most_apart(model.displacement_mm(), wanted.u_mm), 2 * kRounded);
    EXPECT_NEAR(model.report().energy_mj, wanted.report.energy_mj, 2e-4 * wanted.report.energy_mj);

    Body halved = rest;
    Holds held_halved;
    VoxelFemModel fine({halved, anchors, held_halved}, soft_tissue(), {}, exactly(), nullptr, 1);
    fine.move(handles_of_drags(halved, drags), 1, nullptr);
    const RefinedShape shape(rest, 1);
    EXPECT_LT(most_off(fine.solid(), fine.displacement_mm(),
                       shape.parts_of(elements_in(rest, thin.grabbed), rest.elements),
                       way_of(rest, drags[0])),
              kRounded);
  }
}

TEST(PropertyFemGrips, OnAWayFromPoseToPoseAndInTimeAVoxelTurnsAsAWhole) {
  const Body rest = even_block({3, 3, 9});
  const std::vector<Region> anchors{kFoot};
  const IndexBox voxel = kThin[0].grabbed;
  const std::vector<Drag> first{turned(Region(voxel), {1, 0.8, 10.4}, 6)};
  const std::vector<Drag> last{turned(Region(voxel), {1, 0.8, 10.4}, 14)};
  Body body = rest;
  Holds holds;
  {
    VoxelFemModel model({body, anchors, holds}, soft_tissue(), {}, exactly());
    model.move(handles_of_drags(body, first), 1, nullptr);
    model.store();
    model.move(handles_of_drags(body, last, &rest, &first), 1, nullptr);
    EXPECT_LT(most_off(model.solid(), model.displacement_mm(), elements_in(rest, voxel),
                       way_of(rest, last[0])),
              kRounded);
  }
  FemMotionParams params;
  params.elastic = soft_tissue();
  params.density = even_density(1000);
  params.newmark.step_s = 2e-3;
  Body swung = rest;
  Holds held;
  VoxelFemMotion motion({swung, anchors, held}, params);
  motion.move(handles_of_drags(swung, last), 5, nullptr);
  for (int n = 0; n < 5; ++n) motion.step();
  EXPECT_LT(most_off(motion.solid(), motion.motion().u_mm(), elements_in(rest, voxel),
                     way_of(rest, last[0])),
            kRounded);
  motion.store();
  // Held by the step before, it stays as it is.
  VoxelFemMotion after({swung, anchors, held}, params);
  after.start_from({motion.motion().u_mm(), motion.motion().v_mm_s(),
                    element_displacements(motion.solid().mesh(), swung)});
  after.move({}, 0, nullptr);
  for (int n = 0; n < 5; ++n) after.step();
  EXPECT_LT(most_off(after.solid(), after.motion().u_mm(), elements_in(rest, voxel),
                     way_of(rest, last[0])),
            kRounded);
}

TEST(PropertyFemGrips, ARimOfOneLayerPassesThePatchTestAsAHandleAsPointsAndStillHeld) {
  const Body rest = even_block({7, 7, 7});
  const auto is_rim = [](const Vec3i& v) {
    return std::min({v.x, v.y, v.z}) == 0 || std::max({v.x, v.y, v.z}) == 6;
  };
  const Region rim = region_in(rest, is_rim);
  const Drag drag = turned(rim, {3, 2, 4}, 4, {1.04, 0.97, 1.02});
  const auto wanted = way_of(rest, drag);
  SlotSet all = elements_in(rest, {{0, 0, 0}, {6, 6, 6}});
  std::vector<Handle> points;
  elements_of(rest, rim, "grab").for_each([&](Slot slot) {
    const Vec3i voxel = voxel_of(rest.elements, slot);
    const Vec3d way =
        rest.geometry.index_vector_from_world(wanted(rest.geometry.world_from_index(Vec3d(voxel))));
    points.emplace_back(voxel, fixed_from_mm(way, Vec3d(1)));
  });
  for (const std::vector<Handle>& handles : {handles_of_drags(rest, {drag}), points}) {
    Body body = rest;
    Holds holds;
    const std::vector<Region> none;
    VoxelFemModel model({body, none, holds}, soft_tissue(), {}, exactly());
    model.move(handles, 1, nullptr);
    EXPECT_LT(most_off(model.solid(), model.displacement_mm(), all, wanted), 1e-4);
    EXPECT_TRUE(model.reaches().empty());
    model.store();
    model.move({}, 1, nullptr);
    EXPECT_LT(most_off(model.solid(), model.displacement_mm(), all, wanted), 1e-4);
  }
}

TEST(PropertyFemGrips, ATurnedPlateThatIsStillHeldStaysTurned) {
  const Body rest = even_block({3, 3, 9});
  const std::vector<Region> anchors{kFoot};
  for (const ThinCase& thin : {kThin[2], kThin[3]}) {
    const Drag drag = turned(Region(thin.grabbed), {1, 0.5, 9}, 10);
    Body body = rest;
    Holds holds;
    VoxelFemModel model({body, anchors, holds}, soft_tissue(), {}, exactly());
    model.move(handles_of_drags(body, {drag}), 1, nullptr);
    model.store();
    for (const bool is_told : {false, true}) {
      // It changes nothing if reactions are wanted of a part of what is held.
      if (is_told) model.tell_of({elements_in(body, {{0, 0, 8}, {0, 2, 8}})});
      model.move({}, 1, nullptr);
      EXPECT_LT(most_off(model.solid(), model.displacement_mm(), elements_in(body, thin.grabbed),
                         way_of(rest, drag)),
                kRounded)
          << thin.name;
    }
  }
}

TEST(PropertyFemGrips, ATurnedRigidPlateTurnsItsCornersAndBearsNoStrain) {
  for (const int thickness : {1, 2, 3}) {
    Body body = even_block({9, 9, 9});
    const IndexBox plate{{2, 2, 4}, {6, 6, 3 + thickness}};
    RigidPiece piece;
    piece.name = "plate";
    piece.elements = std::make_shared<SlotSet>(elements_in(body, plate));
    piece.centre_index = (Vec3d(plate.lo) + Vec3d(plate.hi)) / 2;
    body.rigid = numbered({piece}, body.elements);
    RigidMotion motion{turn_about({0.4, 1, 0.2}, 8), {3, 3, 5}, {0.1, 0.2, 0}};
    const std::vector<Region> anchors{IndexBox{{0, 0, 0}, {8, 8, 0}}};
    const FemModel bare(body, soft_tissue());
    FemLoads loads;
    loads.held.emplace_back().elements = *piece.elements;
    loads.held[0].displacement_mm = [&](const Vec3d& x) { return motion(x) - x; };
    loads.held.emplace_back().elements = elements_in(body, {{0, 0, 0}, {8, 8, 0}});
    const FemSolution wanted = bare.solve(loads, exactly());
    double of_tissue = 0;
    for_each_element(body.elements, [&](Slot slot) {
      if (body.rigid.at(slot) >= 0) return;
      of_tissue +=
          element_state(bare.mesh(), bare.material(), wanted.u_mm,
                        element_at(bare.mesh(), slot / kBrickVoxels, int(slot % kBrickVoxels)))
              .energy_density_kpa *
          bare.material().matrix.volume_mm3 * 1e-3;
    });
    Holds holds;
    VoxelFemModel model({body, anchors, holds}, soft_tissue(), {}, exactly());
    const std::vector<PieceMotion> led{{0, 0, motion}};
    model.move({handle_of(body, led[0], 1)}, 1, nullptr);
    EXPECT_LT(most_apart(model.displacement_mm(), wanted.u_mm), kRounded) << thickness;
    EXPECT_NEAR(model.report().energy_mj, of_tissue, 2e-4 * of_tissue);
    model.store();
    // Held by the step before, and led on from there.
    set_poses(body, led, 1);
    model.move({}, 1, nullptr);
    EXPECT_LT(most_apart(model.displacement_mm(), wanted.u_mm), kRounded) << thickness;
    EXPECT_NEAR(model.report().energy_mj, of_tissue, 2e-4 * of_tissue);
    const Turn back = motion.turn.inverse();
    const Vec3d there = motion(body.geometry.world_from_index(piece.centre_index));
    const Vec3d home = body.geometry.world_from_index(piece.centre_index) - there;
    model.move({handle_of(body, {0, 0, {back, there, home}}, 1)}, 1, nullptr);
    EXPECT_LT(most_off(model.solid(), model.displacement_mm(), *piece.elements,
                       [](const Vec3d&) { return Vec3d(0); }),
              kRounded);
  }
}

TEST(PropertyFemGrips, NothingDependsOnTheOrderOfHandlesThatTouch) {
  const Body rest = even_block({6, 3, 6});
  const std::vector<Region> anchors{IndexBox{{0, 0, 0}, {5, 2, 0}}};
  // Three voxels around an edge belong to the first of them, one to the second.
  const Handle first(
      region_in(rest, [](const Vec3i& v) { return v.z > 3 && (v.x < 3 || v.z == 5) && v.x < 4; }),
      {int(0.2 * kFixedOne), 0, 0});
  const Handle second(region_in(rest, [](const Vec3i& v) { return v.z == 4 && v.x == 3; }),
                      {kVoxel / 2, 0, kVoxel / 8});
  for (const StrainTheory strain : {StrainTheory::linear, StrainTheory::finite}) {
    FemParams params = exactly();
    params.strain = strain;
    std::vector<double> energies;
    std::vector<Vec3d> forces;
    for (const bool is_swapped : {false, true}) {
      Body body = rest;
      Holds holds;
      VoxelFemModel model({body, anchors, holds}, soft_tissue(), {}, params);
      std::vector<Handle> handles{first, second};
      if (is_swapped) std::swap(handles[0], handles[1]);
      model.move(handles, 1, nullptr);
      energies.push_back(model.report().energy_mj);
      const std::vector<Reaction> reactions = model.reactions(handles);
      forces.push_back(reactions[is_swapped].force_n);
      forces.push_back(reactions[!is_swapped].force_n);
      const Vec3d sum = forces.end()[-1] + forces.end()[-2] + model.anchor_reaction().force_n;
      EXPECT_LT(sum.length(), 1e-7 * forces.back().length());
      // The corner of all four, and one of both alone.
      const std::vector<Vec3d> places = node_positions(model.solid().mesh());
      for (std::size_t n = 0; n < places.size(); ++n) {
        const Vec3d at = rest.geometry.index_from_world(places[n]);
        const double along_x = model.displacement_mm()[3 * n];
        if ((at - Vec3d(2.5, 0.5, 4.5)).length() < 1e-6) {
          EXPECT_NEAR(along_x, (3 * 0.2 + 0.5) / 4, 1e-4);
        } else if ((at - Vec3d(2.5, 0.5, 3.5)).length() < 1e-6) {
          EXPECT_NEAR(along_x, (0.2 + 0.5) / 2, 1e-4);
        }
      }
    }
    EXPECT_NEAR(energies[1], energies[0], 1e-12 * energies[0]);
    for (int n : {0, 1}) {
      EXPECT_LT((forces[std::size_t(n)] - forces[std::size_t(2 + n)]).length(),
                1e-9 * forces[0].length());
    }
  }
}

TEST(PropertyFemGrips, AnAnchorBesideAHandleStaysAndTheHandleSaysHowFarItGoes) {
  const Body rest = even_block({4, 3, 6});
  for (const int halvings : {0, 1}) {
    Body body = rest;
    Holds holds;
    const std::vector<Region> anchors{IndexBox{{0, 0, 0}, {0, 2, 5}}};
    VoxelFemModel model({body, anchors, holds}, soft_tissue(), {}, exactly(), nullptr, halvings);
    const std::vector<Handle> pull{{Region(IndexBox{{1, 0, 3}, {1, 2, 3}}), {kVoxel / 2, 0, 0}}};
    model.move(pull, 1, nullptr);
    const std::vector<Vec3d> places = node_positions(model.solid().mesh());
    for (std::size_t n = 0; n < places.size(); ++n) {
      if (places[n].x > 0.5 + 1e-9) continue;
      for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(model.displacement_mm()[3 * n + c], 0);
    }
    ASSERT_EQ(model.reaches().size(), 1u);
    EXPECT_NEAR(model.reaches()[0].asked.x, 0.5, 1e-9);
    EXPECT_NEAR(model.reaches()[0].reached.x, 0.25, 1e-9);
    EXPECT_NEAR(model.reaches()[0].off_voxels, 0.25, 1e-9);
    const Vec3d sum = model.reactions(pull)[0].force_n + model.anchor_reaction().force_n;
    EXPECT_LT(sum.length(), 1e-7 * model.anchor_reaction().force_n.length());
    // The same handle, held by the step before: nothing changes.
    const double energy = model.report().energy_mj;
    model.store();
    model.move({}, 1, nullptr);
    EXPECT_NEAR(model.report().energy_mj, energy, 1e-9 * energy);
  }
}

TEST(PropertyFemGrips, LipsThatAreHeldApartByEarlierMovesStayApart) {
  Block block = homogeneous({8, 3, 3}, 1.5, 0.5, 0.5);
  block.cut.assign(std::size_t(block.size()), 0);
  for (int n = 0; n < block.size(); ++n) block.cut[std::size_t(n)] = block.voxel(n).x == 3;
  Body body = body_of(block);
  Holds holds;
  const std::vector<Region> anchors{IndexBox{{0, 0, 0}, {0, 2, 2}}, IndexBox{{7, 0, 0}, {7, 2, 2}}};
  VoxelFemModel model({body, anchors, holds}, soft_tissue(), {}, exactly());
  model.move({{Region(IndexBox{{3, 0, 0}, {3, 2, 2}}), {-kVoxel / 4, 0, 0}},
              {Region(IndexBox{{4, 0, 0}, {4, 2, 2}}), {kVoxel / 2, 0, 0}}},
             1, nullptr);
  const std::vector<double> opened = model.displacement_mm();
  model.store();
  model.move({}, 1, nullptr);
  EXPECT_LT(most_apart(model.displacement_mm(), opened), 1e-9);
}

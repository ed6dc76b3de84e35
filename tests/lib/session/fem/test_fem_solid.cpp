// Solids that finite elements make of bodies with rigid pieces, which find a class of their own.
#include <set>

#include <gtest/gtest.h>

#include "lib/body/rigid_links.h"
#include "lib/material/material.h"
#include "lib/model/fem_model.h"
#include "lib/session/fem/fem_solid.h"
#include "tests/lib/fem_fixtures.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr double kBoneKpa = 1e7, kBonePoisson = 0.25;

/// A block of 8^3 voxels, each half of which has every class once; the upper one is a
/// rigid piece.
Body half_rigid_block(const std::string& stiffness) {
  Body body = fem_body(8, [](const Vec3i& v) { return (v.x * 8 + v.y) * 4 + v.z % 4; });
  body.material = parse_material(
      "domain = [0, 255]\nactive = [0, 255]\nmax_length = [[0, 1.6]]\nmin_length = [[0, 0.6]]\n"
      "shear = [[0, 0.3]]\npoisson = [[0, 0.4]]\nstiffness = " +
          stiffness + "\n",
      "test");
  RigidPiece piece;
  piece.name = "upper half";
  piece.elements =
      std::make_shared<const SlotSet>(elements_in(body, {Vec3i(0, 0, 4), Vec3i(7, 7, 7)}));
  body.rigid = numbered({piece}, body.elements);
  return body;
}

/// Checks moduli; returns the number of classes that the tissue below has.
std::size_t check_moduli(const Body& body) {
  const FemSolid solid = fem_solid(body, body.cuts, kBoneKpa, kBonePoisson);
  const ElasticTable own = material_elasticity(body.material);
  std::set<int> classes;
  for_each_element(body.elements, [&](Slot slot) {
    const int of = solid.body->classes[slot];
    const bool is_rigid = body.rigid.at(slot) >= 0;
    if (!is_rigid) classes.insert(of);
    const auto n = std::size_t(of), before = std::size_t(body.classes[slot]);
    EXPECT_EQ(solid.elastic.young_kpa[n], is_rigid ? kBoneKpa : own.young_kpa[before]);
    EXPECT_EQ(solid.elastic.poisson[n], is_rigid ? kBonePoisson : own.poisson[before]);
  });
  return classes.size();
}

}  // namespace

TEST(UnitFemSolid, APieceTakesAClassThatIsAnothersTwin) {
  EXPECT_EQ(check_moduli(half_rigid_block("[[0, 6], [200, 6], [255, 90]]")), 255u);
}

TEST(UnitFemSolid, PiecesAreSoMuchStifferThanTheStiffestTissueUpToBone) {
  const auto young_of_piece = [](const std::string& stiffness) {
    const Body body = half_rigid_block(stiffness);
    const FemSolid solid = fem_solid(body, body.cuts, {}, kBonePoisson);
    double young_kpa = 0;
    body.rigid.list[0].elements->for_each(
        [&](Slot slot) { young_kpa = solid.elastic.young_kpa[solid.body->classes[slot]]; });
    return young_kpa;
  };
  EXPECT_DOUBLE_EQ(young_of_piece("[[0, 6], [200, 6], [255, 90]]"), kRigidContrast * 90);
  EXPECT_DOUBLE_EQ(young_of_piece("[[0, 6], [200, 6], [255, 9000]]"), kCorticalBone_kpa);
}

TEST(UnitFemSolid, APieceIsRefusedWhereAllClassesDiffer) {
  const Body body = half_rigid_block("[[0, 6], [255, 90]]");
  EXPECT_THROW(fem_solid(body, body.cuts, kBoneKpa, kBonePoisson), InputError);
}

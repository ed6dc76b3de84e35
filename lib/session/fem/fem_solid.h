// The solid that finite elements solve for a body with its material and rigid pieces.
#pragma once

#include <array>
#include <optional>

#include "lib/fem/dynamics/mass.h"
#include "lib/fem/voxel/fem.h"

namespace supple {

/// Cuts inside of rigid pieces are whole, and their elements have a class of their own.
struct FemSolid {
  std::optional<Body> body;  // where it is another than the session's
  ElasticTable elastic;
  MassDensities mass_density{};
  std::array<double, kLastClass + 1> damping_s{};
};

/// `cuts` are those of the body without what rigid pieces hide; Young's modulus and Poisson's ratio
/// are those of the pieces. Without a modulus they are kRigidContrast times as stiff as the
/// stiffest tissue, at most as stiff as cortical bone: an equation system is the harder to solve
/// the stiffer they are, and what a piece bends is taken out of the result. Throws InputError where
/// tissue has 256 classes and no two of them have the same moduli, density and damping.
FemSolid fem_solid(const Body& body, const LinkCuts& cuts, std::optional<double> rigid_young_kpa,
                   double rigid_poisson);

/// Elements with full integration that are stiffer than their tissue: from this Poisson's ratio on.
constexpr double kLockingPoisson = 0.45;
/// Warns where the body has such tissue.
void warn_of_locking(const Body& body, const FemSolid& solid, const ElementChoice& elements,
                     Progress* progress);

constexpr double kRigidContrast = 1e4, kCorticalBone_kpa = 18.6e6;

}  // namespace supple

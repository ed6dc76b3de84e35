#include "lib/session/fem/fem_solid.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "lib/model/fem_model.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

using ClassSet = std::array<bool, kLastClass + 1>;

/// Returns the classes of the elements in no piece.
ClassSet classes_of_tissue(const Body& body) {
  ClassSet is_used{};
  for_each_element(body.elements, [&](Slot slot) {
    if (body.rigid.at(slot) < 0) is_used[body.classes[slot]] = true;
  });
  return is_used;
}

double default_rigid_young_kpa(const ClassSet& of_tissue, const ElasticTable& elastic) {
  double stiffest_kpa = 0;
  for (std::size_t n = 0; n < of_tissue.size(); ++n) {
    if (of_tissue[n]) stiffest_kpa = std::max(stiffest_kpa, elastic.young_kpa[n]);
  }
  return stiffest_kpa > 0 ? std::min(kRigidContrast * stiffest_kpa, kCorticalBone_kpa)
                          : kCorticalBone_kpa;
}

/// A class that no element outside of the pieces has, if need be made free: its elements take
/// another class that is the same to finite elements.
std::uint8_t class_of_pieces(const Body& body, const ClassSet& is_used, FemSolid& solid) {
  const auto free = std::find(is_used.rbegin(), is_used.rend(), false);
  if (free != is_used.rend()) return std::uint8_t(is_used.rend() - free - 1);
  std::map<std::tuple<double, double, double, double>, std::uint8_t> known;
  for (int c = 0; c <= kLastClass; ++c) {
    const auto n = std::size_t(c);
    const std::tuple moduli{solid.elastic.young_kpa[n], solid.elastic.poisson[n],
                            solid.mass_density[n], solid.damping_s[n]};
    const auto known_as = known.try_emplace(moduli, std::uint8_t(c)).first;
    const std::uint8_t twin = known_as->second;
    if (twin == c) continue;
    for_each_element(body.elements, [&](Slot slot) {
      if (solid.body->classes[slot] == c) solid.body->classes[slot] = twin;
    });
    return std::uint8_t(c);
  }
  throw InputError({"", "rigid pieces", "tissue of 256 material classes that all differ",
                    "a material that leaves one of them to the pieces"});
}

}  // namespace

void warn_of_locking(const Body& body, const FemSolid& solid, const ElementChoice& elements,
                     Progress* progress) {
  if (elements.dilatation == Dilatation::mean) return;
  const ClassSet of_tissue = classes_of_tissue(body);
  double most = 0;
  for (std::size_t n = 0; n < of_tissue.size(); ++n) {
    if (of_tissue[n]) most = std::max(most, solid.elastic.poisson[n]);
  }
  if (most <= kLockingPoisson) return;
  warn(progress, "finite elements: full integration makes tissue of a Poisson's ratio of " +
                     number_text(most) + " too stiff (from " + number_text(kLockingPoisson) +
                     " on); the mean does not");
}

FemSolid fem_solid(const Body& body, const LinkCuts& cuts, std::optional<double> rigid_young_kpa,
                   double rigid_poisson) {
  FemSolid solid;
  solid.elastic = material_elasticity(body.material);
  const MaterialClasses classes(body.material);
  for (int c = 0; c <= kLastClass; ++c) {
    solid.mass_density[std::size_t(c)] = classes.mass_density_of_class(c);
    solid.damping_s[std::size_t(c)] = classes.physics(c, c).rayleigh_beta_ms * kSPerMs;
  }
  if (body.rigid.empty()) return solid;
  solid.body = body;
  solid.body->cuts = cuts;
  const ClassSet of_tissue = classes_of_tissue(body);
  const double rigid_kpa =
      rigid_young_kpa.value_or(default_rigid_young_kpa(of_tissue, solid.elastic));
  const std::uint8_t rigid = class_of_pieces(body, of_tissue, solid);
  double mass = 0;
  std::size_t count = 0;
  for (const RigidPiece& piece : body.rigid.list) {
    piece.elements->for_each([&](Slot slot) {
      mass += classes.mass_density_of_class(body.classes[slot]);
      solid.body->classes[slot] = rigid;
      ++count;
    });
  }
  solid.mass_density[rigid] = mass / double(std::max<std::size_t>(count, 1));
  solid.elastic.young_kpa[rigid] = rigid_kpa;
  solid.elastic.poisson[rigid] = rigid_poisson;
  return solid;
}

}  // namespace supple

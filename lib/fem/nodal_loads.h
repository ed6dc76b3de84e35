// Loads at the nodes of elements, three values each, and how they grow.
#pragma once

#include <cstdint>
#include <vector>

#include "lib/body/rigid_pieces.h"
#include "lib/fem/fem_report.h"
#include "volumes/base/vec.h"

namespace supple {

class ElasticSolid;

using NodeIndex = std::int32_t;

/// Held components of a node: bit a for component a of LPS.
using HeldBits = std::vector<std::uint8_t>;
constexpr std::uint8_t kAllHeld = 7;

/// The loads at the nodes, three values each.
struct NodalLoads {
  HeldBits held;
  std::vector<double> u_mm;                      // prescribed values, 0 where a component is free
  std::vector<double> force_mn;                  // empty where no force acts
  std::vector<double> swelling_kpa;              // per element; in linear theory beside its forces
  std::vector<std::vector<NodeIndex>> nodes_of;  // per HeldElements: the nodes that it holds
  /// Shares of the forces on these; empty: the whole of all.
  std::vector<std::vector<double>> shares_of;
  /// Forces on nodes by elements that are held as a whole, three per node; empty where these have
  /// none. No unknown changes them, and they may be far above all that is solved for: bone beside a
  /// lip that is led away.
  std::vector<double> within_held_mn;

  /// Share of the n-th node of nodes_of[of]; 1 where none is given.
  double share(std::size_t of, std::size_t n) const {
    return of >= shares_of.size() || shares_of[of].empty() ? 1 : shares_of[of][n];
  }
};

/// Growth of loads from nothing to the whole, for problems that are solved in steps: forces in
/// proportion; what is held goes along its rigid motion, so that a turn stays one on the way.
class LoadPath {
 public:
  /// Keeps the prescribed displacements of `loads`, and `loads` itself for the rest, without
  /// u_mm: it must outlive this.
  LoadPath(const ElasticSolid& solid, const NodalLoads& loads);

  /// Writes the prescribed displacements at a part 0 ... 1 of the loads, and nothing else.
  void prescribe(double part, std::vector<double>& u_mm) const;
  std::size_t bytes() const;

 private:
  struct Grip {
    const std::vector<NodeIndex>* nodes;
    const std::vector<double>* shares;   // null: the whole of all
    std::vector<Vec3d> rest_mm, end_mm;  // per node: where it rests, and its whole displacement
    bool is_rigid;                       // all three components are held
    RigidMotion motion;                  // nearest to the displacements

    /// Displacement of the n-th node on the way, of which the rigid motion is there.
    Vec3d at(double part, const RigidMotion& on_the_way, std::size_t n) const;
  };
  const NodalLoads* m_loads;
  std::vector<Grip> m_grips;
};

}  // namespace supple

// The membrane of `supple bench springs`: 50 x 30 nodes 1 mm apart, 1 mm thick, its rim held;
// bending springs of a tenth of the stiffness, no damping and no gravity.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lib/springs/integrators.h"

namespace supple::tools {

inline constexpr int kMembraneColumns = 50, kMembraneRows = 30;
inline constexpr double kFrameS = 0.02;

/// A membrane at rest, flat.
SpringSystem flat_membrane(double stiffness_n_m);
/// A membrane that is let go from a bump of 4 mm.
SpringSystem plucked_membrane(double stiffness_n_m);

/// Nine nodes in the middle of a flat membrane that go up and down by 5 mm once a second.
class Forceps {
 public:
  /// The frame at whose end they are highest.
  static constexpr int kHighestFrame = 12;

  explicit Forceps(SpringSystem& system);
  /// Sets where the nodes are at the end of that frame.
  void move(SpringSystem& system, int frame) const;
  /// The force in N with which the membrane pulls them down, from the reactions at held nodes.
  double pull_n(const SpringSystem& system, const std::vector<Vec3d>& reactions_n) const;

 private:
  std::vector<HeldNode> m_rest;
};

/// The membrane at rest with the forceps at their highest.
struct PulledMembrane {
  SpringSystem system;
  double energy_j, pull_n;
};
PulledMembrane pulled_membrane(double stiffness_n_m);

}  // namespace supple::tools

// The membrane of `supple bench springs`: 50 x 30 nodes 1 mm apart, 1 mm thick, its rim held;
// bending springs of a tenth of the stiffness, no damping and no gravity.
#pragma once

#include <memory>
#include <string>

#include "lib/springs/integrator.h"

namespace supple::tools {

inline constexpr int kMembraneColumns = 50, kMembraneRows = 30;
inline constexpr double kFrameS = 0.02;

/// At rest, flat.
SpringSystem flat_membrane(double stiffness_n_m);
/// Let go from a bump of 4 mm.
SpringSystem plucked_membrane(double stiffness_n_m);

/// Nine nodes in the middle of a flat membrane that go up and down by 5 mm once a second.
class Forceps {
 public:
  explicit Forceps(SpringSystem& system);
  /// Sets where the nodes are at the end of that frame.
  void move(SpringSystem& system, int frame) const;
  /// The spring energy in J of the membrane at rest with the nodes at their highest.
  static double highest_energy_j(double stiffness_n_m);

 private:
  void drive_to(SpringSystem& system, double height_mm) const;
  std::vector<HeldNode> m_rest;
};

/// "xpbd", "projective", "implicit" or "explicit", with their defaults.
std::unique_ptr<SpringIntegrator> make_integrator(const std::string& name, SpringSystem& system);

}  // namespace supple::tools

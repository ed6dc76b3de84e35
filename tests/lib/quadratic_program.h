// The least energy that the limits of the links allow, found by another method than relaxation's.
#pragma once

#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"

namespace supple::test {

/// min sum k d^2 / 2 over one coordinate of a body, -lower <= d <= upper on every link and `held`
/// elements where they are: augmented Lagrangian (Rockafellar 1974), each round by Gauss-Seidel.
class QuadraticProgram {
 public:
  QuadraticProgram(const Body& body, std::size_t c, const SlotSet& held);

  /// Energy in N/m voxel^2 after so many rounds, or once a round moves nothing by more than
  /// kStillVoxels; the worst excess of a limit in voxels.
  double minimise(int rounds, double& excess);
  /// Offsets per slot, in voxels.
  const std::vector<double>& offsets() const { return m_x; }
  void shift(Slot slot, double voxels) { m_x[slot] += voxels; }

 private:
  static constexpr double kPenalty = 20, kStillVoxels = 1e-13;
  struct Link {
    Slot low, high;
    double k, upper, lower, multiplier;
  };
  double beyond(const Link& link) const;
  double step(Slot slot);

  std::vector<double> m_x;
  std::vector<Link> m_links;
  std::vector<Slot> m_free;                    // what is not held
  std::vector<std::vector<std::size_t>> m_at;  // links of a slot
};

}  // namespace supple::test

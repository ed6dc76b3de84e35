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
  /// `held` must outlive this.
  QuadraticProgram(const Body& body, std::size_t c, const SlotSet& held);

  /// Energy in N/m voxel^2; the worst excess of a limit in voxels.
  double minimise(int rounds, double& excess);
  /// Per slot, in voxels.
  const std::vector<double>& offsets() const { return m_x; }
  void shift(Slot slot, double voxels) { m_x[slot] += voxels; }

 private:
  static constexpr double kPenalty = 20;
  struct Link {
    Slot low, high;
    double k, upper, lower, multiplier;
  };
  double beyond(const Link& link) const;
  void step(Slot slot);

  const SlotSet& m_held;
  std::vector<double> m_x;
  std::vector<Link> m_links;
  std::vector<std::vector<std::size_t>> m_at;  // links of a slot
};

}  // namespace supple::test

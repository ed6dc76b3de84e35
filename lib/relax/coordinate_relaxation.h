// Relaxation of one coordinate: with box limits the three are independent (thesis section 4.3).
//
// Costs memory and time where something moves: a brick is swept only when it or a neighbour changed
// in the pass before, by more than RelaxParams::still_voxels.
#pragma once

#include <vector>

#include "lib/relax/diagonal_sweep.h"
#include "lib/relax/movable.h"
#include "lib/relax/relaxation.h"
#include "lib/relax/stiff_clusters.h"
#include "lib/relax/sweep_kernel.h"

namespace supple {

class CoordinateRelaxation {
 public:
  /// `anchored` stays where it is; `held` keeps elements at or beyond bounds. All outlive this.
  CoordinateRelaxation(const Body& body, int coordinate, const SlotSet& anchored, const Holds& held,
                       const RelaxParams& params);

  /// Makes a pass; returns the largest step, 2^-32 voxel.
  double pass();
  /// Voxels of the bricks that the next pass looks at.
  double work_of_pass() const { return double(m_work.size()) * kBrickVoxels; }
  /// Sum of stiffness * stretch^2 over all links before the last pass: N/m * (2^-32 voxel)^2.
  double energy_before_pass() const { return m_energy; }
  double energy();
  /// Twice an upper bound of how far the energy is above the least (excess_energy.h).
  double excess() const;
  /// Writes offsets and their fractions to the body, which is that of the constructor.
  void store(Body& body) const;
  std::size_t bytes() const;

 private:
  void add_bricks();
  SweepOutcome sweep_one(std::size_t brick, const BrickMask& free, const SweepRule& rule,
                         double* out) const;
  bool is_due(std::size_t brick) const;
  bool has_diagonals() const { return m_table.links() != 6; }
  double sweep_nodes(int colour, const SweepRule& rule, bool first);
  SweepOutcome sweep_diagonals_of(std::size_t brick, const BrickMask& free,
                                  const DiagonalSweep& sweep, double* out) const;
  double step_diagonals_of(std::size_t brick, const DiagonalSweep& sweep, double* out);
  double sweep_diagonals_at_once(const SweepRule& rule);
  double sweep_diagonals(const SweepRule& rule);
  bool find_bounds(std::size_t brick, NodeBounds& out) const;
  double sweep_stiff_clusters();
  std::vector<std::uint32_t> stored_bricks() const;
  double sweep_clusters(const Clusters& clusters, double relaxation);
  double step_of_cluster(const Clusters& clusters, std::size_t cluster, double relaxation) const;
  Clusters find_tight_clusters(int block_bits) const;
  double keep_bounds(std::size_t brick, double* values, double largest) const;

  const Body& m_body;
  const std::vector<Bound>& m_at_least;
  const std::vector<Bound>& m_at_most;
  RelaxMethod m_method;
  double m_still;  // RelaxParams::still_voxels, 2^-32 voxel
  LinkTable m_table;
  bool m_is_plastic;
  int m_extent;  // of the body, voxels
  Movable m_elements;
  std::vector<std::int16_t> m_one_class;  // of bricks, with diagonals (diagonal_sweep.h)
  /// Offsets now and in the next pass, the same where the last one changed nothing. With diagonals
  /// whose nodes step in turns, the second stays empty.
  BrickArray<double> m_now, m_next;
  bool m_in_turns;
  std::vector<std::uint32_t> m_work;  // bricks of the next pass, ascending
  std::vector<char> m_changed;        // per brick, in this pass
  std::vector<char> m_is_tight;       // per brick: a link was at its limit in the last sweep
  std::vector<double> m_energies;     // per brick
  StiffClusters m_stiff;
  double m_energy = 0;
  int m_passes = 0;
};

}  // namespace supple

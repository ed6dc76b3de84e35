// Relaxation that conserves volume (thesis section 4.2.4, first suggestion): to the springs of
// relaxation.h comes the energy
//   sum over cells of kappa (V - V0)^2 / (2 V0),
// kappa a bulk modulus (cell_moduli.h), V0 the rest volume of a cell. It couples the coordinates:
// pushed together along one axis, tissue gives way across it.
//
// V is linear in each coordinate of each corner, so the energy is a parabola in each of them alone:
// with a = dV/dx of the cells around an element,
//   force -= kappa / V0 * sum of a (V - V0),   stiffness += kappa / V0 * sum of a^2,
// and a step to force / stiffness (or up to twice as far) never raises the energy, exactly.
// Elements that share a cell step one after the other, so each may use up the slack of its links:
// bricks in eight colours by the parity of their place, all of one colour at once, and inside a
// brick elements in eight colours. Nothing depends on the number of threads.
//
// Costs memory and time where something moves, as coordinate_relaxation.h: 24 bytes per element
// there. A quarter of a pass is the energy before it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/region.h"
#include "lib/body/slot_set.h"
#include "lib/relax/cell_moduli.h"
#include "lib/relax/cell_sweep.h"
#include "lib/relax/movable.h"
#include "lib/relax/relaxation.h"

namespace supple {

// Rigid clusters among cells that keep their volume: a cluster moves as one, and so changes the
// volume of the cells that only some of its elements span.

/// The clusters of one coordinate.
class VolumeClusters {
 public:
  /// `weight`: moduli.kpa * rest volume / spacing^2 of the coordinate, N/m.
  VolumeClusters(const Body& body, int coordinate, const Movable& elements, const Holds& held,
                 const CellModuli& moduli, double weight);

  /// Every cluster near a brick that is `due` steps, one after the other, each to where its links
  /// and cells balance (times `relaxation`), no further than limits and bounds allow. Marks the
  /// bricks of those that did; returns the largest step, 2^-32 voxel.
  double step(std::array<BrickArray<double>, 3>& offsets, double relaxation,
              const std::vector<char>& due, std::vector<char>& changed) const;
  std::size_t bytes() const;

 private:
  struct PartCell {
    std::array<Slot, 8> corners;
    float share;           // share_of_cell()
    std::uint8_t members;  // bit per corner
  };
  void find_cells_of_clusters(const CellModuli& moduli);
  bool is_due(std::size_t cluster, const std::vector<char>& due) const;
  double step_of(std::size_t cluster, const std::array<BrickArray<double>, 3>& offsets,
                 double relaxation) const;

  const Body& m_body;
  const Movable& m_elements;
  const std::vector<Bound>& m_at_least;
  const std::vector<Bound>& m_at_most;
  std::size_t m_coordinate;
  double m_weight;
  std::vector<PartCell> m_cells;            // by cluster
  std::vector<std::uint32_t> m_first_cell;  // of each cluster; one more at the end
  std::vector<std::uint32_t> m_bricks;      // by cluster: where its own and its links' elements lie
  std::vector<std::uint32_t> m_first_brick;  // of each cluster; one more at the end
};

class VolumeRelaxation {
 public:
  /// `anchored` stays where it is; `held` bounds elements. All three outlive this. `method` is
  /// red_black, without over-relaxation, or accelerated.
  VolumeRelaxation(const Body& body, const SlotSet& anchored, const Holds& held, RelaxMethod method,
                   const CellModuli& moduli);

  /// Makes a pass; returns the largest step in voxels.
  double pass();
  /// Voxels of the bricks that the next pass looks at, in each coordinate.
  double work_of_pass() const;
  /// Energy of links and cells before the last pass, in uJ.
  double energy_before_pass() const { return m_energy; }
  double energy();
  /// Writes offsets and their fractions to the body, which is that of the constructor.
  void store(Body& body) const;
  std::size_t bytes() const;

 private:
  struct Coordinate {
    LinkTable table;
    Movable elements;
    double fine_mm;  // 2^-32 voxel in mm
  };
  struct BrickData;

  void find_work();
  void load(std::size_t brick, BrickData& data) const;
  LinkTables tables() const;
  double energy_of(std::size_t brick) const;
  double sweep(std::size_t brick, double relaxation);
  bool find_bounds(std::size_t brick, BrickBounds& out) const;
  std::array<const BrickRest*, 3> rest_of(const BrickData& data) const;

  const Body& m_body;
  const Holds& m_held;
  RelaxMethod m_method;
  int m_extent;  // of the body, voxels
  CellModuli m_moduli;
  bool m_is_plastic = false;
  double m_cell_energy;                     // uJ of a cell's excess squared, (2^-32 voxel)^6
  std::array<double, 3> m_weight;           // CellSweep::weight
  std::vector<Coordinate> m_coordinates;    // three
  std::vector<VolumeClusters> m_clusters;   // per coordinate
  std::array<BrickArray<double>, 3> m_now;  // 2^-32 voxel
  std::array<std::vector<std::uint32_t>, 8> m_work;  // bricks of the next pass, by colour
  std::vector<char> m_due;                           // per brick: in m_work
  std::vector<char> m_changed;                       // per brick, in this pass
  std::vector<double> m_energies;                    // per brick, uJ
  double m_energy = 0;
  int m_passes = 0;
};

}  // namespace supple

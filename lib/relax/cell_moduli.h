// Bulk moduli with which cells keep their volume: one for all, or each after the material of its
// corners.
#pragma once

#include <array>
#include <vector>

#include "lib/body/body.h"
#include "lib/relax/cell_brick.h"
#include "lib/relax/relaxation.h"

namespace supple {

struct CellModuli {
  double kpa = 0;  // of all cells, or what theirs are shares of; 0: none keeps its volume
  std::vector<double> compliance;  // per class of elements: `kpa` over its own; empty: all alike

  bool any() const { return kpa > 0; }
};

/// E / (1 - 2 nu) of every class, with which relaxation has Navier's equations inside of tissue;
/// `kpa` is the mean over the elements outside of rigid pieces. Springs alone minimise
/// E |grad u|^2 / 2, whose equations lack the part (lambda + mu) grad div u of elasticity; with mu
/// = E the cells add it, lambda + mu being mu / (1 - 2 nu). At free surfaces both energies differ
/// (docs/models/relaxation.md).
CellModuli moduli_by_poisson(const Body& body);

/// The moduli that the parameters ask for.
CellModuli moduli_of(const Body& body, const RelaxParams& params);

/// Share of `kpa` that a cell between these elements has. All of it is under one pressure, so that
/// the compliances of its corners are averaged. Corners in rigid pieces give way to no pressure and
/// do not count.
double share_of_cell(const Body& body, const CellModuli& moduli,
                     const std::array<Slot, 8>& corners);

/// Fills in CellBrick::root_share of the cells that are there.
void find_shares(const Body& body, const CellModuli& moduli, const BricksAround& around,
                 CellBrick& brick);

}  // namespace supple

// Random bodies that were dragged, to be relaxed, and the energies of relaxation by definition.
#pragma once

#include <optional>
#include <random>
#include <vector>

#include "lib/model/relax_model.h"
#include "tests/lib/test_bodies.h"

namespace supple::test {

/// A random body after some random drags, and what these hold.
struct Dragged {
  Body body;
  Holds holds;
  std::vector<Region> anchors;
};

Dragged dragged(std::mt19937& random, const Vec3i& max_dims, int links = 6);

/// N/m of a link of 1 kPa that leaves a voxel in that direction, by the definition in
/// docs/models/relaxation.md.
double spring_share(const Vec3d& spacing_mm, int links, int direction);

/// Parameters that relax until nothing moves.
RelaxParams to_rest(double kpa = 0);

Relaxation relaxation_of(Dragged& dragged, const RelaxParams& params);

/// Relaxes, and fails the test unless anchors and two-sided handles stay and push handles keep
/// their side; how many elements then lie at the bound of one.
int expect_held_through(Dragged dragged, const RelaxParams& params);

/// Fails the test unless one thread and four relax to the same bits.
void expect_same_on_any_threads(const Dragged& dragged, const RelaxParams& params);

/// Energy of all links by stored offsets, in uJ; a spring beyond its yield stretch pulls no more.
double spring_energy(const Body& body);

/// Energy of all cells with that bulk modulus in kPa, in uJ: their volume by integration. Without
/// one: with the harmonic mean of E / (1 - 2 nu) at their corners.
double cell_energy(const Body& body, std::optional<double> kpa);

/// Integral of the Jacobian over the trilinear cell; corner 4 i + 2 j + k is (i, j, k) steps from
/// the lowest one.
double integrated_volume(const std::array<Vec3d, 8>& corners);

}  // namespace supple::test

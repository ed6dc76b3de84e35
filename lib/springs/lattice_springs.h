// Springs on a voxel body, a mass at every element: structural ones on its links, shear ones on the
// diagonals of its squares, bending ones over two links in a row (X. Provot, Deformation
// constraints in a mass-spring model, 1995, for lattices).
//
// Cost: 4 bytes per voxel of the bricks meanwhile; inside a body 9 springs per element, 12 with
// bending ones, and with their cells some 670 bytes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/springs/spring_system.h"
#include "volumes/base/progress.h"

namespace supple {

struct LatticeSpringParams {
  double structural_n_m = 100;
  double shear_n_m = 50;           // 0: none
  double bending_n_m = 10;         // 0: none
  double damping_n_s_m = 0;        // per spring, along it
  double stiffness_damping_s = 0;  // Rayleigh's beta: adds beta k to a spring's damping
  double mass_damping_per_s = 0;   // Rayleigh's alpha
  double density_kg_m3 = 1000;
  /// Per material class, factors of the stiffnesses and of the density (empty: 1), and terms added
  /// to stiffness_damping_s (empty: nothing). A spring has the mean of its ends' values (thesis
  /// section 4.2.3).
  std::vector<double> class_stiffness, class_density, class_damping_s;

  /// Throws InputError: a value that is negative or not finite, tables of other than 256 entries.
  void validate() const;
};

/// Springs of the body's material: stiffness, density and damping of its columns, or their defaults
/// (material.h). Structural and shear springs of 2/5 E h, no bending ones: on cubic voxels of h an
/// isotropic solid of Young's modulus E and Poisson's ratio 1/4, exactly (lattice_springs.cpp);
/// otherwise h is the cube root of the voxel's volume.
LatticeSpringParams material_springs(const Body& body);

/// The springs of a body and where their nodes lie in it: node n is the element of slot slots[n],
/// ascending.
struct LatticeSprings {
  SpringSystem system;
  std::vector<Slot> slots;

  /// Node of an element; -1 where there is none.
  int node_of(Slot slot) const;
};

/// Makes springs: rest lengths in mm from the lattice and the body's rest stretches, positions and
/// velocities of the body. A diagonal needs all four voxels and links of its square, a bending
/// spring its middle voxel and both links: a spring never joins the sides of a cut. Throws
/// InputError as validate(), and for an element without mass; Cancelled.
LatticeSprings make_springs(const Body& body, const LatticeSpringParams& params,
                            const Progress* progress = nullptr);

/// Takes positions, from offsets and their fractions, and velocities of the body.
void take_state(const Body& body, LatticeSprings& springs);

/// Gives positions as offsets with fractions, rounded to 2^-32 voxel, and velocities: a state taken
/// by take_state() goes back bit for bit. Velocities that are all 0 take no memory in the body.
/// Unless nothing moved, links are not known to be valid afterwards (check_links, project). Returns
/// the largest rounding in voxels. Throws InputError for an offset beyond +-16383 voxels; the body
/// is unchanged then.
double give_state(const LatticeSprings& springs, Body& body);

}  // namespace supple

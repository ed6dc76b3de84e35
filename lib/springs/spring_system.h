// Masses joined by springs (thesis section 3.2): the system that builders make and integrators
// move.
//
// Units: positions in LPS mm, velocities in mm/s; masses in kg, stiffness in N/m, damping in N s/m.
// These fit together without factors, since kg mm/s^2 = mN and N/m * mm = mN. Reports are in N and
// J.
//
// Force on node i (eqs. 3.15 and 3.16; eq. 6.1 is misprinted, with k|x| - R for k(|x| - R)):
//   F_i = sum_j n_ij (k_ij (|x_ij| - R_ij) + d_ij n_ij.(v_j - v_i)) - alpha m_i v_i + m_i g
// with x_ij = x_j - x_i and n_ij = x_ij / |x_ij|. Damping acts along the spring only, so that it
// leaves rigid motion alone; the mass damping alpha does not.
// A barrier adds to that where cells are about to turn inside out (cell_barrier.h).
//
// Memory: 56 bytes per node and 32 per spring.
#pragma once

#include <cstddef>
#include <vector>

#include "lib/contact/cell_barrier.h"
#include "lib/contact/collider_contact.h"
#include "volumes/base/progress.h"
#include "volumes/base/vec.h"

namespace supple {

struct Spring {
  int a, b;                  // nodes
  double rest_mm;            // R, >= 0
  double stiffness_n_m;      // k, >= 0
  double damping_n_s_m = 0;  // d along the spring, >= 0
};

/// A node that goes where it is told: fixed while its target is where it is, driven otherwise.
struct HeldNode {
  int node;
  Vec3d target_mm;  // where it is at the end of the next step; it moves there at constant speed
};

struct SpringSystem {
  std::vector<double> mass_kg;       // per node, > 0
  std::vector<Vec3d> pos_mm;         // per node
  std::vector<Vec3d> velocity_mm_s;  // per node
  std::vector<Spring> springs;
  std::vector<HeldNode> held;       // ascending nodes
  std::vector<Collider> colliders;  // that no node may enter
  CellBarrier barrier;              // of lattices
  Vec3d gravity_m_s2{0, 0, 0};
  double mass_damping_per_s = 0;  // Rayleigh's alpha; its beta is part of the springs' damping

  std::size_t node_count() const { return mass_kg.size(); }
  std::size_t bytes() const;
};

/// Throws InputError that names the fault: lengths that differ, a mass that is not positive, a
/// spring with equal or missing ends or negative values, held nodes out of order, anything that is
/// not finite.
void validate(const SpringSystem& system);

/// Holds a node where it is. Throws InputError when there is no such node.
void hold(SpringSystem& system, int node);
/// Lets a node go; its velocity stays.
void release(SpringSystem& system, int node);
/// Sets where a held node is to be at the end of the next step. Throws InputError when it is not
/// held or the target is not finite.
void drive(SpringSystem& system, int node, const Vec3d& target_mm);

/// Present energies in J. Gravity's is -m g.x, 0 at the origin of the world. A held node counts.
struct SpringEnergy {
  double kinetic_j = 0;
  double spring_j = 0;  // with the awake barrier
  double gravity_j = 0;

  double total_j() const { return kinetic_j + spring_j + gravity_j; }
};
SpringEnergy energy(const SpringSystem& system);

/// Springs between two polls of a loop over the springs of a solid, which may be 20 million.
constexpr std::size_t kSpringsPerPoll = 65536;

/// Sums the forces of springs (stiffness, and damping unless Damping::without), awake barrier, mass
/// damping and gravity on every node, in mN. A spring of length 0 has no direction and pulls
/// nowhere: returns how many there are. Throws Cancelled. About 10 ns per spring.
enum class Damping { with, without };
int forces_mn(const SpringSystem& system, std::vector<Vec3d>& force, Damping damping,
              const Progress* progress = nullptr);

}  // namespace supple

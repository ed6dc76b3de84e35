// Springs on a mesh body: structural ones on its links, bending ones between the two vertices
// opposite of an edge that two triangles share (thesis section 6.1.2 has the former; X. Provot,
// Deformation constraints in a mass-spring model, 1995, both).
#pragma once

#include "lib/mesh/mesh_body.h"
#include "lib/springs/spring_system.h"

namespace supple {

struct MeshSpringParams {
  double structural_n_m = 100;
  double bending_n_m = 10;         // 0: none
  double damping_n_s_m = 0;        // per spring, along it
  double stiffness_damping_s = 0;  // Rayleigh's beta: adds beta k to a spring's damping
  double mass_damping_per_s = 0;   // Rayleigh's alpha
  double density_kg_m3 = 1000;
  double thickness_mm = 1;  // of triangles
  double section_mm2 = 1;   // of links that belong to neither triangle nor tetrahedron

  /// Throws InputError: a value that is negative or not finite.
  void validate() const;
};

/// Makes springs: rest lengths from the rest positions, positions and velocities as they are. A
/// node's mass is its share, in equal parts, of the connectors at rest: the volume of tetrahedra;
/// of triangles, where there are no tetrahedra, area times thickness; of links of neither, length
/// times section. Throws InputError also for a node without mass.
SpringSystem make_springs(const MeshBody& body, const MeshSpringParams& params);

/// Give the present positions and velocities of the system (made from this body) to the body, and
/// take them back. Velocities that are all 0 take no memory in the body. Throws InputError when the
/// numbers of nodes differ.
void give_state(const SpringSystem& system, MeshBody& body);
void take_state(const MeshBody& body, SpringSystem& system);

}  // namespace supple

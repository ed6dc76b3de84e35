// Loads on a mesh of tetrahedra.
#pragma once

#include <string>
#include <vector>

#include "lib/fem/nodal_loads.h"

namespace supple {

/// Solver of the equations: conjugate gradients, or exact factors for many loads.
enum class TetEquations { gradients, factor };

/// Nodes that are held or led. Components are bits as in HeldBits.
struct TetHeld {
  std::vector<NodeIndex> nodes;
  std::uint8_t components = kAllHeld;
  std::vector<Vec3d> displacement_mm = {};  // LPS, per node, or one for all; empty: at rest
  bool holds_turns = false;  // of the edges of sheets that have both ends here: clamped
};

struct TetForce {
  NodeIndex node = 0;
  Vec3d force_mn{0, 0, 0};  // LPS
};

/// A pressure on the faces of a set; positive from outside.
struct FacePressure {
  std::string faces;
  double pressure_kpa = 0;
};

struct TetLoads {
  std::vector<TetHeld> held;
  std::vector<TetForce> forces;
  std::vector<FacePressure> pressures;
  /// Pressure inside each element, kPa: free of load it swells by dV/V = p / K. Empty: none.
  std::vector<double> swelling_kpa;
  Vec3d gravity_m_s2{0, 0, 0};        // LPS
  std::vector<double> density_kg_m3;  // per material of the mesh, for gravity
};

}  // namespace supple

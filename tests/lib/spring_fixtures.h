// Small spring systems for tests.
#pragma once

#include <memory>
#include <random>
#include <string>

#include "lib/mesh/mesh_body.h"
#include "lib/springs/spring_system.h"

namespace supple::test {

/// A mass at (rest + stretch, 0, 0) on a spring to a held node at the origin.
SpringSystem oscillator(double mass_kg, double stiffness_n_m, double damping_n_s_m, double rest_mm,
                        double stretch_mm);

/// Masses along x at the springs' rest length.
SpringSystem chain(int nodes, double mass_kg, double stiffness_n_m, double spacing_mm);

/// A rectangle of columns x rows vertices at z = 0, two triangles per cell.
TriangleMesh sheet(int columns, int rows, double spacing_mm);

/// Random masses, springs of all lengths, positions and velocities; springs longer than 0.5 mm.
SpringSystem random_system(std::mt19937& random, int nodes, int springs);

}  // namespace supple::test

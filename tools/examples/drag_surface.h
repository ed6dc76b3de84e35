// An example of ECM on a mesh body: a surface file, pulled at a point.
#pragma once

#include <string>
#include <vector>

namespace supple::examples {

/// Lengths in LPS mm.
struct SurfaceDrag {
  std::string input, output;     // STL, PLY, OBJ or VTK; the output has the input's format
  std::vector<double> grab, by;  // x, y, z: the vertex nearest to `grab` moves by `by`
  double fix_beyond = 0;         // vertices further away from it stay; 0: none do
  double max_length = 1.2, min_length = 0.8, shear = 0.2;
};

/// Writes the file again with its vertices moved, and prints a report. Throws InputError.
void drag_surface(const SurfaceDrag& drag);

}  // namespace supple::examples

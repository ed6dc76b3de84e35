// The record of a step of finite elements on tetrahedra, beside that of all finite elements.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/fem/tet/tet_contact.h"
#include "volumes/base/value.h"

namespace supple {

/// An opening after the step.
struct TetOpeningRecord {
  std::string name;
  double area_mm2 = 0;                  // at rest
  double bulge_mm = 0;                  // largest displacement along the outward normal at rest
  double out_ml = 0;                    // between its faces at rest and displaced
  std::optional<double> free_area_mm2;  // in a shell: of faces without a node on it
};

struct TetRecord {
  std::int64_t tetrahedra = 0, nodes = 0, outer_faces = 0;
  double mesh_ml = 0, voxels_ml = 0;  // at rest
  double least_dihedral_deg = 0, largest_dihedral_deg = 0;
  std::int64_t unmeshed = 0;     // voxels in parts that the mesh leaves out, which stay at rest
  std::int64_t far = 0;          // voxels that go with a tetrahedron far away
                                 // voxels too far from all tetrahedra, which stay at rest
  double mean_pressure_kpa = 0;  // of all elements by volume, positive where compressed
  std::vector<TetOpeningRecord> openings;
  std::optional<ShellContactReport> shell;
  std::optional<FemReaction> outside;  // where it is held
};
Value to_value(const TetRecord& record);

}  // namespace supple

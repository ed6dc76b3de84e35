// A step of finite elements on tetrahedra (docs/models/tets.md): the mesh of the body, its
// openings, sheets and shell. Loads, gravity and tolerances are those of FemStep
// (lib/session/fem_step.h), which points to this.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/fem/tet/shell_triangles.h"
#include "lib/fem/tet/tet_loads.h"
#include "lib/fem/tet/tet_volumes.h"
#include "lib/material/material.h"
#include "lib/mesh/tets/make_solid.h"
#include "lib/session/handles/selection.h"
#include "volumes/base/fields.h"

namespace supple {

/// A part of the outer surface under a name: faces seen from the mesh's centroid within an angle
/// of a direction, or faces of the elements of a part of the body.
struct TetOpening {
  std::string name;
  std::optional<Vec3d> toward;  // LPS
  double degrees = 0;
  std::optional<ChosenPart> part;
};
Fields fields(TetOpening& opening);

/// A sheet on an opening or on the rest of the outer surface (`faces` of its sheet), or on the
/// border of two labels.
struct TetSheet {
  ElasticSheet sheet{"", SheetKind::both, 0, kDefaultPoisson, 0};
  std::optional<std::pair<std::int32_t, std::int32_t>> between;
};
Fields fields(TetSheet& sheet);

/// The outer surface in no opening: free, held where it is, or against a fixed shell.
enum class TetOutside { free, held, shell };
/// The name of these faces.
constexpr const char* kOutside = "outside";

struct TetStep {
  std::string mesh;  // file of a mesh, LPS mm; empty: made of the body
  SolidParams solid;
  int bins = 32;            // at most so many materials
  bool has_labels = false;  // labels are regions of the mesh
  TetElement element = TetElement::nodal_pressure;
  TetEquations equations = TetEquations::gradients;
  TetOutside outside = TetOutside::free;
  bool has_planes = false;  // as TetShellContact
  bool frees_rims = false;  // of openings, in a shell
  bool clamps = false;      // sheets between held nodes do not turn
  std::vector<TetOpening> openings;
  std::vector<TetSheet> sheets;
};
Fields fields(TetStep& step);
/// Returns the step as a journal records it.
Value settings_value(const TetStep& step);
/// The key of a step that another one of it rules out; its file is empty.
std::optional<Problem> contradiction(const TetStep& step, StrainTheory strain);

}  // namespace supple

// Results of a step of finite elements on tetrahedra: its record, and warnings of it.
#pragma once

#include <optional>

#include "lib/fem/tet/tet_contact.h"
#include "lib/session/fem_task.h"
#include "lib/session/tets/tet_body.h"

namespace supple {

struct SolvedTets {
  const FemStep& step;
  const FemTask& task;
  const TetBody& tets;
  const SolidMesh& mesh;  // with the faces of pressures
  const TetModel& model;
  const TetSolution& solution;
  const TetLoads& loads;
  const std::optional<ShellContactReport>& shell;
};

/// Tells all but the reactions of handles and anchors; those of a held outside are the last ones.
FemRecord record_of(const SolvedTets& solved);
void warn_of_tets(const FemStep& step, const FemRecord& record, Progress* progress);

inline Vec3d displacement_of(const TetSolution& solution, NodeIndex node) {
  const double* u = &solution.u_mm[3 * std::size_t(node)];
  return {u[0], u[1], u[2]};
}
/// The voxel at the middle of a tetrahedron.
Vec3i middle_voxel(const SolidMesh& mesh, std::size_t tet, const Geometry& geometry);

}  // namespace supple

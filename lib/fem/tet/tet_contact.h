// Unilateral contact of a body with a fixed shell, such as the brain's with the skull: faces of the
// body rest against it, slide along it without friction, may part from it, and never enter it.
//
// The shell is where the named faces are at rest; what lies outside is solid. A node's normal n is
// that of the shell where it rests, and along n the shell is at a distance g from there, so that
//
//   n . u <= g,   pressure >= 0,   one of the two an equality.
//
// With g fixed, each round solves for those nodes that are on the shell, and takes for the next
// those that press and those that are beyond their bound (primal-dual active set, Hintermueller,
// Ito & Kunisch 2002). Nodes of the shell have a frame along n for that, so that a bound is a
// component that is held. When the same nodes press, g is found anew where the node has slid to,
// and gone to in part where that leads away, until none is off the shell by more than
// `tolerance_mm`. Pressures act along n, as small displacements have it.
//
// Openings are other sets of faces. Nodes of their rim are nodes of the shell, too, and stay behind
// it, unless `frees_rims`; the areas of the report tell of both.
#pragma once

#include <string>
#include <vector>

#include "lib/fem/tet/tet_fem.h"

namespace supple {

struct TetShellContact {
  std::vector<std::string> faces;     // that rest against the shell
  std::vector<std::string> openings;  // whose areas are told
  bool frees_rims = false;            // nodes that openings share with the shell
  /// The shell is a plane for each node, g = 0, as linear theory has it: for slides by much of its
  /// radius. `deepest_mm` tells how far nodes are beyond the true one.
  bool has_planes = false;
  double tolerance_mm = 5e-4;
  int max_rounds = 200;

  /// Throws InputError.
  void validate() const;
};

struct ShellOpening {
  std::string name;
  double area_mm2 = 0;       // of its faces at rest
  double free_area_mm2 = 0;  // of those that have no node on the shell
};

struct ShellContactReport {
  int rounds = 0;
  std::int64_t nodes = 0, pressing = 0;
  double deepest_mm = 0;        // of a node beyond the shell
  double pressed_area_mm2 = 0;  // of the nodes that press
  double largest_pressure_kpa = 0;
  Vec3d force_n{0, 0, 0};  // of the body on the shell
  /// |loads and reactions and the shell's forces| relative to the sum of their lengths.
  double force_balance = 0;
  std::vector<ShellOpening> openings;
};

struct TetContactSolution {
  /// Iterations and time are of all rounds, the residual of the last; reactions without the shell.
  TetSolution solution;
  ShellContactReport report;
  std::vector<NodeIndex> nodes;      // of the shell, ascending
  std::vector<double> pressure_kpa;  // on each, 0 where it has parted
};

/// Throws InputError: as TetModel::solve(), sets of faces that are not there; NotConverged, Error
/// where rounds do not end, Cancelled. Something must be held that prevents rigid motions: the
/// shell alone does not.
TetContactSolution solve_in_shell(const TetModel& model, const TetLoads& loads,
                                  const TetShellContact& shell, const TetParams& params = {},
                                  Progress* progress = nullptr);

}  // namespace supple

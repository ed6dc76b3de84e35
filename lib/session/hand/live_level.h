// Responses of a hand's directions as they are found; part of live_responses.h.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lib/fem/response/response_field.h"
#include "lib/fem/voxel/level_solver.h"
#include "lib/session/hand/live_responses.h"

namespace supple {

/// The body as a direction, or the place where the handle is, makes it.
struct LiveResponse {
  int doublings = 0;
  bool is_last = false;
  ResponseValues displacements;      // of elements, mm, LPS
  Vec3d force_n{0, 0, 0};            // of the handle
  std::vector<PieceMoments> pieces;  // per piece
  std::optional<double> change_mm;   // since the level before; none was
};

struct LiveLevel {
  std::vector<std::shared_ptr<const LiveResponse>> of;  // the base, and directions that are there
  ResponseField field;                                  // of all of them
};

/// Loads of a direction, or of the place where the handle is, and how far they are solved.
struct LiveResponses::Direction {
  NodalLoads loads;
  int next_level = 0;
  std::optional<NodalSolution> solution;  // of the next level, until all directions have theirs
  std::shared_ptr<const LiveResponse> best;
};

}  // namespace supple

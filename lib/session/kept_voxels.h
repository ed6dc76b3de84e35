// The solid of a session's body with the solutions that it has had, from which later steps are sums
// (lib/fem/response).
#pragma once

#include <memory>
#include <string>

#include "lib/fem/response/response_set.h"
#include "lib/model/fem_model.h"
#include "lib/session/fem/fem_solid.h"
#include "lib/session/fem_step.h"

namespace supple {

struct FemTask;  // lib/session/fem_task.h

/// A body with material, cuts and pieces, ready for any number of steps, which share its elements.
struct KeptVoxels {
  ResponseKey key;
  FemSolid solid;
  VoxelFemModel model;  // of the body of its first step: not to be moved

  KeptVoxels(ResponseKey of, const FemStep& step, const FemTask& task, Progress* progress);
};

/// Findings of the steps so far; steps that are undone take theirs with them.
struct FemResponses {
  std::shared_ptr<KeptVoxels> voxels;
  ResponseSet known;

  /// Memory of what `other` does not share.
  std::size_t bytes_beyond(const FemResponses* other) const;
};

/// The loads of a step but for what is held. Throws InputError for one without element.
FemLoads loads_of(const FemStep& step, const FemTask& task, const FemSolid& solid);

/// Why a step is not a sum of earlier ones, whatever these were; empty where it may be one.
std::string why_no_sum(const FemParams& params);

/// The report of a sum as programs read it.
Value as_value(const ResponseReport& report);

/// The key of the solid of a step: elements, cuts, material, pieces and kind of elements.
ResponseKey solid_key(const FemStep& step, const FemTask& task);

}  // namespace supple

// One solve of a step.
#pragma once

#include <vector>

#include "lib/session/session_body.h"

namespace supple {

/// Handles and pieces on their way.
struct StepTask {
  SessionBody& in;
  const std::vector<Handle>& handles;
  const std::vector<PieceMotion>& pieces;  // that these turn
  StepRecord& record;
  Progress* progress;
};

/// Work of a model (step_model.h).
struct ModelTask : StepTask {
  const HandleLedger& ledger;
  const FemNodes& nodes;  // of the step before

  /// The elements of handles whose reactions are wanted.
  std::vector<SlotSet> told() const {
    return record.tells_reactions ? ledger.elements() : std::vector<SlotSet>();
  }
  /// Nothing of a relaxation or a shift before is left.
  void start_anew() const {
    in.relaxed_by = {};
    in.forget_shifts();
  }
};

}  // namespace supple

// One solve of a step, which goes from the model through contact to the drag.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "lib/session/step_model.h"
#include "lib/session/step_task.h"

namespace supple {

class CutContact;

inline bool is_whole(const EcmReport& report) {
  return report.fraction_numerator == report.fraction_denominator;
}

/// Drags by Enhanced ChainMail or within ball limits, free rigid pieces included, as if nothing met
/// (free_drag.cpp).
void drag_freely(const StepTask& task);
/// Does the drag of which the record tells, with free pieces at these poses, which nothing holds
/// then.
void move_with(const StepTask& task, const std::vector<Handle>& handles,
               const std::vector<FreePose>& poses);

/// Drags with bones and the sides of cuts kept apart (contact_drag.cpp). Returns their contact, or
/// null.
std::unique_ptr<CutContact> drag_apart(const StepTask& task);
/// Makes the contact; none where no cut can close, or nothing is to be kept apart.
std::unique_ptr<CutContact> contact_of(SessionBody& in, const Step& step);

/// For finite elements, which know no contact: the part of the handles' way that bones leave each
/// other while all others stay. `pieces` go that part.
double shorten_for_bones(SessionBody& in, std::vector<PieceMotion>& pieces, StepRecord& record,
                         Progress* progress);
/// Finds, each time, the free pieces that finite elements have led into others by now: where each
/// meets the first of these, which takes it along from there. The record tells of all. Null where
/// pieces may pass through each other.
std::function<std::vector<FreePose>(bool is_last)> keeping_apart(const StepTask& task);

/// The rows (step_model.h).
StepModel chainmail_model();
StepModel spring_model();
StepModel fem_model();
StepModel tet_model();

/// Settings and results of finite elements as a journal records them.
Value fem_settings(const StepRecord& record);

}  // namespace supple

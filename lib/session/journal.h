// Journal of a body: the steps that were asked of it, as its state file records them.
#pragma once

#include <string>
#include <vector>

#include "lib/session/step.h"

namespace supple {

/// Writes a line of JSON: program and steps, those of the journal of an earlier session first (its
/// JSON; empty: none).
std::string journal_json(const std::string& earlier, const std::vector<StepRecord>& records);

}  // namespace supple

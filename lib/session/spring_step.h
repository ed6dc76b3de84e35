// A step in which springs move the body, for a time or to rest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/body/body.h"
#include "lib/model/model.h"
#include "lib/session/step.h"
#include "lib/springs/spring_report.h"
#include "volumes/base/fields.h"
#include "volumes/base/progress.h"
#include "volumes/base/value.h"

namespace supple {

struct Handle;
struct HeldBody;

/// Moves the body. Warns of links beyond their limits, and of a minimum that was not reached.
/// Throws InputError as VoxelSpringModel; Cancelled, the body at the last finished step.
SpringRecord move_by_springs(const SpringStep& step, const HeldBody& held,
                             const std::vector<Handle>& handles,
                             const std::vector<SlotSet>& gripped, Progress* progress);

/// Keys of `springs = { … }` in a scene, but for its shapes in contact.
Fields fields(SpringStep& step);
/// The fields without effect: those of a motion in a minimisation, and the other way round.
std::vector<std::string> idle_fields(const SpringStep& step);

/// Returns the step as a journal records it, without fields that have no effect.
Value settings_value(const SpringStep& step);

}  // namespace supple

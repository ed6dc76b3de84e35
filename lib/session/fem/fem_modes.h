// The lowest modes of vibration in a step of finite elements, and the body in the shape of one.
#pragma once

#include <optional>
#include <vector>

#include "lib/body/slot_set.h"
#include "lib/fem/dynamics/modes.h"
#include "lib/fem/fem_report.h"
#include "lib/session/fem/fem_solid.h"
#include "volumes/base/fields.h"

namespace supple {

/// A twentieth of the diagonal of the elements' box.
double default_amplitude_mm(const Body& body);

/// Modes with these elements at rest, of a body that finite elements see as `shape`. Throws as
/// FemModel and lowest_modes().
ModesRecord find_modes_of_body(const ModeStep& step, const FemParams& params, const Body& shape,
                               const FemSolid& solid, const SlotSet& held, Progress* progress);

/// The elements lie where the mode has them at its largest, from rest; `number` counts from 1.
void take_mode_shape(const ModesRecord& record, int number, Body& body);

/// Keys of `modes = { … }` of fem.
Fields fields(ModeStep& step);

}  // namespace supple

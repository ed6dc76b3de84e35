// `supple bench --calibrate`: what a unit of work costs on this machine, for plans of scenes.
//
// A generated head of 96x96x54 voxels goes the way of a scene: it is read, dragged, relaxed,
// inverted, drawn and written; two lips are moved by springs and by finite elements. Each cost is
// the least of three rounds. Some five seconds.
#pragma once

#include "tools/console/console.h"
#include "tools/scene/plan/unit_costs.h"

namespace supple::tools {

/// Throws Cancelled; SystemError where nothing can be written for a while.
UnitCosts calibrate(Console& console);

}  // namespace supple::tools

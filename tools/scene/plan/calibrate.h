// Measures what a unit of work costs on this machine, for plans of scenes.
//
// A generated head of 96x96x54 voxels goes the way of a scene: it is read, dragged, relaxed,
// inverted, drawn and written; two lips are moved by springs and by finite elements. Each cost is
// the least of three rounds. Some five seconds.
#pragma once

#include <string>

#include "tools/scene/plan/unit_costs.h"
#include "volumes/base/progress.h"

namespace supple::tools {

/// The table of docs/scenes/ct_head_material.toml, which benchmarks take, too.
extern const char* const kHeadMaterial;

/// `program`: what the costs are remembered as measured by. Throws Cancelled; SystemError where
/// nothing can be written for a while.
UnitCosts calibrate(const std::string& program, Progress& progress);

}  // namespace supple::tools

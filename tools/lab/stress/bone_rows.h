// The row of bones: random drags of the upper jaw of a head CT, each judged by where voxels are.
#pragma once

#include "tools/console/console.h"
#include "tools/lab/stress/stress_input.h"
#include "tools/lab/stress/stress_verdict.h"

namespace supple::tools {

/// StressInput::operations drags of the jaw of build/data/ct_head.nhdr, parted from the skull as in
/// docs/scenes/head_upper_jaw.toml, by up to 8 mm along each axis, every second one away from the
/// skull, every fourth with a turn; each is taken back. Then drags that open both rami, which seeds
/// part. Throws InputError without that file.
void run_bones(const StressInput& input, const std::string& folder, Console& console,
               MeasuredValues& all);

}  // namespace supple::tools

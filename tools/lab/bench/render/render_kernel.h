// Trilinear samples along the rays of a picture, one thread: supple's batches, OpenVDB's BoxSampler
// and NanoVDB's trilinear sampler on the same densities and offsets.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"

namespace supple::tools {

struct KernelSide {
  std::string sampler;  // supple, openvdb, nanovdb
  bool offsets = false;
  std::string instruction_set;  // supple: as sample_batch names it
};

/// The supple sides with every instruction set of this machine.
std::vector<KernelSide> kernel_sides();
std::string kernel_row_name(const KernelSide& side);

/// All sides in turns. Throws Error when the samplers disagree.
std::vector<BenchRow> measure_kernel(const std::vector<KernelSide>& sides,
                                     const RoundLimits& limits,
                                     const std::function<void()>& before_run);

}  // namespace supple::tools

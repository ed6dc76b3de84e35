// Costs of units of work, each beside the code that does the work. Plans multiply them, and a
// calibration measures those of a machine (tools/scene/plan/unit_costs.h).
#pragma once

namespace supple {

/// Nanoseconds of all threads of a run, by default those of two shared cores (AMD EPYC, AVX-512;
/// docs/benchmarks.md).
struct UnitCost {
  const char* name = nullptr;  // key of a calibration
  double ns = 0;
  const char* help = nullptr;
};

}  // namespace supple

// One side of a comparison: an engine on a body, its memory and its row.
#pragma once

#include <optional>

#include "tools/lab/bench/bodies/ecm_motion.h"
#include "tools/lab/bench/ecm/ecm_cases.h"

namespace supple::tools {

/// A side after its first pulls.
struct WarmSide {
  EcmSide side;
  std::unique_ptr<EcmEngine> engine;
  std::int64_t bytes = 0;                  // of body and engine after the pulls
  std::optional<std::int64_t> peak_bytes;  // during them
  std::int64_t moved = 0;                  // by the last
  std::uint64_t checksum = 0;
  double last_ms = 0;
};

/// Pulls an element of the body at rest; offsets of earlier sides are forgotten.
WarmSide warm_up(const EcmSide& side, MeasuredBody& measured, const std::vector<BenchDrag>& script,
                 Progress& cancel);

double timed_pull(EcmEngine& engine, const BenchDrag& pull, int threads);

/// Throws Error naming both rows when the checksums differ.
void require_equal_offsets(const EcmWorkload& workload, const EcmSide& side, std::uint64_t found,
                           std::uint64_t expected);

/// The fields that all cases share, up to the times.
BenchRow row_of(const EcmWorkload& workload, const WarmSide& warm, const Body& body,
                std::int64_t moved, double ns_per_node);

}  // namespace supple::tools

// Which rows `supple bench ecm` measures: the workloads of design.md section 9, in the order in
// which they run; those that share a body follow each other.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/base/vec.h"

namespace supple::tools {

/// One row of a comparison.
struct EcmSide {
  std::string engine;  // multiset, bucket, supple, ball; links6, links18, links26
  int threads = 1;
};

/// Task of all sides of one comparison.
struct EcmWorkload {
  std::string kind;  // the row's `case`: all, local, stream, ball or links
  std::string field;
  Vec3i size;
  std::string direction;
  std::string start;        // rest or repeat; of a stream, its script: pull, wander, anchored
  std::int64_t wanted = 0;  // elements that a local pull is to move
  std::vector<EcmSide> sides;
};

struct EcmPlanOptions {
  bool quick = false;
  int threads = 0;                // of the rows with several threads; 0: two, one on a single core
  Vec3i ct_head_size{0, 0, 0};    // zero: no head CT at hand
  std::vector<std::string> only;  // patterns; empty: every row
};

std::vector<EcmWorkload> plan_ecm(const EcmPlanOptions& options);

/// case/field/size/direction/start[/wanted]/engine/threads, which --only matches.
std::string row_name(const EcmWorkload& workload, const EcmSide& side);
/// The name without engine and threads.
std::string workload_name(const EcmWorkload& workload);

}  // namespace supple::tools

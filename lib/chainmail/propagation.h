// Tasks of both engines, and the counts that they return.
#pragma once

#include <cstdint>

#include "lib/body/slot_set.h"
#include "lib/chainmail/direction.h"
#include "lib/chainmail/undo_log.h"
#include "volumes/base/progress.h"
#include "volumes/grid/brick_values.h"

namespace supple {

/// A slot and the value that it is to take (when that lies in the direction of the run).
struct Seed {
  Slot slot;
  std::int32_t value;
};

/// One coordinate's offsets and the way in which they are to move.
struct PropagationTask {
  int coordinate;
  Direction direction;
  BrickValues& values;
  UndoLog* undo = nullptr;  // told of every brick before it changes
  Progress* progress = nullptr;
};

struct PropagationCounts {
  std::int64_t visits = 0;     // of bricks (block engine) or nodes (flat engine)
  std::int64_t max_queue = 0;  // bricks or nodes that waited at one time
};

}  // namespace supple

// Data that a session keeps while the drags of a step go from pose to pose.
#pragma once

#include <vector>

#include "lib/session/session.h"

namespace supple {

struct Session::Walk {
  Body start;                 // that the poses start from
  SlotSet taken;              // by anchors and earlier steps, then
  HandleLedger ledger;        // then
  std::vector<Drag> earlier;  // as of the pose before; empty at the first one
};

}  // namespace supple

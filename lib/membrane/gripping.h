// Forceps: nodes in the grip zone go with the instrument from where its opening falls below one
// angle until it rises above another.
#pragma once

#include "lib/membrane/sheet.h"

namespace supple {

/// Takes hold or lets go, and puts held nodes where the pose has them. `is_closed` per tool lasts
/// from step to step. Adds events.
void grip(Sheet& sheet, const MembraneParams& params, int tool, const Instrument& instrument,
          const InstrumentPose& pose, std::vector<char>& is_closed, MembraneReport& report);

}  // namespace supple

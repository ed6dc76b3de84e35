// Cost of a step of springs or finite elements, which move every node of a body.
#pragma once

#include <string>

#include "lib/session/session.h"
#include "tools/scene/plan/unit_costs.h"

namespace supple::tools {

struct ModelPlan {
  std::string what;  // "7.1 million unknowns, some 13 iterations"
  std::string why;
  double bytes = 0;  // until the step is done
  double seconds = 0;
};

/// Plans a request that has springs or finite elements, in the session as it is.
ModelPlan plan_model(const Step& request, const Session& session, const UnitCosts& costs);

/// Writes "springs on 2.3 million elements: some 160 s and 2.5 GB for each drag".
std::string price_text(const ModelPlan& plan, const Step& request, const Session& session);

}  // namespace supple::tools

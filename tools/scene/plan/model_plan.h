// Cost of a step whose model moves every node of a body (lib/session/step_model.h).
#pragma once

#include <optional>
#include <string>

#include "lib/session/session.h"
#include "lib/session/step_model.h"
#include "tools/scene/plan/unit_costs.h"

namespace supple::tools {

struct ModelPlan {
  std::string what;  // "7.1 million unknowns, some 13 iterations"
  double bytes = 0;  // until the step is done
  double seconds = 0;
};

/// Plans a step on the grid; none where Enhanced ChainMail moves the body.
std::optional<ModelPlan> plan_model(const Step& step, const Body& body, const UnitCosts& costs);

/// Writes "springs on 2.3 million elements: some 160 s and 2.5 GB for each drag".
std::string price_text(const ModelPlan& plan, const Step& step, const Body& body);

}  // namespace supple::tools

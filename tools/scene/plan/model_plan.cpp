#include "tools/scene/plan/model_plan.h"

#include <cstdio>

#include "tools/scene/plan/plan_ledger.h"

namespace supple::tools {

namespace {

std::string two_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, value < 10 ? "%.2g" : "%.0f", value);
  return text;
}

}  // namespace

std::optional<ModelPlan> plan_model(const Step& step, const Body& body, const UnitCosts& costs) {
  const StepModel& model = model_of(step);
  if (!model.cost) return std::nullopt;
  const ModelCost cost = model.cost(step, body);
  return ModelPlan{count_text(cost.size.count, cost.size.of) + (cost.is_exact ? ", " : ", some ") +
                       count_text(cost.passes.count, cost.passes.of),
                   cost.bytes, cost.units * costs[cost.unit] * 1e-9};
}

std::string price_text(const ModelPlan& plan, const Step& step, const Body& body) {
  const StepModel& model = model_of(step);
  return model.title + " on " + count_text(double(body.elements.active_count()), "elements") +
         ": some " + two_digits(plan.seconds) + " s and " + two_digits(plan.bytes * 1e-9) +
         " GB for each " + (model.waits_for_hands ? "release of a drag" : "drag");
}

}  // namespace supple::tools

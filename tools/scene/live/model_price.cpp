#include "tools/scene/live/model_price.h"

#include "tools/scene/file/scene.h"
#include "tools/scene/plan/model_plan.h"

namespace supple::tools {

std::optional<ModelPrice> price_of(const LiveEvent& model, const Session& session) {
  const Step step = on_grid(model.step, session.geometry());
  const auto plan = plan_model(step, session.body(), read_costs(calibration_file()));
  if (!plan) return std::nullopt;
  return ModelPrice{price_text(*plan, step, session.body()), plan->seconds};
}

std::optional<LiveEvent> first_model(LiveSession& live) {
  const MaterialTable& material = live.session().material();
  bool has_stiffness = material.stiffness.has_value();
  for (const auto& [label, table] : material.labels) has_stiffness |= table.stiffness.has_value();
  if (!has_stiffness) return std::nullopt;
  Table root = Table::parse(
      "[[event]]\nkind = \"model\"\nmodel = \"fem\"\nfem = { accuracy = \"picture\", "
      "beyond_limits = \"keep\" }\n",
      "the model of a body with stiffness");
  return read_event(root.tables("event").front(), live.scene().label_names);
}

}  // namespace supple::tools

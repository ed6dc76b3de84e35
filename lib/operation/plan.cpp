#include "lib/operation/score.h"

namespace supple {

OperationPlan read_plan(Table& table) {
  OperationPlan plan;
  table.know({"task", "score", "around"});
  const char* expected = "the names of all instruments";
  plan.instruments =
      table.require(table.get<std::vector<std::string>>("instruments"), "instruments", expected);
  if (const auto places = table.get<std::vector<std::string>>("places")) plan.places = *places;
  plan.tasks = read_tasks(table);
  plan.rules = read_score_rules(table);
  if (auto around = table.table("around")) {
    around->read(fields(plan.around));
    around->finish();
  }
  table.finish();
  return plan;
}

Value to_value(const OperationPlan& plan) {
  Value value;
  value["instruments"] = Value(plan.instruments);
  value["places"] = Value(plan.places);
  value["task"] = Value::List();
  for (const TaskSetup& task : plan.tasks) value["task"].push_back(to_value(task));
  value["score"] = Value::List();
  for (const ScoreRule& rule : plan.rules) value["score"].push_back(to_value(rule));
  OperationSurroundings around = plan.around;
  value["around"] = fields_value(fields(around));
  return value;
}

}  // namespace supple

#include "tools/lab/stress/stress_cells.h"

#include <algorithm>

#include "tools/console/command.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool concerns(const StressExtreme& extreme, const StressModel& model) {
  if (!extreme.models.empty()) return has(extreme.models, model.name);
  return (extreme.parts & model.parts) != 0;
}

bool is_named(const StressCell& cell, const std::string& name) {
  return name == cell.extreme->name || name == cell.model->name || name == cell.name();
}

void require_known(const std::string& name, const std::vector<StressCell>& cells) {
  std::vector<std::string> known;
  for (const StressCell& cell : cells) {
    if (is_named(cell, name)) return;
    known.insert(known.end(), {cell.extreme->name, cell.model->name, cell.name()});
  }
  const std::string nearest = nearest_name(name, known);
  throw UsageError(to_line({"", "row", "'" + name + "'",
                            nearest.empty() ? "one that supple stress --list names"
                                            : "a known one: did you mean '" + nearest + "'?"}));
}

/// One row of each extreme; the models take turns.
std::vector<StressCell> one_of_each(const std::vector<StressCell>& cells) {
  std::vector<StressCell> chosen;
  for (auto first = cells.begin(); first != cells.end();) {
    const auto last = std::find_if(
        first, cells.end(), [&](const StressCell& cell) { return cell.extreme != first->extreme; });
    const std::size_t turn = chosen.size() * 5 % std::size_t(last - first);
    chosen.push_back(*(first + std::ptrdiff_t(turn)));
    first = last;
  }
  return chosen;
}

}  // namespace

std::string StressCell::name() const {
  return std::string(extreme->name) + '/' + model->name;
}

const StressRefusal* StressCell::refusal() const {
  for (const StressRefusal& refusal : extreme->refusals) {
    if (refusal.models.empty() || has(refusal.models, model->name)) return &refusal;
  }
  return nullptr;
}

std::string StressCell::expectation() const {
  const StressRefusal* refused = refusal();
  if (refused == nullptr) return model->promise;
  return "refused with exit code " + std::to_string(refused->exit_code) + " and \"" +
         refused->text + "\"";
}

std::vector<StressCell> stress_cells() {
  std::vector<StressCell> cells;
  for (const StressExtreme& extreme : stress_extremes()) {
    for (const StressModel& model : stress_models()) {
      if (concerns(extreme, model)) cells.push_back({&extreme, &model});
    }
  }
  return cells;
}

std::vector<StressCell> cells_of(const StressChoice& choice) {
  const std::vector<StressCell> all = stress_cells();
  for (const std::string& name : choice.only) require_known(name, all);
  std::vector<StressCell> chosen;
  for (const StressCell& cell : all) {
    const auto names_it = [&](const std::string& name) { return is_named(cell, name); };
    const auto& only = choice.only;
    if (!only.empty() && std::none_of(only.begin(), only.end(), names_it)) continue;
    const bool is_meant = has(only, cell.extreme->name) || has(only, cell.name());
    if (cell.extreme->is_long && !choice.with_long && !is_meant) continue;
    chosen.push_back(cell);
  }
  return choice.quick ? one_of_each(chosen) : chosen;
}

StressCell stress_cell_named(const std::string& name) {
  const std::vector<StressCell> all = stress_cells();
  require_known(name, all);
  const auto cell = std::find_if(all.begin(), all.end(),
                                 [&](const StressCell& one) { return one.name() == name; });
  if (cell == all.end()) throw UsageError(to_line({"", "row", "'" + name + "'", "EXTREME/MODEL"}));
  return *cell;
}

StressInput input_of(const StressCell& cell) {
  StressInput input;
  cell.model->set(input);
  cell.extreme->set(input);
  return input;
}

}  // namespace supple::tools

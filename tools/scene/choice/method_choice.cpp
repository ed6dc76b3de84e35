#include "tools/scene/choice/method_choice.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "volumes/base/error.h"

namespace supple::tools {

std::vector<MethodChoice> choices_of(const std::vector<TradeRow>& rows) {
  std::map<std::string, MethodChoice> by_name;
  std::map<std::string, std::set<std::string>> scenes_of;
  std::set<std::string> scenes;
  for (const TradeRow& row : rows) {
    if (row.is_drawing() || row.held_out != 0) continue;
    const std::string name = row.name();
    scenes.insert(row.scene);
    if (!row.is_ok()) continue;
    scenes_of[name].insert(row.scene);
    MethodChoice& choice = by_name[name];
    choice.method = name;
    choice.solve_s = std::max(choice.solve_s, row.solve_s.median);
    choice.error_mm = std::max(choice.error_mm, row.p95_mm);
  }
  std::vector<MethodChoice> choices;
  for (const auto& [name, choice] : by_name) {
    if (scenes_of[name] == scenes) choices.push_back(choice);
  }
  sort_by_time(choices);
  return choices;
}

void sort_by_time(std::vector<MethodChoice>& choices) {
  std::stable_sort(choices.begin(), choices.end(),
                   [](const auto& a, const auto& b) { return a.solve_s < b.solve_s; });
}

std::optional<MethodChoice> most_exact_within(const std::vector<MethodChoice>& choices,
                                              double solve_s) {
  std::optional<MethodChoice> best;
  for (const MethodChoice& choice : choices) {
    if (choice.solve_s > solve_s) break;
    if (!best || choice.error_mm < best->error_mm) best = choice;
  }
  return best;
}

std::optional<MethodChoice> fastest_to(const std::vector<MethodChoice>& choices, double error_mm) {
  const auto found = std::find_if(choices.begin(), choices.end(), [&](const MethodChoice& choice) {
    return choice.error_mm <= error_mm;
  });
  if (found == choices.end()) return std::nullopt;
  return *found;
}

namespace {

/// A positive number with one of these units, in the first of them times its factor.
double with_unit(const std::string& text, const std::map<std::string, double>& units,
                 const std::string& field, const std::string& expected) {
  double value = 0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  const auto unit = units.find(std::string(end, last));
  if (error != std::errc() || unit == units.end() || !(value > 0) || value > 1e9) {
    throw InputError({"", field, text, expected});
  }
  return value * unit->second;
}

}  // namespace

double seconds_of(const std::string& text, const std::string& field) {
  return with_unit(text, {{"ms", 1e-3}, {"s", 1}, {"min", 60}}, field,
                   "a time such as 100ms, 2s or 1min");
}

double millimetres_of(const std::string& text, const std::string& field) {
  return with_unit(text, {{"mm", 1}}, field, "a length such as 0.5mm");
}

}  // namespace supple::tools

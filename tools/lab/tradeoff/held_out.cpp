#include "tools/lab/tradeoff/held_out.h"

#include <algorithm>

#include "tools/lab/tradeoff/trade_curves.h"

namespace supple::tools {

namespace {

void compare_with_row(HeldOutChoice& choice, const std::vector<TradeRow>& rows, double floor_mm) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const TradeRow& row) {
    return row.held_out != 0 && !row.is_drawing() && row.name() == choice.chosen->method;
  });
  if (found == rows.end()) return;
  choice.row = std::size_t(found - rows.begin());
  choice.is_ok = found->is_ok();
  if (!choice.is_ok) return;
  choice.time_ratio = found->solve_s.median / choice.chosen->solve_s;
  choice.error_ratio =
      std::max(found->p95_mm, floor_mm) / std::max(choice.chosen->error_mm, floor_mm);
  choice.is_kept = choice.time_ratio <= kKeptFactor && choice.error_ratio <= kKeptFactor;
}

}  // namespace

std::vector<HeldOutChoice> check_held_out(const std::vector<TradeRow>& rows, double floor_mm) {
  const std::vector<MethodChoice> all = choices_of(rows);
  std::vector<HeldOutChoice> choices;
  const auto add = [&](bool is_budget, double asked, std::optional<MethodChoice> chosen) {
    HeldOutChoice& choice = choices.emplace_back();
    choice.is_budget = is_budget;
    choice.asked = asked;
    choice.chosen = std::move(chosen);
    if (choice.chosen) compare_with_row(choice, rows, floor_mm);
  };
  for (const double time_s : kTimes_s) add(true, time_s, most_exact_within(all, time_s));
  for (const double error_mm : kErrors_mm) add(false, error_mm, fastest_to(all, error_mm));
  return choices;
}

std::string summary_of(const std::vector<HeldOutChoice>& choices) {
  int kept = 0, made = 0;
  for (const HeldOutChoice& choice : choices) {
    kept += choice.is_kept;
    made += choice.chosen.has_value();
  }
  return std::to_string(kept) + " of " + std::to_string(made) +
         " choices from the other loads keep their promise of time and error on the held-out "
         "load within a factor 1.5";
}

}  // namespace supple::tools

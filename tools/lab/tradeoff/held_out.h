// A load that nothing was chosen by, to see how far choices from other loads hold: for each time
// and error of the tables, what the method chosen from the others did on it.
//
// A choice is kept where it took at most kKeptFactor times the time that was to be expected, and
// was at most so many times as wrong. What was to be expected is the worst of the other loads; to
// be faster or nearer breaks nothing. Errors below the floor count as the floor.
#pragma once

#include <optional>
#include <vector>

#include "tools/scene/choice/method_choice.h"

namespace supple::tools {

constexpr double kKeptFactor = 1.5;

struct HeldOutChoice {
  bool is_budget = false;
  double asked = 0;                        // seconds; of errors, mm
  std::optional<MethodChoice> chosen;      // none where no method will do
  std::size_t row = 0;                     // of the held-out load under it
  bool is_ok = false;                      // that row
  double time_ratio = 0, error_ratio = 0;  // of what it did to what was to be expected, where ok
  bool is_kept = false;
};

/// Checks the choices for all kTimes_s as budgets and kErrors_mm as errors, in this order.
std::vector<HeldOutChoice> check_held_out(const std::vector<TradeRow>& rows, double floor_mm);

/// "5 of 8 choices keep ...", of those that there are.
std::string summary_of(const std::vector<HeldOutChoice>& choices);

}  // namespace supple::tools

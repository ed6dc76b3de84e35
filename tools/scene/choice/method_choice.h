// A method chosen from measured rows: the least error within a time, or the least time to an error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/scene/choice/trade_row.h"

namespace supple::tools {

struct MethodChoice {
  std::string method;                // "relax-26:64"
  double solve_s = 0, error_mm = 0;  // to be expected: the worst of all scenes
};

/// Finds every method that all scenes of the rows have and that failed in none, by ascending time.
/// Neither drawings nor held-out loads count.
std::vector<MethodChoice> choices_of(const std::vector<TradeRow>& rows);

/// Sorts by ascending time; of equal ones the order stays.
void sort_by_time(std::vector<MethodChoice>& choices);

/// Returns none where the fastest takes longer; of equal errors the faster.
std::optional<MethodChoice> most_exact_within(const std::vector<MethodChoice>& choices,
                                              double solve_s);
/// Returns none where no error is so small.
std::optional<MethodChoice> fastest_to(const std::vector<MethodChoice>& choices, double error_mm);

/// Read "100ms", "2s", "1.5min" in s; "0.5mm" in mm. Throw InputError with the field.
double seconds_of(const std::string& text, const std::string& field);
double millimetres_of(const std::string& text, const std::string& field);

}  // namespace supple::tools

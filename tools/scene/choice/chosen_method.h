// A method for a scene, from a table of the user's or by plans of the scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/scene/choice/method_choice.h"
#include "tools/scene/file/scene.h"
#include "volumes/base/progress.h"

namespace supple::tools {

// Methods for scenes that have no table of `supple tradeoff`, and how exact each was on the loads
// of docs/tradeoff.md. Of two methods the one that promises less error was nearer on every load.

std::vector<std::string> shipped_methods();

/// Error of one of them that is expected at the 95th percentile where the longest way of a handle
/// is `way_mm`; the worst of all loads.
double shipped_error_mm(const std::string& method, double way_mm);

/// Limits of time and error as given; empty: not given.
struct MethodWanted {
  std::string budget;  // "100ms": the most exact method that solves within it
  std::string error;   // "0.5mm": the fastest method to it
  std::string table;   // measured by supple tradeoff
};

/// Chooses by time or error; none without either. Without a table the volume is opened, times are
/// those of plans, and errors those that are shipped. Throws InputError where the table or the
/// volume cannot be read, no method takes the scene, or none will do, with the nearest; Cancelled.
std::optional<MethodChoice> choose_method(const MethodWanted& wanted, const Scene& scene,
                                          Progress& progress);

}  // namespace supple::tools

// A method for a scene, from a table of the user's or by plans of the scene.
#pragma once

#include <optional>
#include <string>

#include "tools/scene/choice/method_choice.h"
#include "tools/scene/file/scene.h"
#include "volumes/base/progress.h"

namespace supple::tools {

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

#include "tools/scene/choice/chosen_method.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <exception>
#include <fstream>
#include <map>

#include "tools/scene/file/step_method.h"
#include "tools/scene/plan/memory_need.h"
#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/base/files.h"

namespace supple::tools {

namespace {

/// Parts of the way of the handle, of docs/tradeoff.md#without-a-table. A method is left out where
/// another one beats it in time and error, and where it was farther off than a faster one on any
/// load, as 64 passes of relaxation than 16.
const std::map<std::string, double> kErrorParts = {
    {"ecm:26", 1.0},   {"relax-6:16", 0.9}, {"fem-coarse:2", 0.26},
    {"fem:0.1", 0.06}, {"fem:0.01", 0.01},
};

}  // namespace

std::vector<std::string> shipped_methods() {
  std::vector<std::string> methods;
  for (const auto& [method, part] : kErrorParts) methods.push_back(method);
  return methods;
}

double shipped_error_mm(const std::string& method, double way_mm) {
  return kErrorParts.at(method) * way_mm;
}

namespace {

std::vector<MethodChoice> choices_of_file(const std::string& path) {
  require_regular_file(path);
  if (!std::ifstream(path)) throw_open_error(path, errno);
  std::vector<MethodChoice> choices = choices_of(rows_from_csv(text_of_file(path), path));
  if (choices.empty()) throw InputError({path, "", "no method", "rows that are ok"});
  return choices;
}

/// The scene under each method that takes it. Throws what the last one says where none does.
std::map<std::string, Scene> solved_scenes(const Scene& scene) {
  std::map<std::string, Scene> solved;
  std::exception_ptr refused;
  for (const std::string& method : shipped_methods()) {
    Scene by_method = scene;
    try {
      solve_by(by_method, parse_method(method));
      solved.emplace(method, std::move(by_method));
    } catch (const InputError&) {
      refused = std::current_exception();
    }
  }
  if (solved.empty()) std::rethrow_exception(refused);
  return solved;
}

/// The longest way of a handle, in mm. Throws InputError where none goes any, or one grabs a piece
/// that its step makes, whose plan does not know how far it reaches.
double way_mm(const Scene& scene, const Geometry& geometry, const std::string& option) {
  const auto refuse = [&](const std::string& found) {
    throw InputError({scene.file, option, found, "--table beside it, or handles of tissue"});
  };
  double longest = 0;
  for (const Step& step : scene.steps) {
    for (const Drag& drag : on_grid(step, geometry).drags) {
      if (drag.selection && drag.selection->rigid_at) refuse("a handle of a rigid piece");
      longest = std::max(longest, drag.by_mm.length());
    }
  }
  if (longest == 0) refuse("no handle that is shifted");
  return longest;
}

/// Small bodies have no elements of several voxels: levels end where one can be factorised.
bool has_elements_for(const Scene& scene, const Session& session) {
  constexpr double kLeastOfLevel = 600;
  const double elements = double(session.body().elements.active_count());
  return std::all_of(scene.steps.begin(), scene.steps.end(), [&](const Step& step) {
    const int doublings = step.fem ? step.fem->params.doublings : 0;
    return doublings == 0 || elements >= kLeastOfLevel * std::pow(8, doublings);
  });
}

std::vector<MethodChoice> choices_of_plans(const Scene& scene, const std::string& option,
                                           Progress& progress) {
  if (scene.steps.empty()) {
    throw InputError({scene.file, option, "no step", "a scene whose handles go some way"});
  }
  if (!scene.bodies.empty()) {
    throw InputError({scene.file, option, "mesh bodies", "a scene of voxels alone"});
  }
  const std::map<std::string, Scene> solved = solved_scenes(scene);
  require_memory_to_open(scene, &progress);
  const Session session(scene.volume_path, session_options(scene), &progress);
  const double way = way_mm(scene, session.geometry(), option);
  check_places(scene, session.geometry());
  for (const Step& step : scene.steps) session.check(step);
  std::vector<MethodChoice> choices;
  for (const auto& [method, by_method] : solved) {
    if (!has_elements_for(by_method, session)) continue;
    choices.push_back({method, planned_solve_s(by_method, session), shipped_error_mm(method, way)});
  }
  sort_by_time(choices);
  return choices;
}

}  // namespace

std::optional<MethodChoice> choose_method(const MethodWanted& wanted, const Scene& scene,
                                          Progress& progress) {
  const bool has_budget = !wanted.budget.empty();
  if (!has_budget && wanted.error.empty()) {
    if (wanted.table.empty()) return std::nullopt;
    throw InputError(
        {wanted.table, "--table", "neither a time nor an error", "--budget or --error beside it"});
  }
  const double most =
      has_budget ? seconds_of(wanted.budget, "budget") : millimetres_of(wanted.error, "error");
  const bool is_planned = wanted.table.empty();
  const std::string option = has_budget ? "--budget" : "--error";
  const std::vector<MethodChoice> choices =
      is_planned ? choices_of_plans(scene, option, progress) : choices_of_file(wanted.table);
  const auto choice = has_budget ? most_exact_within(choices, most) : fastest_to(choices, most);
  if (choice) return choice;
  const MethodChoice nearest =
      has_budget ? choices.front() : *most_exact_within(choices, choices.back().solve_s);
  std::string expected = "at least " +
                         number_text(has_budget ? nearest.solve_s : nearest.error_mm) +
                         (has_budget ? "s" : "mm") + ", that of " + nearest.method;
  if (is_planned) {
    expected += std::string(has_budget ? " by its plan" : " as shipped") +
                "; supple tradeoff makes a table of yours, for --table";
  }
  throw InputError({is_planned ? scene.file : wanted.table, option,
                    has_budget ? wanted.budget : wanted.error, expected});
}

}  // namespace supple::tools

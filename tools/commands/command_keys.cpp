// supple keys: the keys of the tables of a scene, and the options that stand for them.
#include <algorithm>
#include <cstdio>
#include <deque>
#include <set>

#include "lib/session/fem/fem_modes.h"
#include "lib/session/fem/motion_step.h"
#include "lib/session/file/cut_keys.h"
#include "lib/session/retraction.h"
#include "lib/session/spring_step.h"
#include "lib/session/step_model.h"
#include "lib/session/tet_step.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/file/live_event.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/operation/operation_keys.h"
#include "volumes/base/json.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

namespace {

struct KeysOptions {
  std::string table;
  bool markdown = false;
};

/// The plain keys of one table. Its options have the prefix.
struct KeyTable {
  std::string name, where, prefix;
  Fields fields;
  bool is_of_operations = false;
};

/// The table of each model in a step.
void add_models(std::vector<KeyTable>& tables) {
  static std::deque<Step> steps;
  for (const StepModel& model : step_models()) {
    if (!model.fields) continue;
    model.choose(steps.emplace_back());
    tables.push_back({model.name, model.name + " = { … } of a [[step]]", model.options,
                      model.fields(steps.back())});
  }
}

std::vector<KeyTable> all_tables() {
  static ReadOptions read;
  static SceneBody body;
  static Step step;
  static StepKeys step_keys;
  static Drag handle;
  PlacedHandle& placed = handle.placed.emplace();
  static PlacedPose pose;
  static FunctionKeys function;
  static Film film;
  static LiveEvent event;
  static CameraKey camera_key;
  static Retraction retract;
  static RelaxParams relax;
  static ModeStep modes;
  static MotionStep fem_motion;
  static FemLoad force, pressure;
  pressure.kind = LoadKind::pressure;
  static TetOpening opening;
  static TetSheet sheet;
  static CutSurface plane, curve;
  curve.curve.emplace();
  static SceneView view;
  static SliceChoice slice;
  static Clip clip;
  static Light light;
  std::vector<KeyTable> tables = {
      {"volume", "[volume]", "", fields(read)},
      {"body", "[[body]]", "", tools::fields(body)},
      {"step", "[[step]]", "", fields(step, step_keys)},
      {"grab", "handles = [{ … }] and anchors = [{ … }] of a [[step]]", "", fields(placed)},
      {"motion", "handles = [{ … }] of a [[step]]", "", fields(handle)},
      {"path", "path = [{ … }] of a handle", "", fields(pose)},
      {"function", "[path] of a scene and path = { … } of a [[view]]", "", fields(function)},
      {"retract", "retract = [{ … }] of a [[step]]", "", fields(retract)},
      {"plane", "plane = { … } of a cut", "", plane_fields(plane)},
      {"curve", "curve = { … } of a cut", "", curve_fields(curve)},
      {"relax", "relax = { … } of a [[step]]", "relax-", fields(relax)},
  };
  add_models(tables);
  const std::vector<KeyTable> more = {
      {"modes", "modes = { … } of fem", "", fields(modes)},
      {"fem_motion", "motion = { … } of fem", "", fields(fem_motion)},
      {"forces", "forces = [{ … }] of fem and tets", "", load_fields(force)},
      {"pressures", "pressures = [{ … }] and swellings = [{ … }] of fem and tets", "",
       load_fields(pressure)},
      {"openings", "openings = [{ … }] of tets", "", fields(opening)},
      {"sheets", "sheets = [{ … }] of tets", "", fields(sheet)},
      {"view", "[[view]]", "", fields(view)},
      {"camera_path", "camera_path = [{ … }] of a [[view]]", "", fields(camera_key)},
      {"film", "[film]", "", fields(film)},
      {"event", "[[event]] of a journal", "", fields(event)},
      {"slice", "slice = { … } of a [[view]]", "", fields(slice)},
      {"clip", "clip = [{ … }] of a [[view]]", "clip-", tools::fields(clip)},
      {"light", "light = [{ … }] of a [[view]]", "", tools::fields(light)}};
  tables.insert(tables.end(), more.begin(), more.end());
  for (const OperationTable& table : operation_tables()) {
    tables.push_back({table.name, table.where, "", table.fields, true});
  }
  return tables;
}

std::string kind_of(const Field& field) {
  if (!field.names().empty()) return field.allowed();
  if (field.holds<bool>()) return "true or false";
  const std::string allowed = field.allowed();
  if (!allowed.empty() && allowed != field.traits().unit) return allowed;
  return field.placeholder() + (field.traits().unit.empty() ? "" : " in " + field.traits().unit);
}

/// The option of a key; empty where only scenes have the key, or commands have their own option.
std::string option_of(const KeyTable& table, const Field& field) {
  static const std::set<std::string> kSceneTables = {
      "light",       "grab",    "motion", "path",  "function", "film",      "event",
      "camera_path", "retract", "plane",  "curve", "forces",   "pressures", "body"};
  const bool has_no_options = table.is_of_operations || kSceneTables.count(table.name) != 0;
  if (field.traits().is_only_in_scenes || has_no_options) return "";
  return option_name(field, table.prefix);
}

/// A flag's help says what the option does: of a flag that is on by default, what false does.
std::string meaning_of(const Field& field) {
  const bool* const* flag = std::get_if<bool*>(&field.target());
  return (flag != nullptr && **flag ? "false: " : "") + field.traits().help;
}

std::string in_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) {
    text.insert(at, "\\");
  }
  return text;
}

std::string as_code(const std::string& text) {
  return text.empty() ? "" : "`" + in_cell(text) + "`";
}

void print_markdown(const KeyTable& table) {
  std::printf("| key | option | value | default | |\n|---|---|---|---|---|\n");
  for (const Field& field : table.fields) {
    std::printf("| `%s` | %s | %s | %s | %s |\n", field.name().c_str(),
                as_code(option_of(table, field)).c_str(), in_cell(kind_of(field)).c_str(),
                in_cell(field.default_text()).c_str(), in_cell(meaning_of(field)).c_str());
  }
}

void print_text(const KeyTable& table) {
  std::printf("%s: %s\n", table.name.c_str(), table.where.c_str());
  for (const Field& field : table.fields) {
    const std::string otherwise = field.default_text();
    std::printf("  %-18s %s%s\n%-21s%s\n", field.name().c_str(), kind_of(field).c_str(),
                otherwise.empty() ? "" : (", default " + otherwise).c_str(), "",
                meaning_of(field).c_str());
  }
}

Value json_of(const KeyTable& table) {
  Value keys = Value::List();
  for (const Field& field : table.fields) {
    keys.push_back({{"key", field.name()},
                    {"option", option_of(table, field)},
                    {"value", kind_of(field)},
                    {"unit", field.traits().unit},
                    {"default", field.default_text()},
                    {"meaning", meaning_of(field)}});
  }
  return keys;
}

int run_keys(const KeysOptions& options, const GlobalOptions& global) {
  std::vector<KeyTable> tables = all_tables();
  if (!options.table.empty()) {
    std::vector<std::string> names;
    for (const KeyTable& table : tables) names.push_back(table.name);
    if (std::find(names.begin(), names.end(), options.table) == names.end()) {
      throw UsageError(to_line({"", "table", "'" + options.table + "'", listed(names, "or")}));
    }
    const auto is_another = [&](const KeyTable& table) { return table.name != options.table; };
    tables.erase(std::remove_if(tables.begin(), tables.end(), is_another), tables.end());
  }
  Value json;
  for (const KeyTable& table : tables) {
    if (global.json) {
      json[table.name] = json_of(table);
    } else if (options.markdown) {
      print_markdown(table);
    } else {
      print_text(table);
    }
  }
  if (global.json) std::printf("%s\n", json_text(json, 2).c_str());
  return kOk;
}

}  // namespace

Command add_keys(CLI::App& program) {
  auto options = std::make_shared<KeysOptions>();
  CLI::App* app =
      add_subcommand(program, "keys", "List the keys of a scene's tables and their options",
                     "  supple keys\n"
                     "  supple keys relax\n"
                     "  supple keys view --markdown");
  app->add_option("table", options->table, "Of this table alone")->option_text("TABLE");
  app->add_flag("--markdown", options->markdown, "As the tables of the documentation");
  return {app,
          [options](const GlobalOptions& global, Console&) { return run_keys(*options, global); }};
}

}  // namespace supple::tools

#include "tools/tradeoff/trade_runs.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>

#include "tools/bench/report/machine.h"
#include "tools/console/own_process.h"
#include "tools/program_version.h"
#include "tools/scene/scene.h"
#include "tools/tradeoff/child_process.h"
#include "tools/tradeoff/error_norms.h"
#include "tools/tradeoff/text_file.h"
#include "volumes/base/sha256.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace fs = std::filesystem;

StepMethod reference_method() {
  StepMethod method = parse_method("fem");
  method.knob = kReferenceTolerance;
  return method;
}

std::vector<StepMethod> methods_named(const std::vector<std::string>& names) {
  std::vector<StepMethod> methods;
  const auto add_ladder = [&](const MethodFamily& family) {
    for (const double knob : family.ladder) methods.push_back({&family, knob});
  };
  if (names.empty()) {
    for (const MethodFamily& family : method_families()) add_ladder(family);
  }
  for (const std::string& name : names) {
    const StepMethod method = parse_method(name);
    if (name.find(':') == std::string::npos) {
      add_ladder(*method.family);
    } else {
      methods.push_back(method);
    }
  }
  return methods;
}

namespace {

constexpr const char* kStateName = "state.vdb";
/// Finite elements that are at least so exact say how sure the reference is of itself.
constexpr double kTightTolerance = 1e-8;

/// Seconds of one run by phase.
struct Phases {
  double prepare = 0, solve = 0, invert = 0, render = 0;
};

/// Stages that are no solving. Writing counts for no phase.
Phases phases_of(const nlohmann::json& stages) {
  Phases phases;
  for (const auto& [name, seconds] : stages.items()) {
    const double s = seconds.get<double>();
    if (name == "reading" || name == "building the body" || name == "labels" ||
        name == "reading state") {
      phases.prepare += s;
    } else if (name == "inverting" || name == "sampling paths") {
      phases.invert += s;
    } else if (name == "rendering") {
      phases.render += s;
    } else if (name.rfind("writing", 0) != 0 && name != "offsets" && name != "compressing") {
      phases.solve += s;
    }
  }
  return phases;
}

/// What the results of a scene depend on, but for the contents of labels and meshes.
std::string inputs_of(const Scene& scene, int threads) {
  std::string all = program_version() + '\n' + std::to_string(threads) + '\n';
  all += scene.described;
  std::error_code ignored;
  all += scene.volume_path + ' ' + std::to_string(fs::file_size(scene.volume_path, ignored)) + ' ' +
         std::to_string(fs::last_write_time(scene.volume_path, ignored).time_since_epoch().count());
  return sha256_hex(all.data(), all.size()).substr(0, 12);
}

/// As one types it.
std::string command_line(const std::vector<std::string>& arguments) {
  std::string line = "supple";
  for (const std::string& word : arguments) {
    const bool is_plain = word.find_first_of(" '\"$&;|<>()*?[]{}!#~`\\") == std::string::npos;
    line += ' ' + (is_plain ? word : '\'' + word + '\'');
  }
  return line;
}

/// One scene under one method after another.
class SceneMeasurement {
 public:
  SceneMeasurement(const TradeOptions& options, const Scene& scene, TradeScene& description,
                   Console& console)
      : m_options(options),
        m_scene(scene),
        m_description(description),
        m_console(console),
        m_inputs(inputs_of(scene, options.threads)) {}

  bool is_row_of(const TradeRow& row, const StepMethod& method) const {
    return row.inputs == m_inputs && row.method == method.family->name && row.knob == method.knob;
  }
  std::string reference_state() const { return folder_of(reference_method()) + '/' + kStateName; }

  /// All runs of a row, and its error. Leaves the state of the reference alone.
  TradeRow measure(const StepMethod& method) {
    TradeRow row = empty_row(method);
    const bool is_reference = method.name() == reference_method().name();
    const std::string folder = folder_of(method);
    fs::create_directories(folder);
    if (!run_all(row, arguments(method, folder))) return row;
    const std::string state = folder + '/' + kStateName;
    const ErrorNorms norms = reference().norms_of(state, nullptr);
    take(norms, row);
    if (!is_reference) fs::remove(state);
    return row;
  }
  /// One that is left out.
  TradeRow leave_out(const StepMethod& method, const std::string& reason) {
    TradeRow row = empty_row(method);
    row.status = "not run";
    row.reason = reason;
    return row;
  }
  double resolution_mm() { return reference().resolution_mm(); }

 private:
  std::string folder_of(const StepMethod& method) const {
    std::string name = method.name();
    std::replace(name.begin(), name.end(), ':', '_');
    return m_options.folder + "/runs/" + m_description.name + '/' + name;
  }
  std::vector<std::string> arguments(const StepMethod& method, const std::string& folder) const {
    std::vector<std::string> words = {"run",     m_scene.file, "--method", method.name(),
                                      "--state", kStateName,   "-o",       folder,
                                      "--force", "--json"};
    if (m_options.threads > 0) {
      words.push_back("--threads");
      words.push_back(std::to_string(m_options.threads));
    }
    return words;
  }
  TradeRow empty_row(const StepMethod& method) const {
    TradeRow row;
    row.scene = m_description.file;
    row.inputs = m_inputs;
    row.method = method.family->name;
    row.knob = method.knob;
    row.threads = m_options.threads;
    row.version = program_version();
    row.command = command_line(arguments(method, folder_of(method)));
    return row;
  }

  /// False where one fails.
  bool run_all(TradeRow& row, const std::vector<std::string>& words) {
    std::vector<double> prepare, solve, invert, render, wall;
    double spent_s = 0;
    while (row.runs < m_options.runs && (row.runs == 0 || spent_s < m_options.row_s)) {
      const ChildEnd end = run_child(own_program(), words, m_options.limit_s,
                                     [this] { return m_console.cancelled(); });
      spent_s += end.wall_s;
      if (end.exit_code != 0) {
        row.status = end.timed_out ? "time limit" : "failed";
        row.reason = end.complaint;
        row.wall_s = spread_of({end.wall_s});
        return false;
      }
      const nlohmann::json report = nlohmann::json::parse(end.out);
      const Phases phases = phases_of(report.at("stage_seconds"));
      prepare.push_back(phases.prepare);
      solve.push_back(phases.solve);
      invert.push_back(phases.invert);
      render.push_back(phases.render);
      wall.push_back(end.wall_s);
      row.peak_mb = std::max(row.peak_mb, report.at("peak_rss_mb").get<double>());
      row.warning = end.warning;
      ++row.runs;
    }
    row.prepare_s = spread_of(prepare);
    row.solve_s = spread_of(solve);
    row.invert_s = spread_of(invert);
    row.render_s = spread_of(render);
    row.wall_s = spread_of(wall);
    row.status = "ok";
    return true;
  }

  static void take(const ErrorNorms& norms, TradeRow& row) {
    row.moved = norms.moved;
    row.p50_mm = norms.p50_mm;
    row.p95_mm = norms.p95_mm;
    row.max_mm = norms.max_mm;
    row.volume_percent = norms.volume_percent;
    row.energy_uj = norms.energy_uj;
  }
  const ErrorReference& reference() {
    if (!m_reference) m_reference = std::make_unique<ErrorReference>(reference_state(), nullptr);
    return *m_reference;
  }

  const TradeOptions& m_options;
  const Scene& m_scene;
  TradeScene& m_description;
  Console& m_console;
  std::string m_inputs;
  std::unique_ptr<ErrorReference> m_reference;
};

std::vector<TradeRow> known_rows(const std::string& csv) {
  if (!fs::exists(csv)) return {};
  return rows_from_csv(text_of_file(csv), csv);
}

}  // namespace

namespace {

/// The rows of all scenes, in the file after each.
class TradeoffRun {
 public:
  TradeoffRun(const TradeOptions& options, Console& console)
      : m_options(options), m_console(console), m_csv(options.folder + "/runs.csv") {
    for (const std::string& file : options.scenes) add_scene(file);
  }

  TradeResults run() {
    fs::create_directories(m_options.folder);
    m_known = known_rows(m_csv);
    const MachineFacts machine = measure_machine();
    m_results.machine = machine.cpu + ", " + with_count(machine.cores, "core");
    for (std::size_t n = 0; n < m_scenes.size(); ++n) measure_scene(n);
    return std::move(m_results);
  }

 private:
  void add_scene(const std::string& file) {
    Scene scene = read_scene(file);
    solve_by(scene, reference_method());
    TradeScene description;
    description.file = file;
    description.name = fs::path(file).stem().string();
    description.volume = scene.volume_path;
    for (const TradeScene& other : m_results.scenes) {
      if (other.name != description.name) continue;
      throw InputError({file, "scene", "the name of " + other.file, "scenes of different names"});
    }
    m_results.scenes.push_back(description);
    m_scenes.push_back(std::move(scene));
  }

  void measure_scene(std::size_t n) {
    SceneMeasurement measurement(m_options, m_scenes[n], m_results.scenes[n], m_console);
    const std::size_t first = m_results.rows.size();
    measure_reference(measurement);
    for (const StepMethod& method : m_options.methods) {
      tell(method);
      if (take_known(measurement, method)) continue;
      const std::string reason = reason_to_leave_out(method, first);
      add(reason.empty() ? measurement.measure(method) : measurement.leave_out(method, reason));
    }
    ++m_done;
    describe(m_results.scenes[n], measurement, first);
  }

  /// First, since nothing can be said of others without it.
  void measure_reference(SceneMeasurement& measurement) {
    tell(reference_method());
    const bool has_state = fs::exists(measurement.reference_state());
    if (!has_state || !take_known(measurement, reference_method())) {
      add(measurement.measure(reference_method()));
    }
    const TradeRow& row = m_results.rows.back();
    if (row.is_ok()) return;
    throw Error(row.scene + ": no reference: " + row.reason);
  }

  void tell(const StepMethod& method) {
    const std::size_t all = m_scenes.size() * (m_options.methods.size() + 1);
    m_console.stage("measuring");
    m_console.update(double(m_done) / double(all));
    m_console.debug(method.name());
    ++m_done;
  }

  bool take_known(const SceneMeasurement& measurement, const StepMethod& method) {
    const auto row = std::find_if(m_known.begin(), m_known.end(), [&](const TradeRow& known) {
      return measurement.is_row_of(known, method);
    });
    if (row == m_known.end()) return false;
    m_results.rows.push_back(*row);
    return true;
  }

  /// A method is not tried with a larger knob than one that took too long.
  std::string reason_to_leave_out(const StepMethod& method, std::size_t first) const {
    for (std::size_t r = first; r < m_results.rows.size(); ++r) {
      const TradeRow& row = m_results.rows[r];
      if (row.method == method.family->name && row.status == "time limit") {
        return row.name() + " took too long";
      }
    }
    return "";
  }

  void add(TradeRow row) {
    m_results.rows.push_back(std::move(row));
    // What was known and is not yet reached stays for the next call.
    std::vector<TradeRow> all = m_results.rows;
    for (const TradeRow& known : m_known) {
      const bool is_there = std::any_of(all.begin(), all.end(), [&](const TradeRow& other) {
        return other.inputs == known.inputs && other.name() == known.name();
      });
      if (!is_there) all.push_back(known);
    }
    replace_text_file(m_csv, to_csv(all));
  }

  /// The floor: places are stored in steps, and the reference differs from a ten times looser one.
  void describe(TradeScene& scene, SceneMeasurement& measurement, std::size_t first) {
    scene.floor_mm = measurement.resolution_mm();
    for (std::size_t r = first + 1; r < m_results.rows.size(); ++r) {
      const TradeRow& row = m_results.rows[r];
      const bool is_tight = row.method == "fem" && row.knob <= kTightTolerance && row.is_ok();
      if (is_tight) scene.floor_mm = std::max(scene.floor_mm, row.p95_mm);
    }
  }

  const TradeOptions& m_options;
  Console& m_console;
  std::string m_csv;
  std::vector<Scene> m_scenes;
  std::vector<TradeRow> m_known;
  TradeResults m_results;
  std::size_t m_done = 0;
};

}  // namespace

SceneCurves curves_of(const TradeResults& results, const TradeScene& scene) {
  const auto title_of = [](const std::string& method) {
    return std::string(parse_method(method).family->title);
  };
  return curves_of(results.rows, scene.file, scene.floor_mm, title_of);
}

TradeResults run_tradeoff(const TradeOptions& options, Console& console) {
  return TradeoffRun(options, console).run();
}

}  // namespace supple::tools

#include "tools/lab/tradeoff/trade_runs.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tools/lab/bench/report/machine.h"
#include "volumes/base/files.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace fs = std::filesystem;

namespace {

/// Settings at least so exact that their difference from the reference says how sure it is of
/// itself: the tolerance of finite elements, and the step of drawings.
constexpr double kTightTolerance = 1e-8, kTightStep = 0.1;
/// Error order of voxel elements at edges of handles and on staircases (docs/models/fem.md).
constexpr double kOrder = 1;
/// 8 bits per channel: no smaller difference of pictures means anything.
constexpr double kLeastOfPictures = 1e-5;

class TradeoffRun {
 public:
  TradeoffRun(const TradeOptions& options, Console& console)
      : m_options(options), m_console(console), m_csv(options.measure.folder + "/runs.csv") {
    for (const std::string& file : options.scenes) add_scene(file);
    if (!options.held_out.empty()) {
      add_scene(options.held_out);
      m_results.scenes.back().is_held_out = true;
    }
    m_all = m_scenes.size() * (2 + options.methods.size() + options.drawings.size());
  }

  TradeResults run() {
    fs::create_directories(m_options.measure.folder);
    if (fs::exists(m_csv)) m_known = rows_from_csv(text_of_file(m_csv), m_csv);
    for (TradeRow& row : m_known) mark_held_out(row);
    const MachineFacts machine = measure_machine();
    m_results.machine = machine.cpu + ", " + with_count(machine.cores, "core");
    for (std::size_t n = 0; n < m_scenes.size(); ++n) measure_scene(n);
    write_rows();
    return std::move(m_results);
  }

 private:
  void add_scene(const std::string& file) {
    Scene scene = read_scene(file);
    Scene solved = scene;
    solve_by(solved, reference_method());
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
    TradeScene& scene = m_results.scenes[n];
    SceneMeasurement measurement(m_options.measure, m_scenes[n], scene.name, m_console);
    forget_others(scene, measurement);
    if (!measure_reference(measurement, to_row(reference_method()))) {
      throw Error(scene.file + ": no reference: " + m_results.rows.back().reason);
    }
    for (const StepMethod& method : m_options.methods) measure_row(measurement, to_row(method));
    scene.size_error_mm = size_error_of(scene.file);
    scene.floor_mm = std::max(scene.size_error_mm, floor_of("fem", kTightTolerance, scene.file,
                                                            measurement.resolution_mm()));
    const bool has_picture = !measurement.picture_of(to_row(reference_drawing())).empty();
    if (!has_picture || m_options.drawings.empty()) return;
    if (!measure_reference(measurement, to_row(reference_drawing()))) {
      return m_console.warn(scene.file +
                            ": drawings are not compared: " + m_results.rows.back().reason);
    }
    for (const DrawMethod& method : m_options.drawings) measure_row(measurement, to_row(method));
    scene.has_drawings = true;
    scene.floor_picture = floor_of("draw-newton", kTightStep, scene.file, kLeastOfPictures);
  }

  /// Forgets rows of the scene as it was, or of another program.
  void forget_others(const TradeScene& scene, const SceneMeasurement& measurement) {
    const auto is_other = [&](const TradeRow& row) {
      return row.scene == scene.file && !measurement.is_current(row);
    };
    m_known.erase(std::remove_if(m_known.begin(), m_known.end(), is_other), m_known.end());
  }

  /// Measures the reference first, since others are judged by it; false where it fails.
  bool measure_reference(SceneMeasurement& measurement, const RowSetting& setting) {
    tell(setting);
    const bool is_there = measurement.has_reference(setting.is_drawing);
    if (!is_there || !take_known(measurement, setting)) add(measurement.measure(setting));
    return m_results.rows.back().is_ok();
  }

  void measure_row(SceneMeasurement& measurement, const RowSetting& setting) {
    tell(setting);
    if (take_known(measurement, setting)) return;
    const std::string reason = reason_to_leave_out(measurement, setting);
    add(reason.empty() ? measurement.measure(setting) : measurement.leave_out(setting, reason));
  }

  void tell(const RowSetting& setting) {
    m_console.stage("measuring");
    m_console.update(double(m_done++) / double(m_all));
    m_console.debug(setting.name());
  }

  bool take_known(const SceneMeasurement& measurement, const RowSetting& setting) {
    const auto row = std::find_if(m_known.begin(), m_known.end(), [&](const TradeRow& known) {
      return measurement.is_current(known) && known.name() == setting.name();
    });
    if (row == m_known.end()) return false;
    row->picture = measurement.picture_of(setting);
    m_results.rows.push_back(std::move(*row));
    m_known.erase(row);
    return true;
  }

  /// A method is not tried with a larger knob than one that took too long.
  std::string reason_to_leave_out(const SceneMeasurement& measurement,
                                  const RowSetting& setting) const {
    for (const TradeRow& row : m_results.rows) {
      if (measurement.is_current(row) && row.method == setting.family &&
          row.status == "time limit") {
        return row.name() + " took too long";
      }
    }
    return "";
  }

  /// Marks a row as this call says, whatever an earlier one did; those of unnamed scenes stay.
  void mark_held_out(TradeRow& row) const {
    for (const TradeScene& scene : m_results.scenes) {
      if (scene.file == row.scene) row.held_out = scene.is_held_out ? 1 : 0;
    }
  }

  void add(TradeRow row) {
    mark_held_out(row);
    m_results.rows.push_back(std::move(row));
    write_rows();
  }

  /// Writes all rows; those that were known and are not yet reached stay for the next call.
  void write_rows() const {
    std::vector<TradeRow> all = m_results.rows;
    all.insert(all.end(), m_known.begin(), m_known.end());
    replace_text_file(m_csv, to_csv(all));
  }

  /// Error of the reference, from how far elements of half the size differ from it.
  double size_error_of(const std::string& scene) const {
    for (const TradeRow& row : m_results.rows) {
      if (row.scene != scene || row.method != "fem-fine" || row.knob != 1 || !row.is_ok()) continue;
      return row.error() / (1 - std::exp2(-kOrder));
    }
    return 0;
  }

  double floor_of(const std::string& method, double knob, const std::string& scene,
                  double least) const {
    double floor = least;
    for (const TradeRow& row : m_results.rows) {
      const bool is_tight = row.scene == scene && row.method == method && row.knob <= knob;
      if (is_tight && row.is_ok()) floor = std::max(floor, row.error());
    }
    return floor;
  }

  const TradeOptions& m_options;
  Console& m_console;
  std::string m_csv;
  std::vector<Scene> m_scenes;
  std::vector<TradeRow> m_known;  // and not yet taken
  TradeResults m_results;
  std::size_t m_done = 0, m_all = 1;
};

}  // namespace

SceneCurves curves_of(const TradeResults& results, const TradeScene& scene, bool are_drawings) {
  const auto title_of = [](const std::string& method) {
    for (const MethodFamily& family : method_families()) {
      if (family.name == method) return std::string(family.title);
    }
    return std::string(parse_drawing(method).family->title);
  };
  const double floor = are_drawings ? scene.floor_picture : scene.floor_mm;
  return curves_of(results.rows, scene.file, are_drawings, floor, title_of);
}

double TradeResults::floor_mm() const {
  double floor = 0;
  for (const TradeScene& scene : scenes) floor = std::max(floor, scene.floor_mm);
  return floor;
}

TradeResults run_tradeoff(const TradeOptions& options, Console& console) {
  return TradeoffRun(options, console).run();
}

}  // namespace supple::tools

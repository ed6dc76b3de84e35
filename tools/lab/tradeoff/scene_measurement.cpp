#include "tools/lab/tradeoff/scene_measurement.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include <nlohmann/json.hpp>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/material/material.h"
#include "lib/relax/relaxation.h"
#include "raycast/pictures/compare.h"
#include "tools/console/program.h"
#include "tools/scene/choice/run_phases.h"
#include "tools/scene/run/element_volumes.h"
#include "volumes/base/error.h"
#include "volumes/base/process.h"
#include "volumes/base/sha256.h"
#include "volumes/base/text.h"
#include "volumes/field/inversion/deformation_metrics.h"

namespace supple::tools {

namespace {

Vec3d offset_mm(const State& state, std::size_t slot) {
  Vec3d offset;
  for (int c = 0; c < 3; ++c) offset[c] = state.q[std::size_t(c)].at(slot) / kFixedOne;
  return state.geometry.world_vector_from_index(offset);
}

bool has_same_elements(const State& a, const State& b) {
  if (!(a.geometry == b.geometry) || a.elements.brick_count() != b.elements.brick_count()) {
    return false;
  }
  for (std::size_t n = 0; n < a.elements.brick_count(); ++n) {
    if (a.elements.origin(n) != b.elements.origin(n)) return false;
    if (a.elements.mask(n) != b.elements.mask(n)) return false;
  }
  return true;
}

/// The value that a part of all do not exceed; reorders them.
double percentile(std::vector<double>& values, double part) {
  if (values.empty()) return 0;
  const auto place = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// Energy of docs/models/relaxation.md under the reference's material, limits or not.
double energy_of_links(const State& state, const MaterialTable& material) {
  Body body = make_body(state, material);
  RelaxParams params;
  params.method = RelaxMethod::plain;
  return Relaxation(body, SlotSet(), Holds(), params).energy();
}

}  // namespace

ErrorReference::ErrorReference(const std::string& state_path, Progress* progress)
    : m_state(read_state(state_path, progress)),
      m_material(parse_material(m_state.material_toml, state_path)) {
  double longest_mm = 0;
  for_each_element(m_state.elements, [&](std::size_t slot) {
    longest_mm = std::max(longest_mm, offset_mm(m_state, slot).length());
  });
  m_least_mm = kMovedPart * longest_mm;
}

double ErrorReference::resolution_mm() const {
  const Vec3d spacing = m_state.geometry.spacing_mm();
  return std::max({spacing.x, spacing.y, spacing.z}) / kFixedOne;
}

ErrorNorms ErrorReference::norms_of(const std::string& state_path, Progress* progress,
                                    std::vector<float>* distances_mm) const {
  const State state = read_state(state_path, progress);
  if (!has_same_elements(state, m_state)) {
    throw InputError(
        {state_path, "", "other elements than those of the reference", "a state of the same body"});
  }
  ErrorNorms norms;
  std::vector<double> errors_mm;
  for_each_element(state.elements, [&](std::size_t slot) {
    const Vec3d wanted_mm = offset_mm(m_state, slot);
    const double error_mm = (offset_mm(state, slot) - wanted_mm).length();
    norms.max_mm = std::max(norms.max_mm, error_mm);
    if (distances_mm != nullptr) distances_mm->push_back(float(error_mm));
    if (wanted_mm.length() > m_least_mm) errors_mm.push_back(error_mm);
  });
  norms.moved = std::int64_t(errors_mm.size());
  norms.p50_mm = percentile(errors_mm, 0.5);
  norms.p95_mm = percentile(errors_mm, 0.95);
  const DeformationMaps maps = map_deformation(displacement_of(state), state.elements, state.cuts);
  norms.volume_percent = 100 * summarize(maps, state.geometry).volume_change();
  norms.energy_uj = energy_of_links(state, m_material);
  return norms;
}

namespace fs = std::filesystem;

namespace {

constexpr const char* kStateName = "state.vdb";

/// Digest of all that a scene's results depend on, but for the contents of labels and meshes.
std::string inputs_of(const Scene& scene, int threads) {
  std::error_code ignored;
  const auto written = fs::last_write_time(scene.volume_path, ignored).time_since_epoch();
  const std::string all = program_version() + '\n' + std::to_string(threads) + '\n' +
                          scene.described + '\n' + scene.volume_path + ' ' +
                          std::to_string(fs::file_size(scene.volume_path, ignored)) + ' ' +
                          std::to_string(written.count());
  return sha256_hex(all.data(), all.size()).substr(0, 12);
}

/// The command line as one types it.
std::string command_line(const std::vector<std::string>& arguments) {
  std::string line = "supple";
  for (const std::string& word : arguments) {
    const bool is_plain = word.find_first_of(" '\"$&;|<>()*?[]{}!#~`\\") == std::string::npos;
    line += ' ' + (is_plain ? word : '\'' + word + '\'');
  }
  return line;
}

/// Each phase of all runs.
struct AllPhases {
  std::vector<double> prepare, solve, invert, render, draw, wall;

  void add(const RunPhases& phases, double wall_s) {
    prepare.push_back(phases.prepare_s);
    solve.push_back(phases.solve_s);
    invert.push_back(phases.invert_s);
    render.push_back(phases.render_s);
    draw.push_back(phases.invert_s + phases.render_s);
    wall.push_back(wall_s);
  }
  void give_to(TradeRow& row) const {
    row.prepare_s = spread_of(prepare);
    row.solve_s = spread_of(solve);
    row.invert_s = spread_of(invert);
    row.render_s = spread_of(render);
    row.draw_s = spread_of(draw);
    row.wall_s = spread_of(wall);
  }
};

}  // namespace

std::string RowSetting::name() const {
  return family + ':' + exact_text(knob);
}

RowSetting to_row(const StepMethod& method) {
  return {
      method.family->name, method.knob, {"--method", method.name(), "--state", kStateName}, false};
}

RowSetting to_row(const DrawMethod& method) {
  const StepMethod fastest{&method_families().front(), method_families().front().ladder.front()};
  return {method.family->name,
          method.knob,
          {"--method", fastest.name(), "--drawing", method.name()},
          true};
}

StepMethod reference_method() {
  StepMethod method = parse_method("fem");
  method.knob = kReferenceTolerance;
  return method;
}

DrawMethod reference_drawing() {
  DrawMethod method = parse_drawing("draw-newton");
  method.knob = kReferenceStep;
  return method;
}

SceneMeasurement::SceneMeasurement(const MeasureOptions& options, const Scene& scene,
                                   std::string name, Console& console)
    : m_options(options),
      m_scene(scene),
      m_name(std::move(name)),
      m_console(console),
      m_inputs(inputs_of(scene, options.threads)) {}

std::string SceneMeasurement::folder_of(const RowSetting& setting) const {
  std::string name = setting.name();
  std::replace(name.begin(), name.end(), ':', '_');
  return m_options.folder + "/runs/" + m_name + '/' + name;
}

std::string SceneMeasurement::picture_of(const RowSetting& setting) const {
  for (const SceneView& view : m_scene.views) {
    if (is_drawn_by_rays(view)) return folder_of(setting) + '/' + view.image;
  }
  return "";
}

bool SceneMeasurement::has_reference(bool of_drawings) const {
  if (of_drawings) return fs::exists(picture_of(to_row(reference_drawing())));
  return fs::exists(folder_of(to_row(reference_method())) + '/' + kStateName);
}

const ErrorReference& SceneMeasurement::reference() {
  if (!m_reference) {
    const std::string folder = folder_of(to_row(reference_method()));
    m_reference = std::make_unique<ErrorReference>(folder + '/' + kStateName, nullptr);
  }
  return *m_reference;
}

std::vector<std::string> SceneMeasurement::arguments(const RowSetting& setting) const {
  std::vector<std::string> words = {"run", m_scene.file};
  words.insert(words.end(), setting.words.begin(), setting.words.end());
  for (const char* word : {"-o", "", "--force", "--json"}) {
    words.push_back(*word == '\0' ? folder_of(setting) : word);
  }
  if (m_options.threads > 0) {
    words.push_back("--threads");
    words.push_back(std::to_string(m_options.threads));
  }
  return words;
}

TradeRow SceneMeasurement::empty_row(const RowSetting& setting) const {
  TradeRow row;
  row.scene = m_scene.file;
  row.inputs = m_inputs;
  row.method = setting.family;
  row.knob = setting.knob;
  row.threads = m_options.threads;
  row.version = program_version();
  row.command = command_line(arguments(setting));
  row.picture = picture_of(setting);
  return row;
}

TradeRow SceneMeasurement::leave_out(const RowSetting& setting, const std::string& reason) const {
  TradeRow row = empty_row(setting);
  row.status = "not run";
  row.reason = reason;
  return row;
}

/// Runs all runs of a row; false where one fails.
bool SceneMeasurement::run_all(TradeRow& row, const RowSetting& setting) {
  AllPhases all;
  double spent_s = 0;
  while (row.runs < m_options.runs && (row.runs == 0 || spent_s < m_options.row_s)) {
    const ChildEnd end = run_child(m_program, arguments(setting), {m_options.limit_s},
                                   [this] { return m_console.cancelled(); });
    spent_s += end.wall_s;
    if (end.exit_code != 0) {
      row.status = end.timed_out ? "time limit" : "failed";
      row.reason = end.complaint;
      row.wall_s = spread_of({end.wall_s});
      return false;
    }
    const nlohmann::json report = nlohmann::json::parse(end.out);
    const std::map<std::string, double> stages = report.at("stage_seconds");
    all.add(phases_of({stages.begin(), stages.end()}), end.wall_s);
    row.peak_mb = std::max(row.peak_mb, report.at("peak_rss_mb").get<double>());
    row.warning = end.warnings;
    ++row.runs;
  }
  all.give_to(row);
  row.status = "ok";
  return true;
}

TradeRow SceneMeasurement::measure(const RowSetting& setting) {
  TradeRow row = empty_row(setting);
  fs::create_directories(folder_of(setting));
  if (!run_all(row, setting)) return row;
  if (setting.is_drawing) {
    compare_pictures(setting, row);
  } else {
    compare_states(setting, row);
  }
  return row;
}

/// Keeps the state of the reference, and of others a map of the distances.
void SceneMeasurement::compare_states(const RowSetting& setting, TradeRow& row) {
  const std::string state = folder_of(setting) + '/' + kStateName;
  std::vector<float> distances_mm;
  const ErrorNorms norms = reference().norms_of(state, nullptr, &distances_mm);
  row.moved = norms.moved;
  row.p50_mm = norms.p50_mm;
  row.p95_mm = norms.p95_mm;
  row.max_mm = norms.max_mm;
  row.volume_percent = norms.volume_percent;
  row.energy_uj = norms.energy_uj;
  if (setting.name() == to_row(reference_method()).name()) return;
  fs::remove(state);
  const State& wanted = reference().state();
  write_element_values(folder_of(setting) + "/error.nrrd", wanted.geometry, wanted.elements,
                       distances_mm, nullptr);
}

void SceneMeasurement::compare_pictures(const RowSetting& setting, TradeRow& row) {
  const Image wanted = read_png(picture_of(to_row(reference_drawing())));
  const Comparison found = compare(read_png(picture_of(setting)), wanted, true);
  row.rmse = found.rmse;
  row.ssim = found.ssim;
}

}  // namespace supple::tools

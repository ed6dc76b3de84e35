#include "tools/scene/sweep/sweep.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <new>

#include "tools/scene/plan/memory_need.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/run_report.h"
#include "volumes/base/error.h"
#include "volumes/base/memory.h"
#include "volumes/base/relayed_progress.h"
#include "volumes/base/toml.h"

namespace supple::tools {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestLabel = 100;

/// Progress of one of many cases, which keeps the time of its stages.
class CaseProgress final : public RelayedProgress {
 public:
  CaseProgress(std::string title, Progress& whole)
      : RelayedProgress(&whole), m_title(std::move(title)) {}
  void stage(std::string_view name) override {
    m_times.begin(name);
    RelayedProgress::stage(m_title + ", " + std::string(name));
  }

  const StageSeconds& seconds() {
    m_times.end();
    return m_times.seconds();
  }

 private:
  std::string m_title;
  StageTimes m_times;
};

/// A text as a part of a file's name: "[0, 2]" is "0_2".
std::string in_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-';
    if (is_plain) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  if (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

}  // namespace

Sweep::Sweep(std::string scene_file, SweepCases cases, std::string pictures, Progress& progress)
    : m_file(std::move(scene_file)),
      m_cases(std::move(cases)),
      m_pictures(std::move(pictures)),
      m_root(read_toml(m_file)),
      m_digests(m_file),
      m_each(m_cases.size()) {
  for (std::size_t n = 0; n < m_each.size(); ++n) {
    poll(&progress);
    read_case(n, progress);
  }
  // Pictures may be added to a sweep.
  Value root = m_root;
  root.erase("view");
  std::set<std::string> inputs;
  try {
    inputs = m_digests.inputs_of(root);
  } catch (const Error&) {  // files that the cases name in place of those of the scene
  }
  m_scene_digest = m_digests.digest_of(root, inputs);
}

void Sweep::read_case(std::size_t n, Progress& progress) {
  try {
    Value root = m_cases.scene_of(n, m_root, m_file);
    scene_of(n);
    const std::set<std::string> inputs = m_digests.inputs_of(root);
    m_inputs.insert(inputs.begin(), inputs.end());
    if (m_pictures.empty()) root.erase("view");
    m_each[n].digest = m_digests.digest_of(root, inputs);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    if (n == 0) throw;
    m_each[n].fault = error.what();
    progress.warn("case " + std::to_string(n + 1) + " (" + m_cases.title(n) +
                  ") will not be run: " + error.what());
  }
}

Scene Sweep::scene_of(std::size_t n) const {
  Scene scene = read_scene(Table(m_cases.scene_of(n, m_root, m_file), m_file));
  if (scene.film) throw InputError({m_file, "film", "a film", "a scene of one result"});
  scene.output = SceneOutput();
  for (SceneBody& body : scene.bodies) body.output.clear();
  if (m_pictures.empty()) {
    scene.views.clear();
  }
  for (SceneView& view : scene.views) {
    const fs::path image = view.image;
    view.image = (image.parent_path() / (label_of(n) + image.filename().string())).string();
  }
  check_scene(scene, m_pictures, true);
  return scene;
}

/// The beginning of the names of a case's pictures: "poisson_0.3_". Other cases do not change it.
/// Values that a name cannot have as they are, are told apart by a digest.
std::string Sweep::label_of(std::size_t n) const {
  std::string label;
  bool is_whole = true;
  for (std::size_t k = 0; k < m_cases.keys().size(); ++k) {
    const auto& value = m_cases.row(n)[k];
    if (!value) continue;
    const std::string text = in_name(value->text);
    is_whole = is_whole && text == value->text;
    label += in_name(m_cases.short_key(k)) + "_" + text + "_";
  }
  if (is_whole && label.size() <= kLongestLabel) return label;
  return label.substr(0, kLongestLabel) + "_" + digest_of_text(m_cases.title(n)).substr(0, 8) + "_";
}

bool Sweep::has_pictures(std::size_t n) const {
  if (m_pictures.empty()) return true;
  const std::vector<std::string> names = scene_of(n).outputs();
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return fs::exists(fs::path(m_pictures) / name);
  });
}

/// True for an error that names a picture of the case, such as of a full disk.
bool Sweep::is_of_picture(const std::string& error, std::size_t n) const {
  if (m_pictures.empty()) return false;
  const std::vector<std::string> files = check_scene(scene_of(n), m_pictures, true).files();
  return std::any_of(files.begin(), files.end(),
                     [&](const std::string& file) { return error.rfind(file + ":", 0) == 0; });
}

std::size_t Sweep::known_in(const SweepJournal& journal) const {
  std::size_t known = 0;
  for (std::size_t n = 0; n < m_each.size(); ++n) {
    if (m_each[n].fault.empty() && journal.find(m_each[n].digest) != nullptr && has_pictures(n)) {
      ++known;
    }
  }
  return known;
}

std::vector<std::string> Sweep::pictures(bool may_overwrite) const {
  std::vector<std::string> all;
  for (std::size_t n = 0; n < m_each.size() && !m_pictures.empty(); ++n) {
    if (!m_each[n].fault.empty()) continue;
    const std::vector<std::string> files =
        check_scene(scene_of(n), m_pictures, may_overwrite).files();
    all.insert(all.end(), files.begin(), files.end());
  }
  return all;
}

ScenePlan Sweep::plan(Progress& progress) const {
  const Scene scene = scene_of(0);
  require_memory_to_open(scene, &progress);
  const SceneRun run(scene, m_pictures, true, progress);
  run.check_steps();
  return plan_of(scene, run);
}

CaseEnd Sweep::end_of(std::size_t n, SweepJournal& journal, Progress& progress) {
  const Value* known = m_each[n].fault.empty() ? journal.find(m_each[n].digest) : nullptr;
  if (known != nullptr && has_pictures(n)) return {*known, "", false};
  CaseEnd end = run(n, progress);
  if (!end.error.empty()) return end;
  journal.add(m_each[n].digest, end.report);
  return {*journal.find(m_each[n].digest), ""};
}

CaseEnd Sweep::run(std::size_t n, Progress& progress) {
  if (!m_each[n].fault.empty()) return {{}, m_each[n].fault};
  CaseProgress of_case("case " + std::to_string(n + 1) + " of " + std::to_string(m_cases.size()),
                       progress);
  CaseEnd end;
  bool is_open = false;
  restart_peak_rss();
  try {
    const Scene scene = scene_of(n);
    require_memory_to_run(scene, &of_case);
    SceneRun run(scene, m_pictures, true, of_case);
    run.check_steps();
    require_memory(scene, run);
    is_open = true;
    run.run();
    end.report = run_report(run, scene, m_pictures, of_case.seconds());
  } catch (const Cancelled&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    if (n == 0 && !is_open) throw;
    const bool is_of_system = dynamic_cast<const SystemError*>(&error) != nullptr;
    if (is_of_system && is_of_picture(error.what(), n)) throw;
    end.error = error.what();
    end.thrown = std::current_exception();
  }
  return_free_memory();
  return end;
}

}  // namespace supple::tools

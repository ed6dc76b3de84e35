#include "tools/scene/cohort/cohort.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "tools/scene/cohort/case_workers.h"
#include "tools/scene/pictures/jpeg.h"
#include "tools/scene/pictures/thumbnail.h"
#include "tools/scene/run/scene_files.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/base/error.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"
#include "volumes/base/process.h"
#include "volumes/base/text.h"
#include "volumes/base/toml.h"

namespace supple::tools {

namespace fs = std::filesystem;

namespace {

constexpr const char* kKind = "cohort of supple";
constexpr const char* kResult = "result.json";
constexpr const char* kNotRun = "not run yet";

bool is_hidden(const fs::directory_entry& entry) {
  return entry.path().filename().string().front() == '.';
}

void remove_if_empty(const fs::path& folder) {
  std::error_code ignored;  // others work in it
  fs::remove(folder, ignored);
}

/// The folder of cases that are being run: what a killed process left goes first, and what is half
/// done at last. Shards leave the folder above to others that begin.
class WorkFolder {
 public:
  WorkFolder(std::string place, bool is_only) : m_place(std::move(place)), m_is_only(is_only) {
    fs::remove_all(m_place);
  }
  ~WorkFolder() {
    std::error_code ignored;  // hidden, and removed by the next run
    fs::remove_all(m_place, ignored);
    if (m_is_only) remove_if_empty(fs::path(m_place).parent_path());
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

 private:
  std::string m_place;
  bool m_is_only;
};

void sign_folder(const fs::path& folder) {
  fs::create_directories(folder);
  replace_text_file((folder / "cohort.json").string(), json_text({{"file", kKind}}) + "\n");
}

/// Refuses a folder that others have filled. Hidden files are locks of processes that begin.
void require_folder_of_cohort(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder)) {
    throw UsageError(to_line({folder.string(), "", "a file", "a folder"}));
  }
  const Value sign = json_or_null(text_of_file((folder / "cohort.json").string()));
  if (sign["file"] == Value(kKind)) return;
  const fs::directory_iterator all(folder);
  if (std::all_of(begin(all), end(all), is_hidden)) return;
  throw UsageError(
      to_line({folder.string(), "", "other files", "an empty folder, or that of a cohort"}));
}

/// Throws InputError for a scene that its process would refuse at once.
void check_case(const Value& root, const std::string& file, const std::string& folder) {
  const Scene scene = read_scene(Table(root, file));
  require_inside(scene, folder);
  check_scene(scene, folder, true);
}

/// A value as an option has it, whatever shells and TOML make of its characters.
std::string option_of(const SceneKey& key, const SweptValue& value) {
  return key.text() + "=" + (value.value.is_text() ? json_string(value.value.text()) : value.text);
}

/// True if a case's files are all there.
bool has_outputs(const Value& report, const fs::path& folder) {
  const Value::List& outputs = report["outputs"].items();
  return std::all_of(outputs.begin(), outputs.end(), [&](const Value& output) {
    return output.is_text() && fs::exists(folder / output.text());
  });
}

/// Writes a small picture of the first picture beside it, if there is one.
void write_thumbnail(const Value& report, const fs::path& folder) {
  for (const Value& output : report["outputs"].items()) {
    if (!ends_with(output.text(), ".png")) continue;
    const std::optional<Image> small = thumbnail_of((folder / output.text()).string());
    if (!small) continue;
    const std::vector<std::uint8_t> bytes = jpeg_of(*small);
    return replace_text_file((folder / "thumbnail.jpg").string(),
                             {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
}

}  // namespace

std::string CohortShard::suffix() const {
  return shards == 1 ? "" : "-" + std::to_string(shard) + "-of-" + std::to_string(shards);
}

CohortShard parse_shard(const std::string& text) {
  CohortShard part;
  int length = 0;
  const int found = std::sscanf(text.c_str(), "%9d/%9d%n", &part.shard, &part.shards, &length);
  const bool is_whole = found == 2 && std::size_t(length) == text.size();
  if (is_whole && part.shard >= 1 && part.shard <= part.shards) return part;
  throw UsageError(to_line({"", "--shard", "'" + text + "'", "K/N, such as 1/3, 2/3 or 3/3"}));
}

Cohort::Cohort(std::string scene_file, const std::string& cases_file, std::string folder)
    : m_file(std::move(scene_file)),
      m_folder(std::move(folder)),
      m_root(read_toml(m_file)),
      m_digests(m_file) {
  m_values.add_file(cases_file, &m_names);
  require_folder_of_cohort(m_folder);
  for (std::size_t n = 0; n < size(); ++n) {
    m_faults.emplace_back();
    try {
      check_case(m_values.scene_of(n, m_root, m_file), m_file, place_of_case(n));
    } catch (const Error& error) {
      m_faults.back() = error.what();
    }
  }
  const auto is_fault = [](const std::string& fault) { return !fault.empty(); };
  if (std::all_of(m_faults.begin(), m_faults.end(), is_fault)) {
    check_case(m_values.scene_of(0, m_root, m_file), m_file, place_of_case(0));
  }
}

std::string Cohort::place_of_case(std::size_t n) const {
  return (fs::path(m_folder) / "cases" / m_names[n]).string();
}

std::string Cohort::place_of_failure(std::size_t n) const {
  return (fs::path(m_folder) / "failed" / (m_names[n] + ".json")).string();
}

std::string Cohort::place_of_work(const CohortWork& work) const {
  const std::string shard =
      std::to_string(work.part.shard) + "-of-" + std::to_string(work.part.shards);
  return (fs::path(m_folder) / ".work" / shard).string();
}

Value Cohort::line_of(std::size_t n, const std::string& digest) const {
  Value line = {{"name", m_names[n]}, {"values", Value::Entries()}};
  for (std::size_t k = 0; k < m_values.keys().size(); ++k) {
    const auto& value = m_values.row(n)[k];
    if (value) line["values"][m_values.keys()[k].text()] = value->value;
  }
  line["digest"] = digest;
  return line;
}

/// Digest of all that a case depends on; of one that is no scene, of its values.
std::string Cohort::digest_of(std::size_t n) {
  if (!m_faults[n].empty()) return digest_of_text(m_values.title(n));
  const Value root = m_values.scene_of(n, m_root, m_file);
  const std::string digest = m_digests.digest_of(root, m_digests.inputs_of(root));
  return digest_of_text(program_of_results() + " " + digest);
}

/// The end of a case as it was left before.
CohortEnd Cohort::known_end(std::size_t n, const std::string& digest) const {
  CohortEnd end = {n, line_of(n, digest), m_faults[n], false};
  if (end.error.empty()) {
    const fs::path folder = place_of_case(n);
    Value line = json_or_null(text_of_file((folder / kResult).string()));
    if (line["digest"] == Value(digest) && has_outputs(line["report"], folder)) {
      end.line = std::move(line);
      return end;
    }
    const Value failed = json_or_null(text_of_file(place_of_failure(n)));
    end.error = failed["digest"] == Value(digest) ? failed["error"].text() : kNotRun;
  }
  end.line["error"] = end.error;
  return end;
}

std::vector<std::string> Cohort::arguments_of(std::size_t n, const CohortWork& work) const {
  std::vector<std::string> words = {"run", fs::absolute(m_file).string()};
  for (std::size_t k = 0; k < m_values.keys().size(); ++k) {
    const auto& value = m_values.row(n)[k];
    if (!value) continue;
    words.insert(words.end(), {"--set", option_of(m_values.keys()[k], *value)});
  }
  words.insert(words.end(), {"--json", "--log-level", "warning"});
  if (work.threads > 0) words.insert(words.end(), {"--threads", std::to_string(work.threads)});
  return words;
}

/// Runs a case in a folder of its own, which gets the name of the case when all is in it.
CohortEnd Cohort::run_case(std::size_t n, const std::string& digest, const CohortWork& work,
                           const std::function<bool()>& stops) const {
  const std::string place = (fs::path(place_of_work(work)) / m_names[n]).string();
  fs::create_directories(place);
  const ChildEnd child = run_child(own_program(), arguments_of(n, work), {}, stops, place);
  CohortEnd end = {n, line_of(n, digest), "", true};
  const Value report = json_or_null(child.out);
  if (child.exit_code == 0 && report.is_table()) {
    end.line["program"] = program_of_results();
    end.line["report"] = report;
    if (!child.warnings.empty()) end.line["warnings"] = child.warnings;
    write_thumbnail(report, place);
    replace_text_file((fs::path(place) / kResult).string(), json_text(end.line) + "\n");
    fs::create_directories(fs::path(m_folder) / "cases");
    fs::remove_all(place + ".old");
    if (fs::exists(place_of_case(n))) fs::rename(place_of_case(n), place + ".old");
    fs::rename(place, place_of_case(n));
    fs::remove_all(place + ".old");
    fs::remove(place_of_failure(n));
    return end;
  }
  end.error = child.complaint.empty() ? "no result, exit code " + std::to_string(child.exit_code)
                                      : child.complaint;
  end.line["error"] = end.error;
  fs::remove_all(place);
  fs::remove_all(place_of_case(n));  // of other values
  fs::create_directories(fs::path(m_folder) / "failed");
  replace_text_file(place_of_failure(n), json_text(end.line) + "\n");
  return end;
}

std::vector<CohortEnd> Cohort::run(const CohortWork& work, Progress& progress,
                                   const std::function<void(const CohortEnd&)>& told) {
  std::vector<std::size_t> mine;
  for (auto n = std::size_t(work.part.shard - 1); n < size(); n += std::size_t(work.part.shards)) {
    mine.push_back(n);
  }
  sign_folder(m_folder);
  const WorkFolder folder(place_of_work(work), work.part.shards == 1);
  std::vector<CohortEnd> ends;
  const auto take = [&](CohortEnd end) {
    told(end);
    ends.push_back(std::move(end));
    progress.update(double(ends.size()) / double(mine.size()));
  };
  progress.stage("cases");
  CaseWorkers<CohortEnd> workers(work.jobs, progress);
  try {
    for (const std::size_t n : mine) {
      poll(&progress);
      const std::string digest = digest_of(n);
      CohortEnd known = known_end(n, digest);
      const bool is_over = !m_faults[n].empty() || (known.error.empty() && !work.anew);
      if (is_over) {
        take(std::move(known));
        continue;
      }
      while (workers.is_full()) take(workers.next());
      workers.start([this, n, digest, &work, &workers] {
        return run_case(n, digest, work, [&workers] { return workers.stops(); });
      });
    }
    while (!workers.is_idle()) take(workers.next());
  } catch (const Cancelled&) {
    progress.note(with_count(std::int64_t(ends.size()), "case") +
                  " came to an end; the same command goes on with the others");
    throw;
  }
  std::sort(ends.begin(), ends.end(),
            [](const CohortEnd& a, const CohortEnd& b) { return a.n < b.n; });
  return ends;
}

std::vector<CohortEnd> Cohort::gather(Progress& progress) {
  sign_folder(m_folder);
  remove_if_empty(fs::path(m_folder) / ".work");
  std::vector<CohortEnd> ends;
  progress.stage("cases");
  for (std::size_t n = 0; n < size(); ++n) {
    report(&progress, double(n) / double(size()));
    ends.push_back(known_end(n, digest_of(n)));
  }
  return ends;
}

}  // namespace supple::tools

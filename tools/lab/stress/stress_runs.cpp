#include "tools/lab/stress/stress_runs.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "volumes/base/files.h"
#include "volumes/base/process.h"

namespace supple::tools {

namespace fs = std::filesystem;

namespace {

/// The folder that rows are kept in, or one that goes with the object.
class RowFolders {
 public:
  explicit RowFolders(const std::string& kept) : m_root(kept) {
    if (kept.empty()) m_root = m_scratch.emplace().path();
  }

  /// Makes an empty folder for a row.
  std::string make(const StressCell& cell) const {
    const fs::path folder = m_root / cell.extreme->name / cell.model->name;
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder.string();
  }
  void leave(const std::string& folder) const {
    std::error_code ignored;
    if (m_scratch) fs::remove_all(folder, ignored);
  }

 private:
  std::optional<ScratchFolder> m_scratch;
  fs::path m_root;
};

}  // namespace

std::vector<StressRow> run_stress(const StressOptions& options, Console& console,
                                  const std::function<void(const StressRow&)>& done) {
  const std::vector<StressCell> cells = cells_of(options.choice);
  const RowFolders folders(options.folder);
  std::vector<StressRow> rows;
  console.stage("rows");
  for (const StressCell& cell : cells) {
    const std::string folder = folders.make(cell);
    const std::vector<std::string> arguments = {
        "stress", "--row",   cell.name(), "--keep",
        folder,   "--quiet", "--threads", std::to_string(options.threads)};
    const ProgramLimits limits{cell.extreme->limit_s * options.patience,
                               cell.extreme->limit_mb * options.patience};
    const ChildEnd end =
        run_child(own_program(), arguments, limits, [&] { return console.cancelled(); });
    rows.push_back({verdict_of(cell.refusal(), end), cell, end.wall_s, end.peak_mb});
    folders.leave(folder);
    done(rows.back());
    console.update(double(rows.size()) / double(cells.size()));
  }
  return rows;
}

MeasuredValues run_row(const StressCell& cell, const std::string& folder, Console& console) {
  MeasuredValues measured;
  cell.model->run(input_of(cell), folder, console, measured);
  return measured;
}

}  // namespace supple::tools

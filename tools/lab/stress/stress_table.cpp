#include "tools/lab/stress/stress_table.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "tools/console/command.h"
#include "tools/console/program.h"
#include "volumes/base/error.h"
#include "volumes/base/files.h"
#include "volumes/base/process.h"
#include "volumes/base/text.h"

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

namespace {

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool concerns(const StressExtreme& extreme, const StressModel& model) {
  if (!extreme.models.empty()) return has(extreme.models, model.name);
  return (extreme.parts & model.parts) != 0;
}

bool is_named(const StressCell& cell, const std::string& name) {
  return name == cell.extreme->name || name == cell.model->name || name == cell.name();
}

void require_known(const std::string& name, const std::vector<StressCell>& cells) {
  std::vector<std::string> known;
  for (const StressCell& cell : cells) {
    if (is_named(cell, name)) return;
    known.insert(known.end(), {cell.extreme->name, cell.model->name, cell.name()});
  }
  const std::string nearest = nearest_name(name, known);
  throw UsageError(to_line({"", "row", "'" + name + "'",
                            nearest.empty() ? "one that supple stress --list names"
                                            : "a known one: did you mean '" + nearest + "'?"}));
}

/// One row of each extreme; the models take turns.
std::vector<StressCell> one_of_each(const std::vector<StressCell>& cells) {
  std::vector<StressCell> chosen;
  for (auto first = cells.begin(); first != cells.end();) {
    const auto last = std::find_if(
        first, cells.end(), [&](const StressCell& cell) { return cell.extreme != first->extreme; });
    const std::size_t turn = chosen.size() * 5 % std::size_t(last - first);
    chosen.push_back(*(first + std::ptrdiff_t(turn)));
    first = last;
  }
  return chosen;
}

}  // namespace

std::string StressCell::name() const {
  return std::string(extreme->name) + '/' + model->name;
}

const StressRefusal* StressCell::refusal() const {
  for (const StressRefusal& refusal : extreme->refusals) {
    if (refusal.models.empty() || has(refusal.models, model->name)) return &refusal;
  }
  return nullptr;
}

std::string StressCell::expectation() const {
  const StressRefusal* refused = refusal();
  if (refused == nullptr) return model->promise;
  return "refused with exit code " + std::to_string(refused->exit_code) + " and \"" +
         refused->text + "\"";
}

std::vector<StressCell> stress_cells() {
  std::vector<StressCell> cells;
  for (const StressExtreme& extreme : stress_extremes()) {
    for (const StressModel& model : stress_models()) {
      if (concerns(extreme, model)) cells.push_back({&extreme, &model});
    }
  }
  return cells;
}

std::vector<StressCell> cells_of(const StressChoice& choice) {
  const std::vector<StressCell> all = stress_cells();
  for (const std::string& name : choice.only) require_known(name, all);
  std::vector<StressCell> chosen;
  for (const StressCell& cell : all) {
    const auto names_it = [&](const std::string& name) { return is_named(cell, name); };
    const auto& only = choice.only;
    if (!only.empty() && std::none_of(only.begin(), only.end(), names_it)) continue;
    const bool is_meant = has(only, cell.extreme->name) || has(only, cell.name());
    if (cell.extreme->is_long && !choice.with_long && !is_meant) continue;
    chosen.push_back(cell);
  }
  return choice.quick ? one_of_each(chosen) : chosen;
}

StressCell stress_cell_named(const std::string& name) {
  const std::vector<StressCell> all = stress_cells();
  require_known(name, all);
  const auto cell = std::find_if(all.begin(), all.end(),
                                 [&](const StressCell& one) { return one.name() == name; });
  if (cell == all.end()) throw UsageError(to_line({"", "row", "'" + name + "'", "EXTREME/MODEL"}));
  return *cell;
}

StressInput input_of(const StressCell& cell) {
  StressInput input;
  cell.model->set(input);
  cell.extreme->set(input);
  return input;
}

namespace {

/// Names of rows are padded to this width.
constexpr int kNameWidth = 34;

std::string in_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) {
    text.insert(at, "\\");
  }
  return text;
}

std::string in_quotes(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

const char* verdict_of(const StressRow& row) {
  return row.agrees ? "agrees" : "DISAGREES";
}

std::string with_backticks(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "`" : ", `") + name + '`';
  return text;
}

/// Names of the models of an extreme, by their refusal; null: they keep their promise.
std::map<const StressRefusal*, std::vector<std::string>> models_by_refusal(
    const StressExtreme& extreme) {
  std::map<const StressRefusal*, std::vector<std::string>> models;
  for (const StressCell& cell : stress_cells()) {
    if (cell.extreme == &extreme) models[cell.refusal()].emplace_back(cell.model->name);
  }
  return models;
}

}  // namespace

std::string models_markdown() {
  std::string text = "| model | | promise |\n|---|---|---|\n";
  for (const StressModel& model : stress_models()) {
    text += "| `" + std::string(model.name) + "` | " + in_cell(model.title) + " | " +
            in_cell(model.promise) + " |\n";
  }
  return text;
}

std::string extremes_markdown() {
  std::string text =
      "| extreme | | finite and bounded, as promised | refused: exit code, text "
      "|\n|---|---|---|---|\n";
  for (const StressExtreme& extreme : stress_extremes()) {
    auto models = models_by_refusal(extreme);
    const std::string kept = with_backticks(models[nullptr]);
    std::string refused;
    for (const auto& [refusal, names] : models) {
      if (refusal == nullptr) continue;
      refused += (refused.empty() ? "" : "; ") + with_backticks(names) + ": " +
                 std::to_string(refusal->exit_code) + ", `" + in_cell(refusal->text) + '`';
    }
    text += "| `" + std::string(extreme.name) + "` | " + in_cell(extreme.title) +
            (extreme.is_long ? " (`--long`)" : "") + " | " + kept + " | " + refused + " |\n";
  }
  return text;
}

std::string cells_text(const std::vector<StressCell>& cells) {
  std::string text;
  for (const StressCell& cell : cells) {
    text += padded(cell.name(), kNameWidth) + ' ' + cell.extreme->title + ": " +
            cell.expectation() + '\n';
  }
  return text;
}

std::string row_text(const StressRow& row) {
  char cost[64];
  std::snprintf(cost, sizeof cost, " %6.2f s %5.0f MB  ", row.wall_s, row.peak_mb);
  std::string text = padded(verdict_of(row), 9) + ' ' + padded(row.cell.name(), kNameWidth) + cost +
                     row.found + '\n';
  if (!row.agrees) text += "          expected: " + row.cell.expectation() + '\n';
  return text;
}

std::string to_markdown(const std::vector<StressRow>& rows) {
  std::string text = "supple " + program_version() +
                     "\n\n| extreme | model | expected | found | verdict | s | MB |\n"
                     "|---|---|---|---|---|---|---|\n";
  for (const StressRow& row : rows) {
    char cost[64];
    std::snprintf(cost, sizeof cost, "%.2f | %.0f", row.wall_s, row.peak_mb);
    text += "| `" + std::string(row.cell.extreme->name) + "` | `" + row.cell.model->name + "` | " +
            in_cell(row.cell.expectation()) + " | " + in_cell(row.found) + " | " + verdict_of(row) +
            " | " + cost + " |\n";
  }
  return text;
}

std::string to_csv(const std::vector<StressRow>& rows) {
  std::string text = "version,extreme,model,expected,found,agrees,wall_s,peak_mb\n";
  for (const StressRow& row : rows) {
    text += program_version() + ',' + row.cell.extreme->name + ',' + row.cell.model->name + ',' +
            in_quotes(row.cell.expectation()) + ',' + in_quotes(row.found) + ',' +
            (row.agrees ? "1" : "0") + ',' + number_text(row.wall_s) + ',' +
            number_text(row.peak_mb) + '\n';
  }
  return text;
}

nlohmann::ordered_json to_json(const std::vector<StressRow>& rows) {
  nlohmann::ordered_json json = {{"version", program_version()}};
  json["rows"] = nlohmann::ordered_json::array();
  for (const StressRow& row : rows) {
    json["rows"].push_back({{"extreme", row.cell.extreme->name},
                            {"model", row.cell.model->name},
                            {"expected", row.cell.expectation()},
                            {"found", row.found},
                            {"agrees", row.agrees},
                            {"measured", to_json(row.measured)},
                            {"wall_s", row.wall_s},
                            {"peak_mb", row.peak_mb}});
  }
  return json;
}

}  // namespace supple::tools

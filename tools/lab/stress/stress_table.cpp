#include "tools/lab/stress/stress_table.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include <nlohmann/json.hpp>

#include "tools/console/program.h"
#include "volumes/base/error.h"

namespace supple::tools {

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

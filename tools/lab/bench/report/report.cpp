#include "tools/lab/bench/report/report.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include <fnmatch.h>

#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"
#include "volumes/base/version.h"

namespace supple::tools {

namespace {

using TableCells = std::vector<std::string>;

/// A table's cells, header first.
struct ReportTable {
  std::string title;
  std::vector<TableCells> lines;
};

std::string number_cell(double value) {
  char text[32];
  const double size = std::abs(value);
  const char* format = size == 0 || size >= 100 ? "%.0f" : size >= 10 ? "%.1f" : "%.4g";
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string cell(const BenchRow& row, const std::string& column) {
  const auto found = row.find(column);
  if (found == row.end()) return "";
  if (found->is_string()) return found->get<std::string>();
  if (found->is_number_float()) return number_cell(found->get<double>());
  if (!found->is_array()) return found->dump();
  std::string text;
  for (const auto& part : *found) text += (text.empty() ? "" : "x") + part.dump();
  return text;
}

std::vector<ReportTable> tables_of(const BenchReport& report) {
  std::vector<std::string> cases;
  for (const BenchRow& row : report.rows) {
    const std::string name = row.at("case");
    if (std::find(cases.begin(), cases.end(), name) == cases.end()) cases.push_back(name);
  }
  std::vector<ReportTable> tables;
  for (const std::string& name : cases) {
    ReportTable table{report.benchmark + ": " + name, {{}}};
    TableCells& columns = table.lines.front();
    const auto is_of_case = [&](const BenchRow& row) { return row.at("case") == name; };
    for (const BenchRow& row : report.rows) {
      if (!is_of_case(row)) continue;
      for (const auto& [key, value] : row.items()) {
        if (key != "case" && std::find(columns.begin(), columns.end(), key) == columns.end()) {
          columns.push_back(key);
        }
      }
    }
    for (const BenchRow& row : report.rows) {
      if (!is_of_case(row)) continue;
      TableCells cells;
      for (const std::string& column : table.lines.front()) cells.push_back(cell(row, column));
      table.lines.push_back(std::move(cells));
    }
    tables.push_back(std::move(table));
  }
  return tables;
}

std::string machine_line(const MachineFacts& machine) {
  char text[200];
  std::snprintf(text, sizeof text, "%s, %d cores, %s, triad %.1f GB/s (one thread %.1f GB/s)",
                machine.cpu.c_str(), machine.cores, machine.isa.c_str(), machine.triad_gb_s,
                machine.triad_one_thread_gb_s);
  return text;
}

}  // namespace

nlohmann::ordered_json to_json(const BenchReport& report) {
  const MachineFacts& machine = report.machine;
  return {{"benchmark", report.benchmark},
          {"version", kVersion},
          {"machine",
           {{"cpu", machine.cpu},
            {"cores", machine.cores},
            {"isa", machine.isa},
            {"triad_gb_s", machine.triad_gb_s},
            {"triad_one_thread_gb_s", machine.triad_one_thread_gb_s}}},
          {"rows", report.rows}};
}

std::string to_text(const BenchReport& report) {
  std::string text = machine_line(report.machine) + "\n";
  for (const ReportTable& table : tables_of(report)) {
    std::vector<std::size_t> widths(table.lines.front().size(), 0);
    for (const TableCells& cells : table.lines) {
      for (std::size_t n = 0; n < cells.size(); ++n) {
        widths[n] = std::max(widths[n], cells[n].size());
      }
    }
    text += "\n" + table.title + "\n";
    for (const TableCells& cells : table.lines) {
      for (std::size_t n = 0; n < cells.size(); ++n) {
        text += "  " + std::string(widths[n] - cells[n].size(), ' ') + cells[n];
      }
      text += "\n";
    }
  }
  return text;
}

std::string to_markdown(const BenchReport& report) {
  std::string text = "# supple bench " + report.benchmark + "\n\nsupple " + kVersion + ", " +
                     machine_line(report.machine) + "\n";
  for (const ReportTable& table : tables_of(report)) {
    text += "\n## " + table.title + "\n\n";
    for (std::size_t line = 0; line < table.lines.size(); ++line) {
      for (const std::string& content : table.lines[line]) text += "| " + content + " ";
      text += "|\n";
      if (line > 0) continue;
      for (std::size_t n = 0; n < table.lines.front().size(); ++n) text += "|---";
      text += "|\n";
    }
  }
  return text;
}

void write_json(const std::string& path, const BenchReport& report) {
  AtomicFile file(path);
  std::ofstream stream(file.path(), std::ios::binary | std::ios::trunc);
  stream << to_json(report).dump(2) << "\n" << std::flush;
  if (!stream) throw SystemError(path + ": cannot write");
  stream.close();
  file.commit();
}

bool is_wanted_row(const std::vector<std::string>& only, const std::string& name) {
  return only.empty() || std::any_of(only.begin(), only.end(), [&](const std::string& pattern) {
           return ::fnmatch(("*" + pattern + "*").c_str(), name.c_str(), 0) == 0;
         });
}

}  // namespace supple::tools

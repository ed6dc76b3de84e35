#include "tools/scene/sweep/sweep_table.h"

#include <algorithm>
#include <set>

#include "tools/scene/sweep/report_names.h"
#include "volumes/base/csv.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

constexpr std::size_t kWidestCell = 60;

std::string cell_of(const Value& value) {
  if (value.is_null()) return "";
  if (value.is_truth()) return value.truth() ? "true" : "false";
  if (value.is_whole()) return std::to_string(value.whole());
  return value.is_number() ? exact_text(value.number()) : value.text();
}

std::string short_cell(const Value& value) {
  return value.is_number() && !value.is_whole() ? number_text(value.number()) : cell_of(value);
}

bool begins_character(char c) {
  return (c & 0xC0) != 0x80;  // of UTF-8
}

std::size_t width_of(const std::string& text) {
  return std::size_t(std::count_if(text.begin(), text.end(), begins_character));
}

std::string shortened(std::string text) {
  if (width_of(text) <= kWidestCell) return text;
  std::size_t end = 0;
  for (std::size_t width = 0; end < text.size(); ++end) {
    if (begins_character(text[end]) && ++width > kWidestCell - 3) break;
  }
  return text.substr(0, end) + "...";
}

/// Errors have ends of lines where a library gave them.
std::string in_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// An error that names what the reports have in place of what was asked for.
[[noreturn]] void fail_unknown(const Collected& wanted, const NamedValues& all) {
  std::vector<std::string> names;
  for (const auto& [name, value] : all) names.push_back(name);
  const std::string nearest = nearest_name(wanted.name, names);
  throw InputError({"", "--collect", "'" + wanted.name + "'",
                    nearest.empty() ? "a result that supple sweep SCENE --list names"
                                    : "one of the report: did you mean '" + nearest + "'?"});
}

}  // namespace

Collected parse_collected(const std::string& text) {
  const std::size_t sign = text.find('=');
  Collected wanted = {text.substr(0, sign),
                      sign == std::string::npos ? text : text.substr(sign + 1)};
  if (!wanted.column.empty() && !wanted.name.empty()) return wanted;
  throw UsageError(to_line({"", "--collect", "'" + text + "'", "NAME=PATH or PATH"}));
}

std::vector<Collected> main_results(const std::vector<CaseEnd>& ends) {
  std::vector<std::string> names;
  for (const CaseEnd& end : ends) {
    for (const auto& [name, value] : named_values(end.report)) {
      const bool is_known = std::find(names.begin(), names.end(), name) != names.end();
      if (!is_known && value.is_number() && is_main_result(name)) names.push_back(name);
    }
  }
  std::vector<Collected> results;
  for (const std::string& name : names) results.push_back({short_name(name, names), name});
  return results;
}

SweepTable make_table(const SweepCases& cases, const std::vector<CaseEnd>& ends,
                      std::vector<Collected> wanted) {
  if (wanted.empty()) wanted = main_results(ends);
  SweepTable table;
  for (const SceneKey& key : cases.keys()) table.keys.push_back(key.text());
  for (const Collected& result : wanted) table.results.push_back(result.column);
  std::set<std::string> names(table.keys.begin(), table.keys.end());
  for (const std::string& name : table.results) {
    if (name != "error" && names.insert(name).second) continue;
    throw InputError({"", "--collect", "two columns '" + name + "'", "NAME=PATH with other names"});
  }
  std::vector<bool> is_known(wanted.size());
  NamedValues any;
  for (std::size_t n = 0; n < ends.size(); ++n) {
    SweepTable::Row row;
    for (const auto& value : cases.row(n)) row.values.push_back(value ? value->text : "");
    NamedValues all = named_values(ends[n].report);
    for (std::size_t c = 0; c < wanted.size(); ++c) {
      const auto* found = find_named(all, wanted[c].name);
      row.results.push_back(found == nullptr ? Value() : found->second);
      if (found != nullptr) is_known[c] = true;
    }
    row.error = in_one_line(ends[n].error);
    table.rows.push_back(std::move(row));
    if (!all.empty()) any = std::move(all);
  }
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    if (!is_known[c] && !any.empty()) fail_unknown(wanted[c], any);
  }
  return table;
}

std::vector<std::string> column_names(const SweepTable& table) {
  std::vector<std::string> names = table.keys;
  names.insert(names.end(), table.results.begin(), table.results.end());
  return names;
}

std::size_t column_of(const SweepTable& table, const std::string& name, const std::string& option) {
  const std::vector<std::string> names = column_names(table);
  std::vector<std::size_t> ends;
  std::string all;
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (names[c] == name) return c;
    if (ends_with(names[c], "." + name)) ends.push_back(c);
    all += (all.empty() ? "" : ", ") + names[c];
  }
  if (ends.size() == 1) return ends.front();
  throw InputError({"", option, "'" + name + "'", "a column of the table: " + all});
}

std::string to_csv(const SweepTable& table) {
  std::vector<std::string> head = column_names(table);
  head.emplace_back("error");
  std::string text = csv_line(head);
  for (const SweepTable::Row& row : table.rows) {
    std::vector<std::string> cells = row.values;
    for (const Value& result : row.results) cells.push_back(cell_of(result));
    cells.push_back(row.error);
    text += csv_line(cells);
  }
  return text;
}

std::string to_text(const SweepTable& table,
                    const std::function<std::string(std::string)>& cleaned) {
  std::vector<std::vector<std::string>> lines(1, column_names(table));
  for (const SweepTable::Row& row : table.rows) {
    lines.push_back(row.values);
    for (const Value& result : row.results) lines.back().push_back(short_cell(result));
  }
  std::vector<std::size_t> widths(lines[0].size());
  for (auto& line : lines) {
    for (std::size_t c = 0; c < line.size(); ++c) {
      line[c] = shortened(cleaned(line[c]));
      widths[c] = std::max(widths[c], width_of(line[c]));
    }
  }
  std::string text;
  for (std::size_t n = 0; n < lines.size(); ++n) {
    std::string line;
    for (std::size_t c = 0; c < widths.size(); ++c) {
      line += std::string(widths[c] - width_of(lines[n][c]), ' ') + lines[n][c] + "  ";
    }
    if (n > 0 && !table.rows[n - 1].error.empty()) line += "failed";
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

Value to_value(const SweepTable& table) {
  Value cases = Value::List();
  for (const SweepTable::Row& row : table.rows) {
    Value one = {{"values", Value::Entries()}, {"results", Value::Entries()}};
    for (std::size_t k = 0; k < table.keys.size(); ++k)
      one["values"][table.keys[k]] = row.values[k];
    for (std::size_t c = 0; c < table.results.size(); ++c) {
      one["results"][table.results[c]] = row.results[c];
    }
    if (!row.error.empty()) one["error"] = row.error;
    cases.push_back(std::move(one));
  }
  return cases;
}

}  // namespace supple::tools

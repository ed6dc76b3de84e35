#include "tools/scene/cohort/cohort_page.h"

#include <cctype>
#include <cstdio>
#include <filesystem>

#include "tools/scene/chart/template.h"
#include "tools/scene/cohort/cohort_template.h"
#include "volumes/base/json.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

/// A path as an address has it.
std::string address_of(const std::string& path) {
  std::string address;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    char code[4];
    std::snprintf(code, sizeof code, "%%%02X", byte);
    const bool is_plain =
        std::isalnum(byte) != 0 || std::string("-_./").find(c) != std::string::npos;
    address += is_plain ? std::string(1, c) : code;
  }
  return address;
}

/// The first picture of a case, in its folder.
std::string picture_of(const Value& report) {
  for (const Value& output : report["outputs"].items()) {
    if (output.is_text() && ends_with(output.text(), ".png")) return output.text();
  }
  return "";
}

std::string cell_text(const Value& value) {
  if (value.is_null()) return "";
  if (value.is_number() && !value.is_whole()) return number_text(value.number());
  return value.is_text() ? value.text() : json_text(value);
}

}  // namespace

std::string lines_of(const std::vector<CohortEnd>& ends, bool failed) {
  std::string lines;
  for (const CohortEnd& end : ends) {
    if (end.error.empty() != failed) lines += json_text(end.line) + "\n";
  }
  return lines;
}

std::size_t failures_of(const std::vector<CohortEnd>& ends) {
  std::size_t failed = 0;
  for (const CohortEnd& end : ends) failed += end.error.empty() ? 0 : 1;
  return failed;
}

SweepTable table_of(const Cohort& cohort, const std::vector<CohortEnd>& ends) {
  std::vector<CaseEnd> all;
  for (const CohortEnd& end : ends) all.push_back({end.line["report"], end.error});
  SweepTable table = make_table(cohort.values(), all, {});
  table.keys.insert(table.keys.begin(), "name");
  for (std::size_t n = 0; n < ends.size(); ++n) {
    std::vector<std::string>& values = table.rows[n].values;
    values.insert(values.begin(), cohort.name(ends[n].n));
  }
  return table;
}

std::string cohort_page(const Cohort& cohort, const std::vector<CohortEnd>& ends) {
  const SweepTable table = table_of(cohort, ends);
  const std::size_t failed = failures_of(ends);
  Value page = {{"program", program_of_results()},
                {"done", with_count(std::int64_t(ends.size() - failed), "case")},
                {"all", ends.size()},
                {"failed", failed == 0 ? Value() : Value(failed)},
                {"heads", Value::List()},
                {"rows", Value::List()}};
  for (const auto* names : {&table.keys, &table.results}) {
    for (const std::string& name : *names) page["heads"].push_back(name);
  }
  page["heads"].erase(std::size_t(0));  // names have a column of their own
  for (std::size_t n = 0; n < ends.size(); ++n) {
    const std::string& name = cohort.name(ends[n].n);
    const std::string folder = "cases/" + address_of(name) + "/";
    const Value& line = ends[n].line;
    Value row = {{"name", name},
                 {"error", ends[n].error},
                 {"folder", folder},
                 {"warnings", line["warnings"]},
                 {"picture", ""},
                 {"cells", Value::List()},
                 {"columns", page["heads"].size()}};
    const std::string picture = picture_of(line["report"]);
    const bool has_small =
        std::filesystem::exists(cohort.folder() + "/" + "cases/" + name + "/thumbnail.jpg");
    if (ends[n].error.empty() && has_small) {
      row["picture"] =
          folder + address_of(std::filesystem::path(picture).lexically_normal().string());
    }
    const SweepTable::Row& cells = table.rows[n];
    for (std::size_t k = 1; k < cells.values.size(); ++k) row["cells"].push_back(cells.values[k]);
    for (const Value& result : cells.results) row["cells"].push_back(cell_text(result));
    page["rows"].push_back(std::move(row));
  }
  return filled(kCohortTemplate, page);
}

}  // namespace supple::tools

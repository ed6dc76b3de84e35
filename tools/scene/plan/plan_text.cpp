#include "tools/scene/plan/plan_text.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "volumes/base/value.h"

namespace supple::tools {

namespace {

std::string megabytes_text(double held_mb, double brief_mb) {
  const double mb = held_mb + brief_mb;
  if (mb <= 0) return "";
  char text[32];
  std::snprintf(text, sizeof text, mb < 10 ? "%.1f MB" : "%.0f MB", mb);
  // Memory of both kinds shows as the kind that stays.
  return held_mb > 0 ? text : "(" + std::string(text) + ")";
}

std::string seconds_text(double seconds) {
  if (seconds <= 0) return "";
  char text[32];
  if (seconds < 0.0995) {
    std::snprintf(text, sizeof text, "%.0f ms", std::max(1.0, seconds * 1e3));
  } else {
    std::snprintf(text, sizeof text, "%.3g s", seconds);
  }
  return text;
}

using RowCells = std::array<std::string, 5>;

/// Columns as wide as their longest cell; numbers stand to the right.
std::string table_text(const std::vector<RowCells>& rows) {
  std::array<std::size_t, 5> width{};
  for (const RowCells& row : rows) {
    for (std::size_t n = 0; n < row.size(); ++n) width[n] = std::max(width[n], row[n].size());
  }
  std::string text;
  for (const RowCells& row : rows) {
    std::string line;
    for (std::size_t n = 0; n < row.size(); ++n) {
      const std::string gap(width[n] - row[n].size(), ' ');
      line += (n == 0 ? "" : "  ") + (n < 3 ? row[n] + gap : gap + row[n]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

double rounded(double value, double to) {
  return double(std::int64_t(value / to + 0.5)) * to;
}

}  // namespace

std::string text_of_plan(const ScenePlan& plan) {
  std::vector<RowCells> cells = {{"stage", "what", "why", "memory", "time"}};
  for (const PlanRow& row : plan.rows) {
    cells.push_back({row.stage, row.what, row.why, megabytes_text(row.held_mb, row.brief_mb),
                     seconds_text(row.seconds)});
  }
  char sums[160];
  std::snprintf(sums, sizeof sums, "peak %.0f MB, %s; memory in brackets is given back\n",
                plan.peak_mb, seconds_text(plan.seconds).c_str());
  std::string text = table_text(cells) + sums;
  for (const PlanGap& gap : plan.gaps) text += "not     " + gap.what + ": " + gap.why + "\n";
  return text + plan.costs + "\n";
}

Value to_value(const ScenePlan& plan) {
  Value json;
  json["rows"] = Value::List();
  for (const PlanRow& row : plan.rows) {
    json["rows"].push_back({{"stage", row.stage},
                            {"what", row.what},
                            {"why", row.why},
                            {"held_mb", rounded(row.held_mb, 1e-3)},
                            {"brief_mb", rounded(row.brief_mb, 1e-3)},
                            {"seconds", rounded(row.seconds, 1e-6)}});
  }
  json["not"] = Value::List();
  for (const PlanGap& gap : plan.gaps)
    json["not"].push_back({{"what", gap.what}, {"why", gap.why}});
  json["peak_mb"] = rounded(plan.peak_mb, 1e-3);
  json["seconds"] = rounded(plan.seconds, 1e-6);
  json["costs"] = plan.costs;
  return json;
}

std::string outcome_text(const ScenePlan& plan, const PlanOutcome& outcome) {
  char text[200];
  std::snprintf(text, sizeof text,
                "planned %.0f MB and %.3g s, took %.0f MB and %.3g s (processor time %.3g s)",
                plan.peak_mb, plan.seconds, outcome.peak_mb, outcome.seconds,
                outcome.processor_seconds);
  return text;
}

Value outcome_json(const ScenePlan& plan, const PlanOutcome& outcome) {
  return {{"peak_mb", rounded(plan.peak_mb, 1e-3)},
          {"seconds", rounded(plan.seconds, 1e-6)},
          {"was_peak_mb", outcome.peak_mb},
          {"was_seconds", outcome.seconds},
          {"was_processor_seconds", outcome.processor_seconds}};
}

}  // namespace supple::tools

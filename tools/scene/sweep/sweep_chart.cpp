#include "tools/scene/sweep/sweep_chart.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "tools/scene/sweep/report_names.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

constexpr std::size_t kLongestName = 26;

std::string cut(std::string text) {
  if (text.size() <= kLongestName) return text;
  std::size_t end = kLongestName - 1;
  while (end > 0 && (text[end] & 0xC0) == 0x80) --end;  // within a character
  return text.substr(0, end) + "…";
}

/// A value as a legend has it.
std::string name_of(const std::optional<SweptValue>& swept) {
  if (!swept) return "as it is";
  const Value* name = swept->value.find("name");
  return cut(name != nullptr && name->is_text() ? name->text() : swept->text);
}

class SweepChart {
 public:
  SweepChart(const SweepTable& table, const SweepCases& cases, const ChartChoice& choice)
      : m_table(table), m_cases(cases), m_choice(choice) {
    m_x = choice.x.empty() ? first_swept() : column_of(table, choice.x, "--x");
    m_y = choice.y.empty() ? first_result() : column_of(table, choice.y, "--y");
    m_along = m_x < table.keys.size() ? m_x : first_swept();
  }

  Chart chart() {
    Chart chart;
    chart.x_name = words_of(column_names(m_table)[m_x]);
    chart.y_name = words_of(column_names(m_table)[m_y]);
    chart.x_kind = kind_of_x();
    chart.y_kind = m_choice.y_is_log ? AxisSteps::decades : AxisSteps::even;
    chart.legend = legend();
    for (std::size_t n = 0; n < m_table.rows.size(); ++n) add_row(n, chart);
    if (chart.curves.empty()) {
      throw InputError({"", "--plot", "no case with numbers for both axes",
                        "a result that is a number, by --y"});
    }
    const bool is_sorted = chart.x_kind != AxisSteps::words && m_x == m_along;
    for (ChartCurve& curve : chart.curves) {
      if (!is_sorted) continue;
      std::stable_sort(curve.points.begin(), curve.points.end(),
                       [](const ChartPoint& a, const ChartPoint& b) { return a.x < b.x; });
    }
    if (chart.curves.size() == 1 && chart.legend.empty()) chart.curves[0].name = chart.y_name;
    return chart;
  }

 private:
  std::size_t first_swept() const {
    for (std::size_t k = 0; k < m_table.keys.size(); ++k) {
      if (has_several(k)) return k;
    }
    throw InputError({"", "--plot", "no key with several values", "--vary KEY=A,B,C, or --x"});
  }
  std::size_t first_result() const {
    std::optional<std::size_t> flat;
    for (std::size_t c = 0; c < m_table.results.size(); ++c) {
      std::set<double> numbers;
      for (const SweepTable::Row& row : m_table.rows) {
        if (row.results[c].is_number()) numbers.insert(row.results[c].number());
      }
      if (numbers.size() > 1) return m_table.keys.size() + c;
      if (!numbers.empty() && !flat) flat = m_table.keys.size() + c;
    }
    if (flat) return *flat;
    throw InputError({"", "--plot", "no result that is a number", "one by --collect"});
  }
  bool has_several(std::size_t key) const {
    return std::any_of(m_table.rows.begin(), m_table.rows.end(), [&](const SweepTable::Row& row) {
      return row.values[key] != m_table.rows.front().values[key];
    });
  }

  std::optional<double> number_in(std::size_t n, std::size_t column) const {
    const std::size_t keys = m_table.keys.size();
    const auto& swept = column < keys ? m_cases.row(n)[column] : std::nullopt;
    const Value value = column >= keys ? m_table.rows[n].results[column - keys]
                        : swept        ? swept->value
                                       : Value();
    if (!value.is_number() || !std::isfinite(value.number())) return std::nullopt;
    return value.number();
  }

  AxisSteps kind_of_x() const {
    for (std::size_t n = 0; m_x < m_table.keys.size() && n < m_table.rows.size(); ++n) {
      if (!number_in(n, m_x)) return AxisSteps::words;
    }
    return m_choice.x_is_log ? AxisSteps::decades : AxisSteps::even;
  }

  /// Keys that tell curves apart.
  std::vector<std::size_t> other_keys() const {
    std::vector<std::size_t> keys;
    for (std::size_t k = 0; k < m_table.keys.size(); ++k) {
      if (k != m_along && has_several(k)) keys.push_back(k);
    }
    return keys;
  }
  std::string legend() const {
    std::string legend;
    for (const std::size_t key : other_keys()) {
      legend += (legend.empty() ? "" : ", ") + words_of(m_cases.short_key(key));
    }
    return cut(legend);
  }

  double required(double value, bool is_log, std::size_t column) const {
    if (!is_log || value > 0) return value;
    throw InputError({"", "--log", number_text(value) + " of " + column_names(m_table)[column],
                      "values above 0 on an axis of decades"});
  }

  void add_row(std::size_t n, Chart& chart) {
    const std::optional<double> y = number_in(n, m_y);
    std::optional<double> x = number_in(n, m_x);
    if (chart.x_kind == AxisSteps::words) x = double(place_of_word(n, chart.x_words));
    if (!x || !y) return;
    required(*x, chart.x_kind == AxisSteps::decades, m_x);
    required(*y, chart.y_kind == AxisSteps::decades, m_y);
    std::vector<std::string> values;  // by which names that were cut are told apart
    std::string name;
    for (const std::size_t key : other_keys()) {
      values.push_back(m_table.rows[n].values[key]);
      name += (name.empty() ? "" : ", ") + name_of(m_cases.row(n)[key]);
    }
    const auto [curve, is_new] = m_curves.try_emplace(values, chart.curves.size());
    if (is_new) chart.curves.push_back({name, {}});
    const std::string tip =
        m_cases.title(n) + "\n" + column_names(m_table)[m_y] + " = " + number_text(*y);
    chart.curves[curve->second].points.push_back({*x, *x, *x, *y, tip, ""});
  }

  std::size_t place_of_word(std::size_t n, std::vector<std::string>& words) {
    const auto [place, is_new] = m_words.try_emplace(m_table.rows[n].values[m_x], words.size());
    if (is_new) words.push_back(name_of(m_cases.row(n)[m_x]));
    return place->second;
  }

  const SweepTable& m_table;
  const SweepCases& m_cases;
  const ChartChoice& m_choice;
  std::map<std::vector<std::string>, std::size_t> m_curves;
  std::map<std::string, std::size_t> m_words;
  std::size_t m_x, m_y;
  std::size_t m_along;  // the key along which points are joined
};

}  // namespace

Chart chart_of(const SweepTable& table, const SweepCases& cases, const ChartChoice& choice) {
  return SweepChart(table, cases, choice).chart();
}

}  // namespace supple::tools

#include "tools/scene/choice/trade_row.h"

#include <algorithm>
#include <charconv>
#include <functional>

#include "volumes/base/csv.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple::tools {

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  const double median =
      values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
  return {values.front(), median, values.back()};
}

std::string TradeRow::name() const {
  return method + ':' + exact_text(knob);
}

namespace {

/// A column: its name, and its field as text in both directions. `set` is false for what is no
/// value.
struct Column {
  std::string name;
  std::function<std::string(const TradeRow&)> get;
  std::function<bool(TradeRow&, const std::string&)> set;
};

template <class Number>
bool read_number(const std::string& text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

Column text_column(const std::string& name, std::string TradeRow::*field) {
  return {name, [field](const TradeRow& row) { return row.*field; },
          [field](TradeRow& row, const std::string& text) {
            row.*field = text;
            return true;
          }};
}

template <class Number>
Column number_column(const std::string& name, Number TradeRow::*field) {
  return {
      name,
      [field](const TradeRow& row) {
        if constexpr (std::is_integral_v<Number>)
          return std::to_string(row.*field);
        else
          return exact_text(row.*field);
      },
      [field](TradeRow& row, const std::string& text) { return read_number(text, row.*field); }};
}

void add_spread(std::vector<Column>& columns, const std::string& name, Spread TradeRow::*field) {
  const auto add = [&](const char* end, double Spread::*part) {
    columns.push_back({name + end,
                       [=](const TradeRow& row) { return exact_text(row.*field.*part); },
                       [=](TradeRow& row, const std::string& text) {
                         return read_number(text, row.*field.*part);
                       }});
  };
  add("_min_s", &Spread::least);
  add("_median_s", &Spread::median);
  add("_max_s", &Spread::most);
}

std::vector<Column> make_columns() {
  std::vector<Column> columns = {
      text_column("scene", &TradeRow::scene),        text_column("inputs", &TradeRow::inputs),
      text_column("method", &TradeRow::method),      number_column("knob", &TradeRow::knob),
      text_column("status", &TradeRow::status),      text_column("reason", &TradeRow::reason),
      number_column("runs", &TradeRow::runs),        number_column("threads", &TradeRow::threads),
      number_column("held_out", &TradeRow::held_out)};
  add_spread(columns, "prepare", &TradeRow::prepare_s);
  add_spread(columns, "solve", &TradeRow::solve_s);
  add_spread(columns, "invert", &TradeRow::invert_s);
  add_spread(columns, "render", &TradeRow::render_s);
  add_spread(columns, "draw", &TradeRow::draw_s);
  add_spread(columns, "wall", &TradeRow::wall_s);
  for (Column& column : std::vector<Column>{
           number_column("peak_mb", &TradeRow::peak_mb), number_column("moved", &TradeRow::moved),
           number_column("error_p50_mm", &TradeRow::p50_mm),
           number_column("error_p95_mm", &TradeRow::p95_mm),
           number_column("error_max_mm", &TradeRow::max_mm),
           number_column("volume_percent", &TradeRow::volume_percent),
           number_column("energy_uj", &TradeRow::energy_uj), number_column("rmse", &TradeRow::rmse),
           number_column("ssim", &TradeRow::ssim), text_column("warning", &TradeRow::warning),
           text_column("version", &TradeRow::version),
           text_column("command", &TradeRow::command)}) {
    columns.push_back(std::move(column));
  }
  return columns;
}

const std::vector<Column>& columns_of_rows() {
  static const std::vector<Column> columns = make_columns();
  return columns;
}

template <class Text>
std::string line_of(const Text& text_of) {
  std::vector<std::string> fields;
  for (const Column& column : columns_of_rows()) fields.push_back(text_of(column));
  return csv_line(fields);
}

}  // namespace

std::string to_csv(const std::vector<TradeRow>& rows) {
  std::string text = line_of([](const Column& column) { return column.name; });
  for (const TradeRow& row : rows) {
    text += line_of([&row](const Column& column) { return column.get(row); });
  }
  return text;
}

std::vector<TradeRow> rows_from_csv(const std::string& text, const std::string& file) {
  const std::vector<Column>& columns = columns_of_rows();
  std::vector<TradeRow> rows;
  std::size_t at = 0;
  for (int line = 1; at < text.size(); ++line) {
    const std::vector<std::string> fields = take_csv_line(text, at);
    const std::string place = file + ':' + std::to_string(line);
    if (fields.size() != columns.size()) {
      throw InputError({place, "", with_count(std::int64_t(fields.size()), "column"),
                        std::to_string(columns.size()) + " columns of this version"});
    }
    TradeRow row;
    for (std::size_t n = 0; n < columns.size(); ++n) {
      const bool fits = line == 1 ? fields[n] == columns[n].name : columns[n].set(row, fields[n]);
      if (!fits) {
        throw InputError(
            {place, columns[n].name, fields[n], line == 1 ? "this column" : "a value"});
      }
    }
    if (line > 1) rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace supple::tools

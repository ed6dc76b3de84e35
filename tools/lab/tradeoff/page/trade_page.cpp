#include "tools/lab/tradeoff/page/trade_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>

#include "tools/lab/tradeoff/held_out.h"
#include "tools/lab/tradeoff/page/page_template.h"
#include "tools/lab/tradeoff/page/page_text.h"
#include "tools/scene/chart/chart.h"
#include "tools/scene/chart/chart_style.h"
#include "tools/scene/chart/template.h"
#include "tools/scene/pictures/jpeg.h"
#include "tools/scene/pictures/thumbnail.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

std::string mm_text(double mm) {
  return short_number(mm) + " mm";
}

std::string ssim_text(double error) {
  return "SSIM " + short_number(1 - error);
}

/// The point of a row; times that no clock tells apart from 0 have a place on an axis of decades.
ChartPoint chart_point(const TradeResults& results, std::size_t r) {
  static constexpr double kLeast = 1e-6;
  const TradeRow& row = results.rows[r];
  const Spread& time = row.time_s();
  const auto at = [](double seconds) { return std::max(seconds, kLeast); };
  return {at(time.median), at(time.least), at(time.most),
          row.error(),     tip_of(row),    '#' + row_id(r)};
}

Chart chart_of(const TradeResults& results, const SceneCurves& curves) {
  Chart chart;
  chart.x_kind = chart.y_kind = AxisSteps::decades;
  chart.x_name = curves.are_drawings ? "time of inverse and rendering, s" : "time of solving, s";
  chart.y_name = curves.are_drawings ? "1 - SSIM" : "error p95, mm";
  chart.floor_name = "floor of the reference";
  chart.floor = curves.floor;
  for (const MethodCurve& curve : curves.methods) {
    ChartCurve drawn{curve.title, {}};
    for (const TradePoint& point : curve.points) {
      drawn.points.push_back(chart_point(results, point.row));
    }
    for (const std::size_t r : curve.missed) {
      const TradeRow& row = results.rows[r];
      chart.misses.push_back(
          {chart.curves.size(), row.status != "failed", tip_of(row), '#' + row_id(r)});
    }
    chart.curves.push_back(std::move(drawn));
  }
  for (const TradePoint& point : curves.front) {
    chart.front.push_back(chart_point(results, point.row));
  }
  return chart;
}

Value choice_of(const TradeResults& results, const HeldOutChoice& choice) {
  Value value = {{"asked", choice.is_budget ? "within " + time_text(choice.asked)
                                            : "error " + mm_text(choice.asked)},
                 {"method", choice.chosen ? choice.chosen->method : ""}};
  if (!choice.chosen) return value;
  const TradeRow& row = results.rows[choice.row];
  value.update({{"id", row_id(choice.row)},
                {"expected_time", time_text(choice.chosen->solve_s)},
                {"expected_error", mm_text(choice.chosen->error_mm)},
                {"failure", choice.is_ok ? "" : row.status + ": " + row.reason},
                {"time", time_text(row.solve_s.median)},
                {"error", mm_text(row.p95_mm)},
                {"time_ratio", short_number(choice.time_ratio)},
                {"error_ratio", short_number(choice.error_ratio)},
                {"is_kept", choice.is_kept}});
  return value;
}

/// Results of choices from the other loads on the one that is held out.
Value held_out_of(const TradeResults& results) {
  const std::vector<HeldOutChoice> choices = check_held_out(results.rows, results.floor_mm());
  Value value = {{"summary", summary_of(choices)}, {"floor", mm_text(results.floor_mm())}};
  Value& lines = value["choices"] = Value::List();
  for (const HeldOutChoice& choice : choices) lines.push_back(choice_of(results, choice));
  return value;
}

/// Values of the template for one diagram of a scene with its tables: of solving, or of drawing.
class PartOfPage {
 public:
  PartOfPage(const TradeResults& results, const TradeScene& scene, bool are_drawings)
      : m_results(results), m_scene(scene), m_curves(curves_of(results, scene, are_drawings)) {}

  Value all() const {
    const TradeRow& reference = m_results.rows[m_curves.reference];
    Value part = {{"reference_id", row_id(m_curves.reference)},
                  {"reference", reference.name()},
                  {"floor", short_number(m_curves.floor)},
                  {"chart", to_svg(chart_of(m_results, m_curves))},
                  {"pictures", pictures()},
                  {"tables", m_scene.is_held_out ? Value::List() : tables()},
                  {"heads", heads()}};
    if (!m_curves.are_drawings) {
      part["solving"] = {
          {"volume", m_scene.volume},
          {"moved", reference.moved},
          {"is_halved", m_scene.size_error_mm == m_curves.floor},
          {"size_error", m_scene.size_error_mm > 0 ? short_number(m_scene.size_error_mm) : ""},
          {"reference_warning", reference.warning}};
      if (m_scene.is_held_out) part["held_out"] = held_out_of(m_results);
    }
    Value& rows = part["rows"] = Value::List();
    for (const std::size_t r : m_curves.rows) rows.push_back(row(r));
    return part;
  }

 private:
  template <class Head, class Text, class Read>
  Value table(const std::string& title, const std::vector<double>& values, const Head& head,
              const Text& text, const Read& read) const {
    std::vector<std::string> heads;
    std::vector<double> best(values.size(), 1e300);
    for (std::size_t n = 0; n < values.size(); ++n) {
      heads.push_back(head(values[n]));
      for (const MethodCurve& curve : m_curves.methods) {
        const auto found = read(curve.points, values[n], m_curves.floor);
        if (found) best[n] = std::min(best[n], found->value);
      }
    }
    Value lines = Value::List();
    for (const MethodCurve& curve : m_curves.methods) {
      Value& cells = lines.push_back({{"title", curve.title}})["cells"] = Value::List();
      for (std::size_t n = 0; n < values.size(); ++n) {
        const auto found = read(curve.points, values[n], m_curves.floor);
        Value& cell = cells.push_back(Value::Entries());
        if (!found) continue;
        const bool is_between = found->row_a != found->row_b;
        cell = {{"id", row_id(found->row_b)},
                {"other_id", is_between ? row_id(found->row_a) : ""},
                {"text", text(found->value)},
                {"is_best", found->value <= best[n]}};
      }
    }
    return {{"title", title}, {"heads", heads}, {"lines", lines}};
  }

  Value tables() const {
    Value both = Value::List();
    if (m_curves.are_drawings) {
      both.push_back(table("Time of inverse and rendering to a likeness", kErrorsOfPictures,
                           ssim_text, time_text, time_to_error));
      both.push_back(table("Likeness within a time of inverse and rendering", kTimes_s, time_text,
                           ssim_text, error_within_time));
    } else {
      both.push_back(table("Time of solving to an error (p95)", kErrors_mm, mm_text, time_text,
                           time_to_error));
      both.push_back(table("Error (p95) within a time of solving", kTimes_s, time_text, mm_text,
                           error_within_time));
    }
    return both;
  }

  /// Columns of rows that are ok, beside row, setting and notes.
  std::vector<std::string> heads() const {
    if (m_curves.are_drawings) {
      return {"invert and render", "invert", "render", "MB", "SSIM", "RMSE"};
    }
    return {"solve",  "prepare", "invert", "render",   "MB",
            "p50 mm", "p95 mm",  "max mm", "volume %", "energy uJ"};
  }
  std::vector<std::string> cells(const TradeRow& row) const {
    const std::string invert = time_text(row.invert_s.median);
    const std::string render = time_text(row.render_s.median);
    const std::string memory = short_number(row.peak_mb);
    if (m_curves.are_drawings) {
      return {spread_text(row.draw_s), invert, render, memory, short_number(row.ssim),
              short_number(row.rmse)};
    }
    return {spread_text(row.solve_s),
            time_text(row.prepare_s.median),
            invert,
            render,
            memory,
            short_number(row.p50_mm),
            short_number(row.p95_mm),
            short_number(row.max_mm),
            short_number(row.volume_percent),
            short_number(row.energy_uj)};
  }

  Value row(std::size_t r) const {
    const TradeRow& row = m_results.rows[r];
    return {{"id", row_id(r)},
            {"line", r + 2},
            {"command", row.command},
            {"name", row.name()},
            {"failure", row.is_ok() ? "" : row.status + ": " + row.reason},
            {"columns", heads().size() + 1},
            {"cells", cells(row)},
            {"alike", m_curves.alike_text(r)},
            {"warning", row.warning}};
  }

  void add_figure(Value& figures, std::size_t r) const {
    const TradeRow& row = m_results.rows[r];
    const std::optional<Image> image = row.is_ok() ? thumbnail_of(row.picture) : std::nullopt;
    if (!image) return;
    const std::string error = row.is_drawing() ? ssim_text(row.error()) : mm_text(row.p95_mm);
    const bool is_reference = r == m_curves.reference;
    const std::vector<std::uint8_t> jpeg = jpeg_of(*image);
    figures.push_back(
        {{"id", row_id(r)},
         {"width", image->width},
         {"height", image->height},
         {"command", row.command},
         {"name", row.name()},
         {"jpeg", base64_of({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()})},
         {"caption",
          is_reference ? "the reference" : time_text(row.time_s().median) + ", " + error}});
  }

  /// Figures of all rows that left a picture: the reference and the front, then the others, folded.
  Value pictures() const {
    Value first = Value::List(), rest = Value::List();
    add_figure(first, m_curves.reference);
    for (const TradePoint& point : m_curves.front) add_figure(first, point.row);
    for (const std::size_t r : m_curves.rows) {
      const bool is_of_front = std::any_of(m_curves.front.begin(), m_curves.front.end(),
                                           [&](const TradePoint& point) { return point.row == r; });
      if (r != m_curves.reference && !is_of_front) add_figure(rest, r);
    }
    if (first.empty() && rest.empty()) return nullptr;
    Value groups = Value::List();
    groups.push_back({{"is_folded", false}, {"figures", first}});
    if (!rest.empty()) groups.push_back({{"is_folded", true}, {"figures", rest}});
    return {{"groups", groups}, {"is_there", true}};
  }

  const TradeResults& m_results;
  const TradeScene& m_scene;
  SceneCurves m_curves;
};

}  // namespace

std::string trade_page(const TradeResults& results) {
  Value page = {{"chart_style", kChartStyle},
                {"machine", results.machine},
                {"version", results.rows.empty() ? "" : results.rows.front().version}};
  Value& scenes = page["scenes"] = Value::List();
  for (const TradeScene& scene : results.scenes) {
    Value& parts = scenes.push_back({{"file", scene.file}, {"parts", Value::List()}})["parts"];
    parts.push_back(PartOfPage(results, scene, false).all());
    if (scene.has_drawings) parts.push_back(PartOfPage(results, scene, true).all());
  }
  return filled(kPageTemplate, page);
}

std::vector<ChartFile> chart_files(const TradeResults& results) {
  std::vector<ChartFile> files;
  const auto add = [&](const TradeScene& scene, const char* name, bool are_drawings) {
    const SceneCurves curves = curves_of(results, scene, are_drawings);
    files.push_back({name + scene.name + ".svg", to_svg_file(chart_of(results, curves))});
  };
  for (const TradeScene& scene : results.scenes) {
    add(scene, "error_time_", false);
    if (scene.has_drawings) add(scene, "likeness_time_", true);
  }
  return files;
}

}  // namespace supple::tools

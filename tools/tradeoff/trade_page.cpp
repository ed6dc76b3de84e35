#include "tools/tradeoff/trade_page.h"

#include <algorithm>
#include <cstdio>

#include "tools/tradeoff/trade_chart.h"
#include "tools/tradeoff/trade_curves.h"
#include "tools/tradeoff/trade_tables.h"

namespace supple::tools {

namespace {

constexpr const char* kStyle = R"(<style>
:root { color-scheme: light; font: 15px/1.45 system-ui, sans-serif; color: #1c1c1c; }
body { max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; } h3 { font-size: 1rem; }
table { border-collapse: collapse; margin: .6rem 0 1.4rem; font-size: .85rem; }
th, td { padding: .18rem .6rem; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child { text-align: left; }
td.text { text-align: left; } tr:target { background: #fff3c4; } td.best { font-weight: 600; }
a { color: inherit; } code { font-size: .85em; background: #f3f3f3; padding: .1em .3em; }
.chart { width: 100%; height: auto; font-size: 12px; }
.chart .grid { stroke: #e2e2e2; } .chart .name { font-weight: 600; } .chart .small { fill: #666; font-size: 11px; }
.chart .floor { fill: #00000010; } .chart .front { fill: none; stroke: #00000030; stroke-width: 7; stroke-linejoin: round; }
.chart .way { fill: none; stroke: var(--c); stroke-width: 1.4; } .chart .whisker { stroke: var(--c); stroke-width: 1.4; }
.chart .point { fill: var(--c); stroke: #fff; stroke-width: .8; } .chart .hollow { fill: #fff; stroke: var(--c); stroke-width: 1.6; }
.chart .miss line { stroke: var(--c); stroke-width: 2; } .chart .touch { fill: transparent; }
.chart.dim .curve:not(.on) { opacity: .12; } .chart .entry { cursor: pointer; }
#shown { position: sticky; bottom: 0; background: #fff; border-top: 1px solid #ccc; padding: .4rem 0; min-height: 2.6em; font-size: .85rem; white-space: pre-wrap; }
</style>
)";

/// What the pointer is over, below the page, and the curve of an entry of the legend alone.
constexpr const char* kScript = R"(<script>
const shown = document.getElementById('shown');
for (const title of document.querySelectorAll('.chart title')) {
  const mark = title.parentNode, words = title.textContent;
  mark.addEventListener('pointerenter', () => { shown.textContent = words; });
}
for (const entry of document.querySelectorAll('.chart .entry')) {
  const chart = entry.closest('.chart');
  const own = chart.querySelector('.curve[data-curve="' + entry.dataset.curve + '"]');
  entry.addEventListener('pointerenter', () => { chart.classList.add('dim'); own.classList.add('on'); });
  entry.addEventListener('pointerleave', () => { chart.classList.remove('dim'); own.classList.remove('on'); });
}
</script>
)";

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string time_text(double seconds) {
  if (seconds < 1) return short_number(1000 * seconds) + " ms";
  return seconds < 100 ? short_number(seconds) + " s" : short_number(seconds / 60) + " min";
}

std::string spread_text(const Spread& spread) {
  return time_text(spread.median) + " (" + time_text(spread.least) + " to " +
         time_text(spread.most) + ')';
}

/// Rows are named by their lines in runs.csv, whose first line has the names of columns.
std::string row_id(std::size_t row) {
  return "row-" + std::to_string(row + 2);
}

std::string tip_of(const TradeRow& row) {
  std::string tip = row.name() + '\n' + row.command + '\n';
  if (!row.is_ok()) return tip + row.status + ": " + row.reason;
  tip += "solve " + spread_text(row.solve_s) + ", prepare " + time_text(row.prepare_s.median) +
         ", invert " + time_text(row.invert_s.median) + ", render " +
         time_text(row.render_s.median) + ", " + std::to_string(row.runs) + " runs, " +
         short_number(row.peak_mb) + " MB\n";
  return tip + "error p50 " + short_number(row.p50_mm) + ", p95 " + short_number(row.p95_mm) +
         ", max " + short_number(row.max_mm) + " mm";
}

class PageOfScene {
 public:
  PageOfScene(const TradeResults& results, std::size_t scene)
      : m_results(results), m_scene(results.scenes[scene]), m_curves(curves_of(results, m_scene)) {}

  std::string draw() {
    m_html = "<h2>" + html_text(m_scene.file) + "</h2>\n";
    tell_reference();
    m_html += to_svg(chart());
    draw_matched(
        "Time to an error (p95)", "error", kErrors_mm,
        [](double mm) { return short_number(mm) + " mm"; }, time_text, time_to_error);
    draw_matched(
        "Error (p95) within a time of solving", "time", kTimes_s, time_text,
        [](double mm) { return short_number(mm) + " mm"; }, error_within_time);
    draw_rows();
    return m_html;
  }

 private:
  const TradeRow& reference() const { return m_results.rows[m_curves.reference]; }

  void tell_reference() {
    const TradeRow& row = reference();
    m_html +=
        "<p>Volume <code>" + html_text(m_scene.volume) +
        "</code>. Errors are distances in mm "
        "to the reference, <a href=\"#" +
        row_id(m_curves.reference) + "\"><code>" + html_text(row.name()) +
        "</code></a>: linear finite elements on the same voxels, over "
        "the " +
        std::to_string(row.moved) +
        " elements that it moves by at least 1&#8239;% of "
        "the largest move. Below " +
        short_number(m_scene.floor_mm) +
        " mm nothing can be told "
        "apart: by so much the reference differs from itself solved less tightly, or places "
        "are rounded when they are stored. This floor is that of the solver alone. How far the "
        "voxels themselves are from the tissue, and linear theory from large moves, it does "
        "not say.";
    if (!row.warning.empty()) {
      m_html += " The reference warned: <em>" + html_text(row.warning) + "</em>.";
    }
    m_html += "</p>\n";
  }

  ChartPoint chart_point(std::size_t r) const {
    const TradeRow& row = m_results.rows[r];
    return {row.solve_s.median, row.solve_s.least, row.solve_s.most,
            row.p95_mm,         tip_of(row),       '#' + row_id(r)};
  }

  LogChart chart() const {
    LogChart chart{"time of solving, s", "error p95, mm", "floor of the reference", {}, {}, {},
                   m_scene.floor_mm};
    std::vector<TradePoint> all;
    for (const MethodCurve& curve : m_curves.methods) {
      ChartCurve drawn{curve.title, {}};
      for (const TradePoint& point : curve.points) drawn.points.push_back(chart_point(point.row));
      for (const std::size_t r : curve.missed) {
        const TradeRow& row = m_results.rows[r];
        chart.misses.push_back(
            {chart.curves.size(), row.status != "failed", tip_of(row), '#' + row_id(r)});
      }
      chart.curves.push_back(std::move(drawn));
    }
    for (const TradePoint& point : m_curves.front) chart.front.push_back(chart_point(point.row));
    return chart;
  }

  std::string cell(const std::optional<CurveValue>& value, const std::string& text,
                   bool is_best) const {
    if (!value) return "<td>&#8211;</td>";
    std::string html = std::string("<td") + (is_best ? " class=\"best\"" : "") + "><a href=\"#" +
                       row_id(value->row_b) + "\">" + text + "</a>";
    if (value->row_a != value->row_b) {
      html += " <a href=\"#" + row_id(value->row_a) + "\">~</a>";
    }
    return html + "</td>";
  }

  template <class Head, class Text, class Read>
  void draw_matched(const std::string& title, const std::string& what,
                    const std::vector<double>& values, const Head& head, const Text& text,
                    const Read& read) {
    m_html += "<h3>" + title + "</h3>\n<table><tr><th>method</th>";
    for (const double value : values) m_html += "<th>" + head(value) + "</th>";
    m_html += "</tr>\n";
    std::vector<double> best(values.size(), 1e300);
    for (const MethodCurve& curve : m_curves.methods) {
      for (std::size_t n = 0; n < values.size(); ++n) {
        const auto found = read(curve.points, values[n], m_scene.floor_mm);
        if (found) best[n] = std::min(best[n], found->value);
      }
    }
    for (const MethodCurve& curve : m_curves.methods) {
      m_html += "<tr><td>" + html_text(curve.title) + "</td>";
      for (std::size_t n = 0; n < values.size(); ++n) {
        const auto found = read(curve.points, values[n], m_scene.floor_mm);
        m_html += cell(found, found ? text(found->value) : "", found && found->value <= best[n]);
      }
      m_html += "</tr>\n";
    }
    m_html +=
        "</table>\n<p>&#8211;: not reached. ~: on the line between the row that the number leads "
        "to and the one that ~ does. Bold: the best of a column of one " +
        what + ".</p>\n";
  }

  void draw_rows() {
    m_html +=
        "<h3>All rows</h3>\n<table><tr><th>row</th><th>setting</th><th>solve</th>"
        "<th>prepare</th><th>invert</th><th>render</th><th>MB</th><th>p50 mm</th>"
        "<th>p95 mm</th><th>max mm</th><th>volume %</th><th>energy uJ</th><th></th></tr>\n";
    for (const std::size_t r : m_curves.rows) draw_row(r);
    m_html += "</table>\n";
  }

  void draw_row(std::size_t r) {
    const TradeRow& row = m_results.rows[r];
    m_html += "<tr id=\"" + row_id(r) + "\"><td>" + std::to_string(r + 2) +
              "</td><td class=\"text\"><code title=\"" + html_text(row.command) + "\">" +
              html_text(row.name()) + "</code></td>";
    if (!row.is_ok()) {
      m_html += "<td class=\"text\" colspan=\"10\">" + row.status + ": " + html_text(row.reason) +
                "</td><td></td></tr>\n";
      return;
    }
    for (const std::string& text :
         {spread_text(row.solve_s), time_text(row.prepare_s.median), time_text(row.invert_s.median),
          time_text(row.render_s.median), short_number(row.peak_mb), short_number(row.p50_mm),
          short_number(row.p95_mm), short_number(row.max_mm), short_number(row.volume_percent),
          short_number(row.energy_uj)}) {
      m_html += "<td>" + text + "</td>";
    }
    std::string note = m_curves.alike_text(r);
    if (!row.warning.empty()) note += (note.empty() ? "" : "; ") + row.warning;
    m_html += "<td class=\"text\">" + html_text(note) + "</td></tr>\n";
  }

  const TradeResults& m_results;
  const TradeScene& m_scene;
  SceneCurves m_curves;
  std::string m_html;
};

}  // namespace

std::string trade_page(const TradeResults& results) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<title>Time against error</title>\n" +
      std::string(kStyle) + "</head><body>\n<h1>Time against error</h1>\n";
  if (!results.rows.empty()) {
    html +=
        "<p>supple " + html_text(results.rows.front().version) + "; " + html_text(results.machine) +
        ". Times are medians, with the least and the most of all runs; each run is a process of "
        "its own, whose files the system may have kept in memory from an earlier one. Numbers "
        "come from <code>runs.csv</code> beside this page; a row is named by its line there. The "
        "pointer over a mark shows its command, and a click leads to its row.</p>\n";
  }
  for (std::size_t n = 0; n < results.scenes.size(); ++n) html += PageOfScene(results, n).draw();
  return html + "<div id=\"shown\"></div>\n" + kScript + "</body></html>\n";
}

}  // namespace supple::tools

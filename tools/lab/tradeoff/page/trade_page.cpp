#include "tools/lab/tradeoff/page/trade_page.h"

#include <algorithm>

#include "tools/lab/tradeoff/page/held_out_part.h"
#include "tools/lab/tradeoff/page/page_parts.h"
#include "tools/lab/tradeoff/page/page_text.h"
#include "tools/lab/tradeoff/page/scene_charts.h"
#include "tools/lab/tradeoff/page/thumbnails.h"
#include "tools/lab/tradeoff/trade_curves.h"
#include "tools/lab/tradeoff/trade_tables.h"

namespace supple::tools {

namespace {

/// One diagram of a scene with its tables: of solving, or of drawing.
class PageOfCurves {
 public:
  PageOfCurves(const TradeResults& results, const TradeScene& scene, bool are_drawings)
      : m_results(results), m_scene(scene), m_curves(curves_of(results, scene, are_drawings)) {}

  std::string draw() {
    if (m_curves.are_drawings) {
      draw_of_drawings();
    } else {
      draw_of_solving();
    }
    draw_rows();
    return std::move(m_html);
  }

 private:
  const TradeRow& reference() const { return m_results.rows[m_curves.reference]; }
  std::string link_to_reference() const {
    return "<a href=\"#" + row_id(m_curves.reference) + "\"><code>" +
           html_text(reference().name()) + "</code></a>";
  }

  void draw_of_solving() {
    tell_reference_state();
    draw_chart();
    if (m_scene.is_held_out) {
      m_html += held_out_part(m_results);
      return;
    }
    const auto mm = [](double value) { return short_number(value) + " mm"; };
    draw_matched("Time of solving to an error (p95)", kErrors_mm, mm, time_text, time_to_error);
    draw_matched("Error (p95) within a time of solving", kTimes_s, time_text, mm,
                 error_within_time);
  }

  void draw_of_drawings() {
    tell_reference_picture();
    draw_chart();
    if (m_scene.is_held_out) return;
    const auto ssim = [](double value) { return "SSIM " + short_number(1 - value); };
    draw_matched("Time of inverse and rendering to a likeness", kErrorsOfPictures, ssim, time_text,
                 time_to_error);
    draw_matched("Likeness within a time of inverse and rendering", kTimes_s, time_text, ssim,
                 error_within_time);
  }

  void draw_chart() {
    m_html += "<div class=\"wide\">" + to_svg(chart_of(m_results, m_curves)) + "</div>\n" +
              gallery_of(m_results, m_curves);
  }

  void tell_reference_state() {
    const TradeRow& row = reference();
    m_html += "<p>Volume <code>" + html_text(m_scene.volume) +
              "</code>. Errors are distances in mm to the reference, " + link_to_reference() +
              ": linear finite elements on the same voxels, over the " + std::to_string(row.moved) +
              " elements that it moves by more than 1&#8239;% of the largest move. Below " +
              short_number(m_curves.floor) + " mm nothing can be told apart: " + floor_text() +
              " How far linear theory is from large moves it does not say. Passes of relaxation "
              "lower the energy of the links' springs, "
              "which is not that of the reference: with many of them the error ends where both "
              "models differ, and may rise on the way there.";
    if (!row.warning.empty()) {
      m_html += " The reference warned: <em>" + html_text(row.warning) + "</em>.";
    }
    m_html += "</p>\n";
  }

  std::string floor_text() const {
    if (m_scene.size_error_mm == m_curves.floor) {
      return "by so much the reference is from the limit of smaller elements, estimated by "
             "Richardson's rule from elements of half a voxel and the order 1 that edges of "
             "handles and staircases have.";
    }
    return std::string(
               "by so much the reference differs from itself solved less tightly, or "
               "places are rounded when they are stored.") +
           (m_scene.size_error_mm > 0
                ? " The size of its elements adds " + short_number(m_scene.size_error_mm) + " mm."
                : " This floor is that of the solver alone: smaller elements were not measured.");
  }

  void tell_reference_picture() {
    m_html +=
        "<h3>Drawing</h3>\n<p>The first view in space, of the body as the fastest method "
        "leaves it, compared with " +
        link_to_reference() +
        ": every sample solves for its source. SSIM and RMSE are over pixels that are not "
        "empty in at least one picture. Below a difference of " +
        short_number(m_curves.floor) +
        " nothing can be told apart: by so much the reference differs from itself with twice "
        "the step. Cubic samples and pre-integration draw another picture on purpose; "
        "theirs is a difference, not an error.</p>\n";
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
  void draw_matched(const std::string& title, const std::vector<double>& values, const Head& head,
                    const Text& text, const Read& read) {
    m_html += "<h3>" + title + "</h3>\n<div class=\"wide\"><table><tr><th>method</th>";
    for (const double value : values) m_html += "<th>" + head(value) + "</th>";
    m_html += "</tr>\n";
    std::vector<double> best(values.size(), 1e300);
    for (const MethodCurve& curve : m_curves.methods) {
      for (std::size_t n = 0; n < values.size(); ++n) {
        const auto found = read(curve.points, values[n], m_curves.floor);
        if (found) best[n] = std::min(best[n], found->value);
      }
    }
    for (const MethodCurve& curve : m_curves.methods) {
      m_html += "<tr><td>" + html_text(curve.title) + "</td>";
      for (std::size_t n = 0; n < values.size(); ++n) {
        const auto found = read(curve.points, values[n], m_curves.floor);
        m_html += cell(found, found ? text(found->value) : "", found && found->value <= best[n]);
      }
      m_html += "</tr>\n";
    }
    m_html +=
        "</table></div>\n<p>&#8211;: not reached. ~: on the line between the row that the number "
        "leads "
        "to and the one that ~ does. Bold: the best of a column.</p>\n";
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

  void draw_rows() {
    m_html += "<h3>All rows</h3>\n<div class=\"wide\"><table><tr><th>row</th><th>setting</th>";
    for (const std::string& head : heads()) m_html += "<th>" + head + "</th>";
    m_html += "<th></th></tr>\n";
    for (const std::size_t r : m_curves.rows) draw_row(r);
    m_html += "</table></div>\n";
  }

  void draw_row(std::size_t r) {
    const TradeRow& row = m_results.rows[r];
    m_html += "<tr id=\"" + row_id(r) + "\"><td>" + std::to_string(r + 2) +
              "</td><td class=\"text\"><code title=\"" + html_text(row.command) + "\">" +
              html_text(row.name()) + "</code></td>";
    if (!row.is_ok()) {
      m_html += "<td class=\"note\" colspan=\"" + std::to_string(heads().size() + 1) + "\">" +
                row.status + ": " + html_text(row.reason) + "</td></tr>\n";
      return;
    }
    for (const std::string& text : cells(row)) m_html += "<td>" + text + "</td>";
    m_html += "<td class=\"note\">" + html_text(m_curves.alike_text(r));
    if (!row.warning.empty())
      m_html += " <span title=\"" + html_text(row.warning) + "\">warned</span>";
    m_html += "</td></tr>\n";
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
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<title>Time against error</title>\n" +
      std::string(kStyle) + kChartStyle + "</head><body>\n<h1>Time against error</h1>\n";
  if (!results.rows.empty()) {
    html +=
        "<p>supple " + html_text(results.rows.front().version) + "; " + html_text(results.machine) +
        ". Times are medians, with the least and the most of all runs; each run is a process of "
        "its own, whose files the system may have kept in memory from an earlier one. Numbers "
        "come from <code>runs.csv</code> beside this page; a row is named by its line there. The "
        "pointer over a mark shows its command, and a click leads to its row.</p>\n";
  }
  for (const TradeScene& scene : results.scenes) {
    html += "<h2>" + html_text(scene.file) + "</h2>\n" + PageOfCurves(results, scene, false).draw();
    if (scene.has_drawings) html += PageOfCurves(results, scene, true).draw();
  }
  return html + "<div id=\"shown\"></div>\n" + kScript + "</body></html>\n";
}

}  // namespace supple::tools

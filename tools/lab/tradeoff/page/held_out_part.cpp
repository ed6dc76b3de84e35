#include "tools/lab/tradeoff/page/held_out_part.h"

#include "tools/lab/tradeoff/held_out.h"
#include "tools/lab/tradeoff/page/page_text.h"

namespace supple::tools {

namespace {

std::string error_text(double error_mm) {
  return short_number(error_mm) + " mm";
}

std::string linked_to(std::size_t row, const std::string& text) {
  return "<a href=\"#" + row_id(row) + "\">" + text + "</a>";
}

std::string line_of(const TradeResults& results, const HeldOutChoice& choice) {
  const std::string asked =
      choice.is_budget ? "within " + time_text(choice.asked) : "error " + error_text(choice.asked);
  std::string html = "<tr><td>" + asked + "</td>";
  if (!choice.chosen)
    return html + "<td class=\"note\" colspan=\"8\">no method will do</td></tr>\n";
  html += "<td class=\"text\"><code>" + html_text(choice.chosen->method) + "</code></td><td>" +
          time_text(choice.chosen->solve_s) + "</td>";
  if (!choice.is_ok) {
    const TradeRow& row = results.rows[choice.row];
    return html + "<td class=\"note\" colspan=\"6\">not kept: " +
           linked_to(choice.row, html_text(row.status + ": " + row.reason)) + "</td></tr>\n";
  }
  const TradeRow& row = results.rows[choice.row];
  return html + "<td>" + linked_to(choice.row, time_text(row.solve_s.median)) + "</td><td>" +
         short_number(choice.time_ratio) + "</td><td>" + error_text(choice.chosen->error_mm) +
         "</td><td>" + linked_to(choice.row, error_text(row.p95_mm)) + "</td><td>" +
         short_number(choice.error_ratio) + "</td><td class=\"text\">" +
         (choice.is_kept ? "kept" : "<strong>not kept</strong>") + "</td></tr>\n";
}

}  // namespace

std::string held_out_part(const TradeResults& results) {
  const std::vector<HeldOutChoice> choices = check_held_out(results.rows, results.floor_mm());
  std::string html =
      "<h3>What choices from the other loads did here</h3>\n<p>Nothing was chosen by this load. " +
      summary_of(choices) +
      ": to be expected are the longest time and the largest error (p95) of the other loads, and a "
      "promise is kept where this load took at most 1.5 times as long and was at most 1.5 times "
      "as wrong. Errors below " +
      error_text(results.floor_mm()) +
      " count as that.</p>\n<div class=\"wide\"><table><tr><th>asked for</th><th>chosen</th>"
      "<th>time expected</th><th>here</th><th>ratio</th><th>error expected</th><th>here</th>"
      "<th>ratio</th><th>promise</th></tr>\n";
  for (const HeldOutChoice& choice : choices) html += line_of(results, choice);
  return html + "</table></div>\n";
}

}  // namespace supple::tools

#include "tools/lab/tradeoff/page/page_text.h"

#include <cstdio>

namespace supple::tools {

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string time_text(double seconds) {
  if (seconds < 1) return short_number(1000 * seconds) + " ms";
  return seconds < 60 ? short_number(seconds) + " s" : short_number(seconds / 60) + " min";
}

std::string spread_text(const Spread& spread) {
  return time_text(spread.median) + " (" + time_text(spread.least) + " to " +
         time_text(spread.most) + ')';
}

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
  if (row.is_drawing()) {
    return tip + "SSIM " + short_number(row.ssim) + ", RMSE " + short_number(row.rmse);
  }
  return tip + "error p50 " + short_number(row.p50_mm) + ", p95 " + short_number(row.p95_mm) +
         ", max " + short_number(row.max_mm) + " mm";
}

}  // namespace supple::tools

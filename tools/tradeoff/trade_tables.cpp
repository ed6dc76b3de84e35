#include "tools/tradeoff/trade_tables.h"

#include <algorithm>
#include <cmath>

namespace supple::tools {

namespace {

constexpr double kAlikePart = 0.02;

MethodCurve& curve_named(SceneCurves& curves, const TradeRow& row,
                         std::string (*title_of)(const std::string& method)) {
  for (MethodCurve& curve : curves.methods) {
    if (curve.method == row.method) return curve;
  }
  return curves.methods.emplace_back(MethodCurve{row.method, title_of(row.method), {}, {}});
}

bool are_alike(const TradeRow& a, const TradeRow& b, double floor_mm) {
  const bool overlap = a.solve_s.least <= b.solve_s.most && b.solve_s.least <= a.solve_s.most;
  const double apart = std::abs(a.p95_mm - b.p95_mm);
  return overlap && apart <= std::max(floor_mm, kAlikePart * std::max(a.p95_mm, b.p95_mm));
}

}  // namespace

std::string SceneCurves::alike_text(std::size_t row) const {
  std::string text;
  for (const auto& [a, b] : alike) {
    if (a != row && b != row) continue;
    text += (text.empty() ? "not distinguishable from row " : ", ") +
            std::to_string((a == row ? b : a) + 2);
  }
  return text;
}

SceneCurves curves_of(const std::vector<TradeRow>& rows, const std::string& scene, double floor_mm,
                      std::string (*title_of)(const std::string& method)) {
  SceneCurves curves;
  std::vector<TradePoint> all;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const TradeRow& row = rows[r];
    if (row.scene != scene) continue;
    curves.rows.push_back(r);
    if (curves.rows.size() == 1) {
      curves.reference = r;
      continue;
    }
    MethodCurve& curve = curve_named(curves, row, title_of);
    if (!row.is_ok()) {
      curve.missed.push_back(r);
      continue;
    }
    const TradePoint point{row.solve_s.median, row.p95_mm, r};
    curve.points.push_back(point);
    for (const TradePoint& other : all) {
      if (are_alike(rows[other.row], row, floor_mm)) curves.alike.emplace_back(other.row, r);
    }
    all.push_back({point.time_s, std::max(point.error_mm, floor_mm), r});
  }
  curves.front = pareto_front(std::move(all));
  return curves;
}

}  // namespace supple::tools

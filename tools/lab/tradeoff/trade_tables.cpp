#include "tools/lab/tradeoff/trade_tables.h"

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

bool are_alike(const TradeRow& a, const TradeRow& b, double floor) {
  const Spread &time_a = a.time_s(), &time_b = b.time_s();
  const bool overlap = time_a.least <= time_b.most && time_b.least <= time_a.most;
  const double apart = std::abs(a.error() - b.error());
  return overlap && apart <= std::max(floor, kAlikePart * std::max(a.error(), b.error()));
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

SceneCurves curves_of(const std::vector<TradeRow>& rows, const std::string& scene,
                      bool are_drawings, double floor,
                      std::string (*title_of)(const std::string& method)) {
  SceneCurves curves;
  curves.are_drawings = are_drawings;
  curves.floor = floor;
  std::vector<TradePoint> all;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const TradeRow& row = rows[r];
    if (row.scene != scene || row.is_drawing() != are_drawings) continue;
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
    const TradePoint point{row.time_s().median, row.error(), r};
    curve.points.push_back(point);
    for (const TradePoint& other : all) {
      if (are_alike(rows[other.row], row, floor)) curves.alike.emplace_back(other.row, r);
    }
    all.push_back({point.time_s, std::max(point.error, floor), r});
  }
  curves.front = pareto_front(std::move(all));
  return curves;
}

}  // namespace supple::tools

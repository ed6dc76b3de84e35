#include "tools/lab/tradeoff/trade_curves.h"

#include <algorithm>
#include <cmath>

namespace supple::tools {

std::vector<TradePoint> pareto_front(std::vector<TradePoint> points) {
  std::sort(points.begin(), points.end(), [](const TradePoint& a, const TradePoint& b) {
    return a.time_s != b.time_s ? a.time_s < b.time_s : a.error < b.error;
  });
  std::vector<TradePoint> front;
  for (const TradePoint& point : points) {
    if (front.empty() || point.error < front.back().error) front.push_back(point);
  }
  return front;
}

namespace {

/// y at x on the line from a to b in logarithms.
double log_line(double x, double xa, double xb, double ya, double yb) {
  const double part = std::log(x / xa) / std::log(xb / xa);
  return ya * std::pow(yb / ya, part);
}

std::vector<TradePoint> curve_of(std::vector<TradePoint> points, double floor) {
  for (TradePoint& point : points) point.error = std::max(point.error, floor);
  return pareto_front(std::move(points));
}

}  // namespace

std::optional<CurveValue> time_to_error(const std::vector<TradePoint>& points, double error,
                                        double floor) {
  const std::vector<TradePoint> curve = curve_of(points, floor);
  const auto reached = std::find_if(curve.begin(), curve.end(),
                                    [&](const TradePoint& point) { return point.error <= error; });
  if (reached == curve.end()) return std::nullopt;
  if (reached == curve.begin()) return CurveValue{reached->time_s, reached->row, reached->row};
  const TradePoint& before = *(reached - 1);
  return CurveValue{log_line(error, before.error, reached->error, before.time_s, reached->time_s),
                    before.row, reached->row};
}

std::optional<CurveValue> error_within_time(const std::vector<TradePoint>& points, double time_s,
                                            double floor) {
  const std::vector<TradePoint> curve = curve_of(points, floor);
  const auto later = std::find_if(curve.begin(), curve.end(),
                                  [&](const TradePoint& point) { return point.time_s > time_s; });
  if (later == curve.begin()) return std::nullopt;
  const TradePoint& before = *(later - 1);
  if (later == curve.end()) return CurveValue{before.error, before.row, before.row};
  return CurveValue{log_line(time_s, before.time_s, later->time_s, before.error, later->error),
                    before.row, later->row};
}

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

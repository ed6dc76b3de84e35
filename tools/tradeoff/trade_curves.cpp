#include "tools/tradeoff/trade_curves.h"

#include <algorithm>
#include <cmath>

namespace supple::tools {

std::vector<TradePoint> pareto_front(std::vector<TradePoint> points) {
  std::sort(points.begin(), points.end(), [](const TradePoint& a, const TradePoint& b) {
    return a.time_s != b.time_s ? a.time_s < b.time_s : a.error_mm < b.error_mm;
  });
  std::vector<TradePoint> front;
  for (const TradePoint& point : points) {
    if (front.empty() || point.error_mm < front.back().error_mm) front.push_back(point);
  }
  return front;
}

namespace {

/// y at x on the line from a to b in logarithms.
double log_line(double x, double xa, double xb, double ya, double yb) {
  const double part = std::log(x / xa) / std::log(xb / xa);
  return ya * std::pow(yb / ya, part);
}

std::vector<TradePoint> curve_of(std::vector<TradePoint> points, double floor_mm) {
  for (TradePoint& point : points) point.error_mm = std::max(point.error_mm, floor_mm);
  return pareto_front(std::move(points));
}

}  // namespace

std::optional<CurveValue> time_to_error(const std::vector<TradePoint>& points, double error_mm,
                                        double floor_mm) {
  const std::vector<TradePoint> curve = curve_of(points, floor_mm);
  const auto reached = std::find_if(curve.begin(), curve.end(), [&](const TradePoint& point) {
    return point.error_mm <= error_mm;
  });
  if (reached == curve.end()) return std::nullopt;
  if (reached == curve.begin()) return CurveValue{reached->time_s, reached->row, reached->row};
  const TradePoint& before = *(reached - 1);
  return CurveValue{
      log_line(error_mm, before.error_mm, reached->error_mm, before.time_s, reached->time_s),
      before.row, reached->row};
}

std::optional<CurveValue> error_within_time(const std::vector<TradePoint>& points, double time_s,
                                            double floor_mm) {
  const std::vector<TradePoint> curve = curve_of(points, floor_mm);
  const auto later = std::find_if(curve.begin(), curve.end(),
                                  [&](const TradePoint& point) { return point.time_s > time_s; });
  if (later == curve.begin()) return std::nullopt;
  const TradePoint& before = *(later - 1);
  if (later == curve.end()) return CurveValue{before.error_mm, before.row, before.row};
  return CurveValue{
      log_line(time_s, before.time_s, later->time_s, before.error_mm, later->error_mm), before.row,
      later->row};
}

}  // namespace supple::tools

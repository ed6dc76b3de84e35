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

}  // namespace supple::tools

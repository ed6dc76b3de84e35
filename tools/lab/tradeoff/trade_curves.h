// Curves through measured points, for charts and tables: fronts, and times and errors at values
// between the points. Pure functions of times in s and errors of any kind.
//
// Between two points a curve is a straight line in log time and log error, as a work-precision
// diagram draws it. A curve first loses the points that another one of its own beats in both, so
// that time grows and error falls along it.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace supple::tools {

struct TradePoint {
  double time_s = 0, error = 0;
  std::size_t row = 0;  // that it was measured as
};

/// The points that no other beats: none is faster and at most as wrong, or as fast and less wrong.
/// By ascending time.
std::vector<TradePoint> pareto_front(std::vector<TradePoint> points);

/// A value read off a curve, with the rows it lies between; the same one twice at a point.
struct CurveValue {
  double value = 0;
  std::size_t row_a = 0, row_b = 0;
};

/// The least time in which a method's points reach an error: that of a point where the fastest is
/// good enough. None where no point is. Errors below `floor` count as that.
std::optional<CurveValue> time_to_error(const std::vector<TradePoint>& points, double error,
                                        double floor);
/// The error that a method reaches within a time: that of the most exact point where it takes no
/// longer. None where the fastest takes longer.
std::optional<CurveValue> error_within_time(const std::vector<TradePoint>& points, double time_s,
                                            double floor);

}  // namespace supple::tools

// Curves through measured points, for charts and tables: fronts, and times and errors at values
// between the points. Pure functions of times in s and errors of any kind.
//
// Between two points a curve is a straight line in log time and log error, as a work-precision
// diagram draws it. A curve first loses the points that another one of its own beats in both, so
// that time grows and error falls along it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/scene/choice/trade_row.h"

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

// The rows of one scene as curves of methods, with their front and what cannot be told apart.

/// Columns of the tables of matched error and matched time.
inline const std::vector<double> kErrors_mm = {2, 1, 0.5, 0.1};
inline const std::vector<double> kErrorsOfPictures = {0.02, 0.01, 0.002};  // 1 - SSIM
inline const std::vector<double> kTimes_s = {0.016, 0.1, 1, 60};

struct MethodCurve {
  std::string method, title;
  std::vector<TradePoint> points;   // by ascending row
  std::vector<std::size_t> missed;  // rows that failed, took too long or were not run
};

struct SceneCurves {
  bool are_drawings = false;
  double floor = 0;  // of the errors
  std::size_t reference = 0;
  std::vector<std::size_t> rows;  // all of the scene
  std::vector<MethodCurve> methods;
  std::vector<TradePoint> front;
  /// Pairs whose times overlap and whose errors differ by less than 2 % or the floor.
  std::vector<std::pair<std::size_t, std::size_t>> alike;

  /// "not distinguishable from row 7, 9"; empty where there is none.
  std::string alike_text(std::size_t row) const;
};

/// `title_of`: of a method's name. The reference is the first of the rows, and no point.
SceneCurves curves_of(const std::vector<TradeRow>& rows, const std::string& scene,
                      bool are_drawings, double floor,
                      std::string (*title_of)(const std::string& method));

}  // namespace supple::tools

// The rows of one scene as curves of methods, with their front and what cannot be told apart.
#pragma once

#include <string>
#include <vector>

#include "tools/lab/tradeoff/trade_curves.h"
#include "tools/scene/choice/trade_row.h"

namespace supple::tools {

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

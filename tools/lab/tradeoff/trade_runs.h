// Scenes under many methods and drawings, compared with a reference each.
//
// Rows are written to DIR/runs.csv as they are complete. A later call goes on after them: rows of
// the same scene, volume, program and number of threads are not measured again.
#pragma once

#include <string>
#include <vector>

#include "tools/lab/tradeoff/scene_measurement.h"
#include "tools/lab/tradeoff/trade_curves.h"

namespace supple::tools {

struct TradeOptions {
  std::vector<std::string> scenes;
  std::string held_out;  // one more, which nothing is chosen by; empty: none
  std::vector<StepMethod> methods;
  std::vector<DrawMethod> drawings;  // of the first view that is drawn by rays
  MeasureOptions measure;
};

struct TradeScene {
  std::string file, name;  // as given; the name of its files
  std::string volume;      // as it was found
  /// Errors below are none: the steps in which places are stored, what the reference differs by
  /// from itself solved a hundred times less tightly, or how far it is from elements without size.
  double floor_mm = 0;
  /// That last one, by the elements of half a voxel (Richardson); 0 where they were not measured.
  double size_error_mm = 0;
  /// 1 - SSIM of the reference with itself drawn with steps twice as long.
  double floor_picture = 0;
  bool has_drawings = false;
  bool is_held_out = false;
};

struct TradeResults {
  std::string machine;
  std::vector<TradeScene> scenes;
  std::vector<TradeRow> rows;  // the reference of each scene is its first, that of drawings theirs

  /// The largest floor of all scenes.
  double floor_mm() const;
};

/// Points of one of the scenes as curves; without drawings none of them.
SceneCurves curves_of(const TradeResults& results, const TradeScene& scene, bool are_drawings);

/// Measures what DIR/runs.csv does not hold. Throws InputError as read_scene, and for files of two
/// scenes with one name; Error where a reference cannot be solved; Cancelled: complete rows are in
/// the file.
TradeResults run_tradeoff(const TradeOptions& options, Console& console);

}  // namespace supple::tools

// A measured setting: how long each phase took, how much memory, how wrong its result is, and the
// command that does it again. Rows are lines of a CSV file, from which all charts and tables come.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace supple::tools {

/// Spread of repeated measurements.
struct Spread {
  double least = 0, median = 0, most = 0;
};
/// Finds the spread; 0 for no values. The median of an even number is the mean of the middle two.
Spread spread_of(std::vector<double> values);

struct TradeRow {
  std::string scene;   // as the command line named it
  std::string inputs;  // what the row depends on beside its method: scene, volume, program
  std::string method;  // a name of method_families() or draw_families()
  double knob = 0;
  std::string status;         // "ok", "failed", "time limit" or "not run"
  std::string reason;         // unless ok
  int runs = 0, threads = 0;  // threads 0: all
  int held_out = 0;           // 1: nothing is chosen from it
  Spread prepare_s, solve_s, invert_s, render_s;
  Spread draw_s;  // inverse and rendering of one run
  Spread wall_s;
  double peak_mb = 0;
  /// Against the reference, over the elements that it moves.
  std::int64_t moved = 0;
  double p50_mm = 0, p95_mm = 0, max_mm = 0;
  double volume_percent = 0;  // change of the body's volume
  double energy_uj = 0;       // of the links' springs, the reference's material (docs/tradeoff.md)
  /// Errors of a drawing against the picture of the reference.
  double rmse = 0, ssim = 0;
  std::string warning;  // all of the last run
  std::string version, command;
  std::string picture;  // file of its first view in space; not in the CSV file, empty without

  bool is_ok() const { return status == "ok"; }
  bool is_drawing() const { return method.rfind("draw", 0) == 0; }
  /// The axes of its diagram: time of solving and p95 in mm; of a drawing, inverse and rendering,
  /// and 1 - SSIM.
  const Spread& time_s() const { return is_drawing() ? draw_s : solve_s; }
  double error() const { return is_drawing() ? 1 - ssim : p95_mm; }
  /// Name such as "relax-26:64".
  std::string name() const;
};

/// The first line, and one line per row. Numbers read back to the same bits.
std::string to_csv(const std::vector<TradeRow>& rows);
/// Throws InputError, with file and line, for other columns, a line of another length or a number
/// that is none.
std::vector<TradeRow> rows_from_csv(const std::string& text, const std::string& file);

}  // namespace supple::tools

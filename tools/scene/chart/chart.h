// Diagrams of curves as SVG: axes in even steps, in decades or of words. Those of trade-offs also
// have a front of all points drawn through, a floor, and at the edges what has no place in them.
#pragma once

#include <string>
#include <vector>

namespace supple::tools {

struct ChartPoint {
  double x = 0, x_least = 0, x_most = 0;  // of repeated measurements, with whiskers
  double y = 0;                           // below the floor: drawn on it, hollow
  std::string tip;                        // shown while the pointer is over it
  std::string link;                       // of the row that it comes from: "#row-7"
};

struct ChartCurve {
  std::string name;
  std::vector<ChartPoint> points;  // in the order in which they are joined
};

/// A run that was asked for and has no point: it stands at the right edge if it took too long, at
/// the top if it failed.
struct ChartMiss {
  std::size_t curve = 0;  // whose colour it has
  bool is_slow = false;
  std::string tip, link;
};

/// Steps of an axis. Values on one of words are the places in its list of words, from 0; values on
/// one of decades are above 0.
enum class AxisSteps { even, decades, words };

struct Chart {
  std::string x_name, y_name, floor_name;
  AxisSteps x_kind = AxisSteps::even, y_kind = AxisSteps::even;  // y: even or decades
  std::vector<std::string> x_words;
  std::string legend;  // over the names of the curves
  std::vector<ChartCurve> curves;
  std::vector<ChartMiss> misses;
  std::vector<ChartPoint> front;  // by ascending x
  double floor = 0;               // no y is told apart from it below; above 0, or there is none
};

/// An element `svg` for the page, which has its style; names and tips are escaped.
std::string to_svg(const Chart& chart);
/// The same as a file of its own, with its style and without links.
std::string to_svg_file(const Chart& chart);

}  // namespace supple::tools

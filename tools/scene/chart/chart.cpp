#include "tools/lab/tradeoff/page/trade_chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/lab/tradeoff/page/chart_style.h"
#include "tools/lab/tradeoff/page/chart_template.h"
#include "tools/lab/tradeoff/page/template.h"

namespace supple::tools {

namespace {

// The diagram within chart_template.svg.
constexpr double kLeft = 76, kRight = 554, kTop = 34, kBottom = 466;

/// Told apart by most eyes (Okabe and Ito 2008), then darker ones of other hues.
constexpr std::array<const char*, 16> kColours = {
    "#0072B2", "#56B4E9", "#D55E00", "#E69F00", "#CC79A7", "#009E73", "#7A5195", "#8C564B",
    "#5B8C00", "#B00020", "#222222", "#777777", "#00B3B3", "#E377C2", "#8C6D00", "#3B3BFF"};

/// One axis: decades that hold all values.
struct Axis {
  double lo, hi;      // powers of ten
  double begin, end;  // in the picture

  Axis(double least, double most, double from, double to)
      : lo(std::floor(std::log10(least))),
        hi(std::max(std::ceil(std::log10(most)), lo + 1)),
        begin(from),
        end(to) {}
  double place(double value) const {
    return begin + (std::log10(value) - lo) / (hi - lo) * (end - begin);
  }
  Value ticks() const {
    Value ticks = Value::List();
    for (double power = lo; power <= hi; ++power) {
      const double value = std::pow(10, power), at = place(value);
      ticks.push_back({{"at", at}, {"below", at + 4}, {"value", value}});
    }
    return ticks;
  }
};

/// The places of a chart's marks.
class ChartPlaces {
 public:
  explicit ChartPlaces(const LogChart& chart)
      : m_chart(chart), m_x(x_axis_of(chart)), m_y(y_axis_of(chart)) {}

  Value all() const {
    const double floor = m_y.place(m_chart.floor);
    Value values = {{"x_name", m_chart.x_name},         {"y_name", m_chart.y_name},
                    {"x_ticks", m_x.ticks()},           {"y_ticks", m_y.ticks()},
                    {"floor_name", m_chart.floor_name}, {"floor_y", floor},
                    {"floor_height", kBottom - floor},  {"above_floor", floor - 4},
                    {"front", way_of(m_chart.front)},   {"misses", misses()},
                    {"chart_style", kChartStyle}};
    Value& curves = values["curves"] = Value::List();
    for (std::size_t c = 0; c < m_chart.curves.size(); ++c) curves.push_back(curve(c));
    const int legend_end = int(kTop) + 6 + 19 * int(m_chart.curves.size());
    values["legend_end"] = legend_end;
    if (!m_chart.misses.empty()) values["legend_of_misses"] = legend_end + 19;
    return values;
  }

 private:
  static Axis x_axis_of(const LogChart& chart) {
    double least = 1e300, most = 0;
    for (const ChartCurve& curve : chart.curves) {
      for (const ChartPoint& point : curve.points) {
        least = std::min(least, point.x_least);
        most = std::max(most, point.x_most);
      }
    }
    if (most <= 0) least = most = 1;
    return {std::max(least, 1e-6), std::max(most, 1e-6), kLeft, kRight};
  }
  static Axis y_axis_of(const LogChart& chart) {
    double most = chart.floor;
    for (const ChartCurve& curve : chart.curves) {
      for (const ChartPoint& point : curve.points) most = std::max(most, point.y);
    }
    return {chart.floor, most * 1.05, kBottom, kTop};
  }

  double x_of(double x) const { return m_x.place(std::max(x, 1e-6)); }
  double y_of(const ChartPoint& point) const { return m_y.place(std::max(point.y, m_chart.floor)); }

  std::string way_of(const std::vector<ChartPoint>& points) const {
    Value places = Value::List();
    for (const ChartPoint& point : points) {
      places.push_back({{"x", x_of(point.x)}, {"y", y_of(point)}});
    }
    const std::string way = filled("{{#places}} L{{x}} {{y}}{{/places}}", {{"places", places}});
    return way.empty() ? way : "M" + way.substr(2);
  }

  Value curve(std::size_t c) const {
    const ChartCurve& curve = m_chart.curves[c];
    Value points = Value::List();
    for (const ChartPoint& point : curve.points) {
      points.push_back({{"x", x_of(point.x)},
                        {"x_least", x_of(point.x_least)},
                        {"x_most", x_of(point.x_most)},
                        {"y", y_of(point)},
                        {"is_below", point.y < m_chart.floor},
                        {"tip", point.tip},
                        {"link", point.link}});
    }
    return {{"number", c},
            {"name", curve.name},
            {"colour", kColours[c % kColours.size()]},
            {"way", way_of(curve.points)},
            {"points", points},
            {"legend_y", kTop + 6 + 19 * double(c)}};
  }

  /// Crosses, side by side along their edge.
  Value misses() const {
    Value crosses = Value::List();
    double slow = 0, failed = 0;
    for (const ChartMiss& miss : m_chart.misses) {
      crosses.push_back({{"x", miss.is_slow ? kRight + 8 : kLeft + 12 + 14 * failed++},
                         {"y", miss.is_slow ? kTop + 12 + 14 * slow++ : kTop - 10},
                         {"colour", kColours[miss.curve % kColours.size()]},
                         {"tip", miss.tip},
                         {"link", miss.link}});
    }
    return crosses;
  }

  const LogChart& m_chart;
  Axis m_x, m_y;
};

std::string drawn(const LogChart& chart, bool is_alone) {
  Value values = ChartPlaces(chart).all();
  values["is_alone"] = is_alone;
  return filled(kChartTemplate, values);
}

}  // namespace

std::string to_svg(const LogChart& chart) {
  return drawn(chart, false);
}

std::string to_svg_file(const LogChart& chart) {
  return drawn(chart, true);
}

}  // namespace supple::tools

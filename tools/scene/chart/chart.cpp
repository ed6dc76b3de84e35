#include "tools/scene/chart/chart.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/scene/chart/chart_style.h"
#include "tools/scene/chart/chart_template.h"
#include "tools/scene/chart/template.h"

namespace supple::tools {

namespace {

// The diagram within chart_template.svg.
constexpr double kLeft = 76, kRight = 554, kTop = 34, kBottom = 466;

/// Told apart by most eyes (Okabe and Ito 2008), then darker ones of other hues.
constexpr std::array<const char*, 16> kColours = {
    "#0072B2", "#56B4E9", "#D55E00", "#E69F00", "#CC79A7", "#009E73", "#7A5195", "#8C564B",
    "#5B8C00", "#B00020", "#222222", "#777777", "#00B3B3", "#E377C2", "#8C6D00", "#3B3BFF"};

struct Range {
  double least = 1e300, most = -1e300;

  void add(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  /// An empty range becomes one around a value.
  void fill(double value) {
    if (least > most) least = most = value;
  }
};

/// The largest of 1, 2 and 5 times a power of ten that parts a length into five steps or more.
double even_step(double length) {
  const double power = std::pow(10, std::floor(std::log10(length / 5)));
  for (const double times : {5, 2}) {
    if (times * power <= length / 5 * (1 + 1e-9)) return times * power;
  }
  return power;
}

/// One axis, which begins and ends on a tick unless it has words.
class Axis {
 public:
  Axis(AxisSteps kind, const Range& range, double begin, double end) : m_begin(begin), m_end(end) {
    if (kind == AxisSteps::decades) {
      m_is_log = true;
      m_lo = std::floor(std::log10(range.least));
      m_hi = std::max(std::ceil(std::log10(range.most)), m_lo + 1);
      for (double power = m_lo; power <= m_hi; ++power) add_tick(std::pow(10, power));
      return;
    }
    const double middle = std::abs(range.least + range.most) / 2;
    const double length = range.most - range.least;
    const bool is_flat = length <= 1e-12 * middle;
    const double around = is_flat ? (middle > 0 ? middle / 10 : 1) : 0;
    const double step = even_step(is_flat ? 2 * around : length);
    const double first = std::floor((range.least - around) / step + 1e-9);
    const double last = std::ceil((range.most + around) / step - 1e-9);
    m_lo = first * step;
    m_hi = last * step;
    for (double n = first; n <= last; ++n) add_tick(n * step);
  }
  Axis(const std::vector<std::string>& words, double begin, double end)
      : m_lo(-0.5), m_hi(double(words.size()) - 0.5), m_begin(begin), m_end(end) {
    for (std::size_t n = 0; n < words.size(); ++n) add_tick(double(n), words[n]);
  }

  double place(double value) const {
    const double at = m_is_log ? std::log10(value) : value;
    return m_begin + (at - m_lo) / (m_hi - m_lo) * (m_end - m_begin);
  }
  const Value& ticks() const { return m_ticks; }

 private:
  void add_tick(double value) { add_tick(value, value); }
  void add_tick(double value, const Value& text) {
    m_ticks.push_back({{"at", place(value)}, {"below", place(value) + 4}, {"value", text}});
  }

  bool m_is_log = false;
  double m_lo = 0, m_hi = 1;  // powers of ten on one of decades
  double m_begin, m_end;      // in the picture
  Value m_ticks = Value::List();
};

/// The places of a chart's marks.
class ChartPlaces {
 public:
  explicit ChartPlaces(const Chart& chart)
      : m_chart(chart), m_x(x_axis_of(chart)), m_y(y_axis_of(chart)) {}

  Value all() const {
    Value values = {{"x_name", m_chart.x_name}, {"y_name", m_chart.y_name},
                    {"x_ticks", m_x.ticks()},   {"y_ticks", m_y.ticks()},
                    {"legend", m_chart.legend}, {"front", way_of(m_chart.front)},
                    {"misses", misses()},       {"chart_style", kChartStyle}};
    if (has_floor()) {
      const double floor = m_y.place(m_chart.floor);
      values["floor"] = Value({{"name", m_chart.floor_name},
                               {"y", floor},
                               {"height", kBottom - floor},
                               {"above", floor - 4}});
    }
    Value& curves = values["curves"] = Value::List();
    for (std::size_t c = 0; c < m_chart.curves.size(); ++c) curves.push_back(curve(c));
    const int legend_end = int(kTop) + 6 + 19 * int(m_chart.curves.size());
    values["legend_end"] = legend_end;
    if (!m_chart.misses.empty()) values["legend_of_misses"] = legend_end + 19;
    return values;
  }

 private:
  static Axis x_axis_of(const Chart& chart) {
    if (chart.x_kind == AxisSteps::words) return {chart.x_words, kLeft, kRight};
    Range range;
    for (const ChartCurve& curve : chart.curves) {
      for (const ChartPoint& point : curve.points) {
        range.add(point.x_least);
        range.add(point.x_most);
      }
    }
    range.fill(1);
    return {chart.x_kind, range, kLeft, kRight};
  }
  static Axis y_axis_of(const Chart& chart) {
    Range range;
    if (chart.floor > 0) range.add(chart.floor);
    for (const ChartCurve& curve : chart.curves) {
      for (const ChartPoint& point : curve.points) range.add(std::max(point.y, least_y(chart)));
    }
    range.fill(1);
    if (chart.y_kind == AxisSteps::decades) range.most *= 1.05;
    return {chart.y_kind, range, kBottom, kTop};
  }
  static double least_y(const Chart& chart) { return chart.floor > 0 ? chart.floor : -1e300; }

  bool has_floor() const { return m_chart.floor > 0; }
  double y_of(const ChartPoint& point) const {
    return m_y.place(std::max(point.y, least_y(m_chart)));
  }

  std::string way_of(const std::vector<ChartPoint>& points) const {
    Value places = Value::List();
    for (const ChartPoint& point : points) {
      places.push_back({{"x", m_x.place(point.x)}, {"y", y_of(point)}});
    }
    const std::string way = filled("{{#places}} L{{x}} {{y}}{{/places}}", {{"places", places}});
    return way.empty() ? way : "M" + way.substr(2);
  }

  Value curve(std::size_t c) const {
    const ChartCurve& curve = m_chart.curves[c];
    Value points = Value::List();
    for (const ChartPoint& point : curve.points) {
      points.push_back({{"x", m_x.place(point.x)},
                        {"x_least", m_x.place(point.x_least)},
                        {"x_most", m_x.place(point.x_most)},
                        {"y", y_of(point)},
                        {"is_below", has_floor() && point.y < m_chart.floor},
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

  const Chart& m_chart;
  Axis m_x, m_y;
};

std::string drawn(const Chart& chart, bool is_alone) {
  Value values = ChartPlaces(chart).all();
  values["is_alone"] = is_alone;
  return filled(kChartTemplate, values);
}

}  // namespace

std::string to_svg(const Chart& chart) {
  return drawn(chart, false);
}

std::string to_svg_file(const Chart& chart) {
  return drawn(chart, true);
}

}  // namespace supple::tools

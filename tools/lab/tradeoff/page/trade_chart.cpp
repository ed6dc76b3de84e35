#include "tools/lab/tradeoff/page/trade_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tools/lab/tradeoff/page/page_parts.h"
#include "tools/lab/tradeoff/page/page_text.h"

namespace supple::tools {

namespace {

constexpr double kWidth = 780, kHeight = 520;
constexpr double kLeft = 76, kTop = 34, kRight = 226, kBottom = 54;  // margins; legend on the right

/// Told apart by most eyes (Okabe and Ito 2008), then darker ones of other hues.
constexpr std::array<const char*, 16> kColours = {
    "#0072B2", "#56B4E9", "#D55E00", "#E69F00", "#CC79A7", "#009E73", "#7A5195", "#8C564B",
    "#5B8C00", "#B00020", "#222222", "#777777", "#00B3B3", "#E377C2", "#8C6D00", "#3B3BFF"};

const char* colour_of(std::size_t curve) {
  return kColours[curve % kColours.size()];
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

/// One axis: decades that hold all values.
struct Axis {
  double lo = 0, hi = 1;      // powers of ten
  double begin = 0, end = 1;  // in the picture

  double place(double value) const {
    const double part = (std::log10(value) - lo) / (hi - lo);
    return begin + part * (end - begin);
  }
};

Axis axis_of(double least, double most, double begin, double end) {
  Axis axis{std::floor(std::log10(least)), std::ceil(std::log10(most)), begin, end};
  if (axis.hi <= axis.lo) axis.hi = axis.lo + 1;
  return axis;
}

class ChartDrawing {
 public:
  ChartDrawing(const LogChart& chart, bool is_alone) : m_chart(chart), m_is_alone(is_alone) {
    double x_least = 1e300, x_most = 0, y_most = chart.floor;
    for (const ChartCurve& curve : chart.curves) {
      for (const ChartPoint& point : curve.points) {
        x_least = std::min(x_least, point.x_least);
        x_most = std::max(x_most, point.x_most);
        y_most = std::max(y_most, point.y);
      }
    }
    if (x_most <= 0) x_least = x_most = 1;
    m_x = axis_of(std::max(x_least, 1e-6), std::max(x_most, 1e-6), kLeft, kWidth - kRight);
    m_y = axis_of(chart.floor, y_most * 1.05, kHeight - kBottom, kTop);
  }

  std::string draw() {
    begin();
    draw_grid();
    draw_floor();
    draw_front();
    for (std::size_t c = 0; c < m_chart.curves.size(); ++c) draw_curve(c);
    draw_misses();
    draw_legend();
    return m_svg + "</svg>\n";
  }

 private:
  void begin() {
    const std::string width = number(kWidth), height = number(kHeight);
    if (m_is_alone) {
      m_svg =
          "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
          "width=\"" +
          width + "\" height=\"" + height + "\" font-family=\"sans-serif\"";
    } else {
      m_svg = "<svg";
    }
    m_svg += " class=\"chart\" viewBox=\"0 0 " + width + ' ' + height +
             "\" role=\"img\" aria-label=\"" +
             html_text(m_chart.y_name + " against " + m_chart.x_name) + "\">\n";
    if (!m_is_alone) return;
    m_svg += kChartStyle;
    m_svg += "<rect width=\"" + width + "\" height=\"" + height + "\" fill=\"#fff\"/>\n";
  }
  std::string linked(const std::string& link, const std::string& element) const {
    if (m_is_alone) return element + '\n';
    return "<a href=\"" + html_text(link) + "\">" + element + "</a>\n";
  }

  double x_of(const ChartPoint& point) const { return m_x.place(std::max(point.x, 1e-6)); }
  double y_of(const ChartPoint& point) const { return m_y.place(std::max(point.y, m_chart.floor)); }

  void text(double x, double y, const std::string& words, const char* anchor,
            const std::string& more = "") {
    m_svg += "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + '"' +
             more + '>' + html_text(words) + "</text>\n";
  }
  void line(double x0, double y0, double x1, double y1, const std::string& look) {
    m_svg += line_text(x0, y0, x1, y1, look);
  }
  static std::string line_text(double x0, double y0, double x1, double y1,
                               const std::string& look) {
    return "<line x1=\"" + number(x0) + "\" y1=\"" + number(y0) + "\" x2=\"" + number(x1) +
           "\" y2=\"" + number(y1) + "\" " + look + "/>\n";
  }

  void draw_grid() {
    for (double power = m_x.lo; power <= m_x.hi; ++power) {
      const double value = std::pow(10, power), x = m_x.place(value);
      line(x, m_y.end, x, m_y.begin, "class=\"grid\"");
      text(x, m_y.begin + 18, number(value), "middle");
    }
    for (double power = m_y.lo; power <= m_y.hi; ++power) {
      const double value = std::pow(10, power), y = m_y.place(value);
      line(m_x.begin, y, m_x.end, y, "class=\"grid\"");
      text(m_x.begin - 8, y + 4, number(value), "end");
    }
    text((m_x.begin + m_x.end) / 2, kHeight - 12, m_chart.x_name, "middle", " class=\"name\"");
    const std::string turned =
        " class=\"name\" transform=\"rotate(-90 16 " + number((m_y.begin + m_y.end) / 2) + ")\"";
    text(16, (m_y.begin + m_y.end) / 2, m_chart.y_name, "middle", turned);
  }

  void draw_floor() {
    const double y = m_y.place(m_chart.floor);
    m_svg += "<rect class=\"floor\" x=\"" + number(m_x.begin) + "\" y=\"" + number(y) +
             "\" width=\"" + number(m_x.end - m_x.begin) + "\" height=\"" + number(m_y.begin - y) +
             "\"/>\n";
    text(m_x.end - 4, y - 4, m_chart.floor_name, "end", " class=\"small\"");
  }

  std::string way_of(const std::vector<ChartPoint>& points) const {
    std::string way;
    for (const ChartPoint& point : points) {
      way += (way.empty() ? "M" : " L") + number(x_of(point)) + ' ' + number(y_of(point));
    }
    return way;
  }

  void draw_front() { m_svg += "<path class=\"front\" d=\"" + way_of(m_chart.front) + "\"/>\n"; }

  void draw_curve(std::size_t c) {
    const ChartCurve& curve = m_chart.curves[c];
    const std::string colour = colour_of(c);
    m_svg += "<g class=\"curve\" data-curve=\"" + std::to_string(c) + "\" style=\"color:" + colour +
             "\">\n<path class=\"way\" d=\"" + way_of(curve.points) + "\"/>\n";
    for (const ChartPoint& point : curve.points) {
      const double y = y_of(point);
      line(m_x.place(std::max(point.x_least, 1e-6)), y, m_x.place(std::max(point.x_most, 1e-6)), y,
           "class=\"whisker\"");
      const bool is_below = point.y < m_chart.floor;
      m_svg += linked(point.link,
                      std::string("<circle class=\"") + (is_below ? "point hollow" : "point") +
                          "\" cx=\"" + number(x_of(point)) + "\" cy=\"" + number(y) +
                          "\" r=\"4.5\"><title>" + html_text(point.tip) + "</title></circle>");
    }
    m_svg += "</g>\n";
  }

  /// Crosses, side by side along their edge.
  void draw_misses() {
    double slow = 0, failed = 0;
    for (const ChartMiss& miss : m_chart.misses) {
      const double x = miss.is_slow ? m_x.end + 8 : m_x.begin + 12 + 14 * failed++;
      const double y = miss.is_slow ? m_y.end + 12 + 14 * slow++ : m_y.end - 10;
      const std::string cross =
          line_text(x - 4, y - 4, x + 4, y + 4, "") + line_text(x - 4, y + 4, x + 4, y - 4, "");
      m_svg += linked(miss.link, std::string("<g class=\"miss\" style=\"color:") +
                                     colour_of(miss.curve) + "\"><title>" + html_text(miss.tip) +
                                     "</title>" + cross + "<rect x=\"" + number(x - 6) + "\" y=\"" +
                                     number(y - 6) +
                                     "\" width=\"12\" height=\"12\" class=\"touch\"/></g>");
    }
  }

  void draw_legend() {
    double y = kTop + 6;
    const double x = kWidth - kRight + 26;
    for (std::size_t c = 0; c < m_chart.curves.size(); ++c, y += 19) {
      m_svg += "<g class=\"entry\" data-curve=\"" + std::to_string(c) +
               "\" style=\"color:" + std::string(colour_of(c)) +
               "\"><circle class=\"point\" cx=\"" + number(x) + "\" cy=\"" + number(y - 4) +
               "\" r=\"4.5\"/>";
      text(x + 12, y, m_chart.curves[c].name, "start");
      m_svg += "</g>\n";
    }
    line(x - 6, y - 4, x + 6, y - 4, "class=\"front\"");
    text(x + 12, y, "front: no other beats it", "start");
    if (m_chart.misses.empty()) return;
    y += 19;
    m_svg += "<g class=\"miss\" style=\"color:#555\">";
    line(x - 4, y - 8, x + 4, y, "");
    line(x - 4, y, x + 4, y - 8, "");
    m_svg += "</g>";
    text(x + 12, y, "top: failed; right: too slow", "start");
  }

  const LogChart& m_chart;
  bool m_is_alone;
  Axis m_x, m_y;
  std::string m_svg;
};

}  // namespace

std::string to_svg(const LogChart& chart) {
  return ChartDrawing(chart, false).draw();
}

std::string to_svg_file(const LogChart& chart) {
  return ChartDrawing(chart, true).draw();
}

}  // namespace supple::tools

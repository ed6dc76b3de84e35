#include "tools/lab/tradeoff/page/scene_charts.h"

#include "tools/lab/tradeoff/page/page_text.h"

namespace supple::tools {

namespace {

ChartPoint chart_point(const TradeResults& results, std::size_t r) {
  const TradeRow& row = results.rows[r];
  const Spread& time = row.time_s();
  return {time.median, time.least, time.most, row.error(), tip_of(row), '#' + row_id(r)};
}

}  // namespace

LogChart chart_of(const TradeResults& results, const SceneCurves& curves) {
  LogChart chart;
  chart.x_name = curves.are_drawings ? "time of inverse and rendering, s" : "time of solving, s";
  chart.y_name = curves.are_drawings ? "1 - SSIM" : "error p95, mm";
  chart.floor_name = "floor of the reference";
  chart.floor = curves.floor;
  for (const MethodCurve& curve : curves.methods) {
    ChartCurve drawn{curve.title, {}};
    for (const TradePoint& point : curve.points) {
      drawn.points.push_back(chart_point(results, point.row));
    }
    for (const std::size_t r : curve.missed) {
      const TradeRow& row = results.rows[r];
      chart.misses.push_back(
          {chart.curves.size(), row.status != "failed", tip_of(row), '#' + row_id(r)});
    }
    chart.curves.push_back(std::move(drawn));
  }
  for (const TradePoint& point : curves.front) {
    chart.front.push_back(chart_point(results, point.row));
  }
  return chart;
}

std::vector<ChartFile> chart_files(const TradeResults& results) {
  std::vector<ChartFile> files;
  const auto add = [&](const TradeScene& scene, const char* name, bool are_drawings) {
    const SceneCurves curves = curves_of(results, scene, are_drawings);
    files.push_back({name + scene.name + ".svg", to_svg_file(chart_of(results, curves))});
  };
  for (const TradeScene& scene : results.scenes) {
    add(scene, "error_time_", false);
    if (scene.has_drawings) add(scene, "likeness_time_", true);
  }
  return files;
}

}  // namespace supple::tools

#include <nlohmann/json.hpp>

#include "tools/lab/tradeoff/held_out.h"
#include "tools/lab/tradeoff/page/trade_page.h"

namespace supple::tools {

namespace {

nlohmann::ordered_json spread_json(const Spread& spread) {
  return {{"min", spread.least}, {"median", spread.median}, {"max", spread.most}};
}

nlohmann::ordered_json row_json(const TradeRow& row) {
  nlohmann::ordered_json json = {{"scene", row.scene},     {"method", row.method},
                                 {"knob", row.knob},       {"status", row.status},
                                 {"command", row.command}, {"version", row.version}};
  if (!row.reason.empty()) json["reason"] = row.reason;
  if (!row.warning.empty()) json["warning"] = row.warning;
  if (row.held_out != 0) json["held_out"] = true;
  if (!row.is_ok()) return json;
  json["runs"] = row.runs;
  json["prepare_s"] = spread_json(row.prepare_s);
  json["solve_s"] = spread_json(row.solve_s);
  json["invert_s"] = spread_json(row.invert_s);
  json["render_s"] = spread_json(row.render_s);
  json["wall_s"] = spread_json(row.wall_s);
  json["peak_mb"] = row.peak_mb;
  if (row.is_drawing()) {
    json["draw_s"] = spread_json(row.draw_s);
    json["rmse"] = row.rmse;
    json["ssim"] = row.ssim;
    return json;
  }
  json["moved"] = row.moved;
  json["error_p50_mm"] = row.p50_mm;
  json["error_p95_mm"] = row.p95_mm;
  json["error_max_mm"] = row.max_mm;
  json["volume_percent"] = row.volume_percent;
  json["energy_uj"] = row.energy_uj;
  return json;
}

/// One table: per method a value or null for each of `values`.
template <class Read>
nlohmann::ordered_json matched_json(const SceneCurves& curves, const std::vector<double>& values,
                                    const Read& read) {
  nlohmann::ordered_json table;
  for (const MethodCurve& curve : curves.methods) {
    nlohmann::ordered_json& line = table[curve.method] = nlohmann::ordered_json::array();
    for (const double value : values) {
      const auto found = read(curve.points, value, curves.floor);
      if (found) {
        line.push_back({{"value", found->value}, {"rows", {found->row_a, found->row_b}}});
      } else {
        line.push_back(nullptr);
      }
    }
  }
  return table;
}

/// Writes curves without tables where the load is held out.
nlohmann::ordered_json curves_json(const TradeResults& results, const SceneCurves& curves,
                                   bool is_held_out) {
  const std::vector<double>& errors = curves.are_drawings ? kErrorsOfPictures : kErrors_mm;
  nlohmann::ordered_json json = {{"reference", results.rows[curves.reference].name()},
                                 {"floor", curves.floor}};
  json["front"] = nlohmann::ordered_json::array();
  for (const TradePoint& point : curves.front) json["front"].push_back(point.row);
  if (is_held_out) return json;
  json["errors"] = errors;
  json["time_to_error_s"] = matched_json(curves, errors, time_to_error);
  json["times_s"] = kTimes_s;
  json["error_within_time"] = matched_json(curves, kTimes_s, error_within_time);
  return json;
}

nlohmann::ordered_json scene_json(const TradeResults& results, const TradeScene& scene) {
  nlohmann::ordered_json json = {{"scene", scene.file}, {"volume", scene.volume}};
  json["size_error_mm"] = scene.size_error_mm;
  if (scene.is_held_out) json["held_out"] = true;
  const auto curves = [&](bool are_drawings) {
    return curves_json(results, curves_of(results, scene, are_drawings), scene.is_held_out);
  };
  json["solving"] = curves(false);
  if (scene.has_drawings) json["drawing"] = curves(true);
  return json;
}

nlohmann::ordered_json choice_json(const TradeResults& results, const HeldOutChoice& choice) {
  nlohmann::ordered_json json = {{choice.is_budget ? "budget_s" : "error_p95_mm", choice.asked}};
  if (!choice.chosen) {
    json["method"] = nullptr;
    return json;
  }
  json["method"] = choice.chosen->method;
  json["expected"] = {{"solve_s", choice.chosen->solve_s},
                      {"error_p95_mm", choice.chosen->error_mm}};
  json["row"] = choice.row;
  if (choice.is_ok) {
    const TradeRow& row = results.rows[choice.row];
    json["held_out"] = {{"solve_s", row.solve_s.median}, {"error_p95_mm", row.p95_mm}};
    json["time_ratio"] = choice.time_ratio;
    json["error_ratio"] = choice.error_ratio;
  }
  json["kept"] = choice.is_kept;
  return json;
}

nlohmann::ordered_json held_out_json(const TradeResults& results, const TradeScene& scene) {
  const std::vector<HeldOutChoice> choices = check_held_out(results.rows, results.floor_mm());
  nlohmann::ordered_json json = {
      {"scene", scene.file}, {"factor", kKeptFactor}, {"summary", summary_of(choices)}};
  for (const HeldOutChoice& choice : choices) {
    json["choices"].push_back(choice_json(results, choice));
  }
  return json;
}

}  // namespace

nlohmann::ordered_json to_json(const TradeResults& results) {
  nlohmann::ordered_json json;
  json["machine"] = results.machine;
  json["scenes"] = nlohmann::ordered_json::array();
  for (const TradeScene& scene : results.scenes) {
    json["scenes"].push_back(scene_json(results, scene));
  }
  for (const TradeScene& scene : results.scenes) {
    if (scene.is_held_out) json["held_out"] = held_out_json(results, scene);
  }
  json["rows"] = nlohmann::ordered_json::array();
  for (const TradeRow& row : results.rows) json["rows"].push_back(row_json(row));
  return json;
}

}  // namespace supple::tools

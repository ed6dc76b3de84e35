#include "tools/lab/bench/elastic/relax_plan.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "tools/lab/bench/report/report.h"

namespace supple::tools {

namespace {

constexpr RelaxMethod kMethods[] = {RelaxMethod::plain, RelaxMethod::jacobi, RelaxMethod::red_black,
                                    RelaxMethod::accelerated};

}  // namespace

std::string RelaxRow::group() const {
  return kind + "/" + field + (size == 0 ? "" : "/" + std::to_string(size));
}

std::string RelaxRow::name() const {
  if (kind == "tighten") return group() + "/" + std::to_string(count);
  std::string text = group() + "/" + name_of(method);
  if (is_of_volume()) text += "/" + std::to_string(int(volume_kpa));
  if (kind == "links") text += "/links" + std::to_string(links);
  if (kind == "cost" || kind == "volume" || kind == "links") text += "/" + std::to_string(threads);
  return text;
}

std::vector<RelaxRow> plan_relax(const RelaxPlanOptions& options) {
  const int cores = int(std::thread::hardware_concurrency());
  const int several = options.threads > 0 ? options.threads : std::min(2, std::max(1, cores));
  const bool quick = options.quick;
  std::vector<RelaxRow> plan;
  const auto add_on_threads = [&](RelaxRow row) {
    plan.push_back(row);
    row.threads = several;
    if (several > 1) plan.push_back(row);
  };
  const auto add_methods = [&](const std::string& kind, const std::string& field, int size,
                               int count) {
    for (const RelaxMethod method : kMethods) {
      const RelaxRow row{kind, field, size, method, 0, 1, count};
      if (kind == "cost") {
        add_on_threads(row);
      } else {
        plan.push_back(row);
        plan.back().threads = several;
      }
    }
  };
  add_methods("cost", "noise", 128, 4);
  add_methods("cost", "head_phantom", 128, 4);
  if (!quick) add_methods("cost", "noise", 256, 2);
  for (const char* field : {"smooth", "noise"}) {
    for (const RelaxMethod method : {RelaxMethod::jacobi, RelaxMethod::accelerated}) {
      for (const int links : {6, 18, 26}) {
        add_on_threads({"links", field, quick ? 64 : 128, method, 0, 1, 4, links});
      }
    }
  }
  for (const int size : {64, 128}) {
    if (quick && size > 64) continue;
    for (const double kpa : {0.0, 100.0}) {
      add_on_threads({"volume", "noise", size, RelaxMethod::accelerated, kpa, 1, 4});
    }
  }
  const int most = quick ? 100 : 1000;
  for (const double kpa : {0.0, 10.0, 100.0, 1000.0}) {
    plan.push_back({"press", "ball", 24, RelaxMethod::accelerated, kpa, several, most});
  }
  for (const double kpa : {0.0, 100.0}) {
    plan.push_back({"press", "tissue_ball", 24, RelaxMethod::accelerated, kpa, several, most});
  }
  for (const double kpa : {0.0, 100.0}) {
    plan.push_back({"pull", "tissue_bar", 48, RelaxMethod::accelerated, kpa, several, most});
  }
  for (const auto& [field, size] :
       {std::pair{"ball", 24}, std::pair{"tissue_ball", 24}, std::pair{"tissue_bar", 48}}) {
    for (const int passes : {0, 100}) {
      plan.push_back({"tighten", field, size, RelaxMethod::accelerated, 0, several, passes});
    }
  }
  for (const char* field : {"noise", "ct"}) add_methods("states", field, quick ? 32 : 64, 100);
  if (options.has_ct_head) add_methods("states", "ct_head", 0, quick ? 1 : 100);
  add_methods("descent", "head_phantom", quick ? 64 : 128, quick ? 1000 : 8000);

  const auto is_left_out = [&](const RelaxRow& row) {
    return !is_wanted_row(options.only, row.name());
  };
  plan.erase(std::remove_if(plan.begin(), plan.end(), is_left_out), plan.end());
  return plan;
}

}  // namespace supple::tools

#include "tools/bench/bench_render.h"

#include <algorithm>
#include <memory>
#include <thread>

#include "tools/bench/render_frames.h"
#include "tools/bench/render_kernel.h"
#include "tools/bench/row_filter.h"
#include "tools/command.h"

namespace supple::tools {

namespace {

const Vec3i kHeadSize(512, 512, 256);

/// What is left of both kinds of rows; frames in groups of one kind of deformation.
struct Plan {
  std::vector<KernelSide> kernel;
  std::vector<std::vector<FrameSide>> frames;
};

std::vector<FrameSide> frame_sides(const std::string& kind, int threads) {
  std::vector<FrameSide> sides = {{kind, "default", 1}};
  if (threads > 1) sides.push_back({kind, "default", threads});
  if (kind == "straight" || kind == "local" || kind == "extreme") {
    sides.push_back({kind, "draft", 1});
    sides.push_back({kind, "accurate", 1});
  }
  return sides;
}

template <class Side, class NameOf>
std::vector<Side> wanted(std::vector<Side> sides, const RenderBenchOptions& options,
                         NameOf name_of) {
  const auto is_left_out = [&](const Side& side) {
    return !is_wanted_row(options.only, name_of(side));
  };
  sides.erase(std::remove_if(sides.begin(), sides.end(), is_left_out), sides.end());
  return sides;
}

Plan plan_render(const RenderBenchOptions& options) {
  int threads = options.threads;
  if (threads == 0) threads = std::min(2, int(std::thread::hardware_concurrency()));
  Plan plan;
  plan.kernel = wanted(kernel_sides(), options, kernel_row_name);
  for (const std::string kind : {"straight", "identity", "zero", "local", "extreme"}) {
    auto sides = wanted(frame_sides(kind, threads), options, frame_row_name);
    if (!sides.empty()) plan.frames.push_back(std::move(sides));
  }
  if (plan.kernel.empty() && plan.frames.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as frame/local/default/1"}));
  }
  return plan;
}

}  // namespace

std::vector<std::string> render_row_names(const RenderBenchOptions& options) {
  const Plan plan = plan_render(options);
  std::vector<std::string> names;
  for (const KernelSide& side : plan.kernel) names.push_back(kernel_row_name(side));
  for (const auto& sides : plan.frames) {
    for (const FrameSide& side : sides) names.push_back(frame_row_name(side));
  }
  return names;
}

BenchReport bench_render(const RenderBenchOptions& options, Console& console) {
  const Plan plan = plan_render(options);
  BenchReport result{"render", measure_machine(), {}};
  const auto stop_if_cancelled = [&] {
    if (console.cancelled()) throw Cancelled();
  };
  const auto add = [&](std::vector<BenchRow> rows) {
    for (BenchRow& row : rows) result.rows.push_back(std::move(row));
  };
  if (!plan.kernel.empty()) {
    console.stage("kernel");
    const RoundLimits limits = options.quick ? RoundLimits{3, 5, 0} : RoundLimits{7, 25, 10000};
    add(measure_kernel(plan.kernel, limits, stop_if_cancelled));
  }
  if (plan.frames.empty()) return result;
  console.stage("head phantom");
  FrameBench frames(kHeadSize, options.quick ? 512 : 1024);
  const RoundLimits limits = options.quick ? RoundLimits{3, 5, 600} : RoundLimits{5, 15, 6000};
  for (const auto& sides : plan.frames) {
    console.stage(sides.front().kind);
    add(frames.measure(sides, limits, stop_if_cancelled));
  }
  return result;
}

}  // namespace supple::tools

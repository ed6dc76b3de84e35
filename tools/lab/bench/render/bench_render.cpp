// `supple bench render`: samples and frames of the free-sampling marcher, beside other libraries'
// samplers and beside its own straight frame (design.md sections 5 and 9).
#include <algorithm>
#include <functional>
#include <memory>
#include <thread>

#include "tools/console/command.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/render/render_cut.h"
#include "tools/lab/bench/render/render_extension.h"
#include "tools/lab/bench/render/render_frames.h"
#include "tools/lab/bench/render/render_kernel.h"
#include "tools/lab/bench/render/render_show.h"
#include "tools/lab/bench/render/render_update.h"
#include "tools/lab/bench/render/render_vtk.h"
#include "tools/lab/bench/report/report.h"

namespace supple::tools {

namespace {

const Vec3i kHeadSize(512, 512, 256), kCutSize(256, 256, 128);
constexpr std::int64_t kDraggedByRender = 900'000;

using BeforeRun = std::function<void()>;

/// Rows that are measured together.
struct Part {
  std::string stage;
  std::vector<std::string> names;
  std::function<std::vector<BenchRow>(Console&, const BeforeRun&)> measure;
};

/// The head of the frames, made when the first of them is due.
class LazyFrames {
 public:
  explicit LazyFrames(int image_size) : m_image_size(image_size) {}
  FrameBench& get(Console& console) {
    if (!m_frames) {
      console.stage("head phantom");
      m_frames = std::make_unique<FrameBench>(kHeadSize, m_image_size);
    }
    return *m_frames;
  }

 private:
  int m_image_size;
  std::unique_ptr<FrameBench> m_frames;
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

/// Adds what is left of the sides as one part, when there are any.
template <class Side, class NameOf, class Measure>
void add_part(std::vector<Part>& plan, const BenchOptions& options, const std::string& stage,
              const std::vector<Side>& sides, NameOf name_of, Measure measure) {
  Part part{stage, {}, nullptr};
  std::vector<Side> wanted;
  for (const Side& side : sides) {
    if (!is_wanted_row(options.only, name_of(side))) continue;
    wanted.push_back(side);
    part.names.push_back(name_of(side));
  }
  if (wanted.empty()) return;
  part.measure = [=](Console& console, const BeforeRun& before_run) {
    return measure(wanted, console, before_run);
  };
  plan.push_back(std::move(part));
}

std::vector<Part> plan_render(const BenchOptions& options) {
  int threads = options.threads;
  if (threads == 0) threads = std::min(2, int(std::thread::hardware_concurrency()));
  const auto limits = [quick = options.quick](RoundLimits of_quick, RoundLimits of_full) {
    return quick ? of_quick : of_full;
  };
  std::vector<Part> plan;
  if (!options.quick) {
    // Before any volume is held: the memory of other programs could not be told.
    add_part(plan, options, "deform, then show", show_sides(threads), show_row_name,
             [](const auto& sides, Console& console, const BeforeRun& before_run) {
               return measure_show(sides, {5, 9, 30000}, console, before_run);
             });
    add_part(plan, options, "ray casters", straight_sides(threads), straight_row_name,
             [](const auto& sides, Console& console, const BeforeRun& before_run) {
               return measure_straight(sides, {7, 9, 20000}, console, before_run);
             });
  }
  add_part(plan, options, "kernel", kernel_sides(), kernel_row_name,
           [rounds = limits({3, 5, 0}, {7, 25, 10000})](const auto& sides, Console&,
                                                        const BeforeRun& before_run) {
             return measure_kernel(sides, rounds, before_run);
           });
  add_part(
      plan, options, "dragged head", update_sides(threads), update_row_name,
      [events = options.quick ? 5 : 30](const auto& sides, Console& console, const BeforeRun&) {
        return measure_render_update(kHeadSize, 512, kDraggedByRender, sides, events, console);
      });
  const auto frames = std::make_shared<LazyFrames>(options.quick ? 512 : 1024);
  for (const std::string kind : {"straight", "identity", "zero", "local", "extreme", "half"}) {
    add_part(plan, options, kind, frame_sides(kind, threads), frame_row_name,
             [frames, rounds = limits({3, 5, 600}, {5, 15, 6000})](
                 const auto& sides, Console& console, const BeforeRun& before_run) {
               FrameBench& bench = frames->get(console);
               console.stage(sides.front().kind);
               return bench.measure(sides, rounds, before_run);
             });
  }
  add_part(plan, options, "cut", cut_sides(), cut_row_name,
           [image = options.quick ? 512 : 800, rounds = limits({3, 5, 600}, {7, 15, 6000})](
               const auto& sides, Console&, const BeforeRun& before_run) {
             return measure_cut(kCutSize, image, sides, rounds, before_run);
           });
  add_part(plan, options, "extension", extension_sides(options.quick), extension_row_name,
           [rounds = limits({1, 1, 0}, {5, 5, 0})](const auto& sides, Console&,
                                                   const BeforeRun& before_run) {
             return measure_extension(sides, rounds, before_run);
           });
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as frame/local/default/1"}));
  }
  return plan;
}

}  // namespace

std::vector<std::string> render_row_names(const BenchOptions& options, Console&) {
  std::vector<std::string> names;
  for (const Part& part : plan_render(options)) {
    names.insert(names.end(), part.names.begin(), part.names.end());
  }
  return names;
}

BenchReport bench_render(const BenchOptions& options, Console& console) {
  const std::vector<Part> plan = plan_render(options);
  BenchReport result{"render", measure_machine(), {}};
  const BeforeRun stop_if_cancelled = [&] {
    if (console.cancelled()) throw Cancelled();
  };
  for (const Part& part : plan) {
    console.stage(part.stage);
    for (BenchRow& row : part.measure(console, stop_if_cancelled)) {
      result.rows.push_back(std::move(row));
    }
  }
  return result;
}

}  // namespace supple::tools

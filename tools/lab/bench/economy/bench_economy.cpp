// `supple bench economy`: what a fixed local drag costs while the volume grows around it
// (docs/economy.md).
#include <algorithm>
#include <optional>
#include <thread>

#include "lib/material/material.h"
#include "lib/session/session.h"
#include "lib/state/state_outputs.h"
#include "raycast/render.h"
#include "tools/console/command.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/report/memory.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"
#include "tools/scene/peers/peer_process.h"
#include "volumes/base/parallel.h"
#include "volumes/base/units.h"
#include "volumes/io/volume_writer.h"

namespace supple::tools {

namespace {

constexpr int kRadius = 24, kPictureSize = 256;
constexpr int kAirVoxels = 2;  // at the faces of the box
const char* const kTissue =
    "domain = [0, 1000]\nactive = [1, 1000]\nmax_length = [[0, 1.2]]\nmin_length = [[0, 0.8]]\n"
    "shear = [[0, 0.3]]\n";

struct EconomyRow {
  std::string around;  // air or tissue
  int size;

  std::string name() const { return around + "/" + std::to_string(size); }
};

std::vector<EconomyRow> plan_economy(const BenchOptions& options) {
  std::vector<EconomyRow> plan;
  for (const char* around : {"air", "tissue"}) {
    for (const int size : {64, 128, 256}) {
      if (options.quick && size > 128) continue;
      plan.push_back({around, size});
    }
  }
  const auto is_left_out = [&](const EconomyRow& row) {
    return !is_wanted_row(options.only, row.name());
  };
  plan.erase(std::remove_if(plan.begin(), plan.end(), is_left_out), plan.end());
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as tissue/256"}));
  }
  return plan;
}

void write_body(const std::string& path, const EconomyRow& row) {
  const int size = row.size, middle = size / 2;
  const Geometry geometry{
      Vec3i(size), Vec3d(-0.5 * (size - 1)), {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}}};
  const auto is_inside = [&](int at) { return at >= kAirVoxels && at < size - kAirVoxels; };
  write_volume(path, geometry, ValueType::int16, [&](int k, float* out) {
    for (int j = 0; j < size; ++j) {
      for (int i = 0; i < size; ++i) {
        const Vec3i d = Vec3i(i, j, k) - Vec3i(middle);
        const bool fills = row.around == "tissue" && is_inside(i) && is_inside(j) && is_inside(k);
        *out++ = d.dot(d) < kRadius * kRadius ? 300.0F : fills ? 100.0F : 0.0F;
      }
    }
  });
}

TransferFunction ball_look() {
  TransferFunction look;
  look.opacity = {{0, 0}, {150, 0}, {250, 0.9}};
  look.colour = {{0, {1, 0.9, 0.8}}, {1000, {1, 0.95, 0.9}}};
  return look;
}

/// Adds the processor time and the most memory of a stage, above that before it.
template <class Action>
void measure_stage(BenchRow& row, const std::string& stage, const Action& action) {
  const PeakMemory peak;
  row[stage + "_ms"] = cpu_time_ms(action);
  const auto growth = peak.growth();
  if (growth) row[stage + "_mb"] = double(*growth) / kMegabyte;
}

BenchRow measure_economy(const EconomyRow& row, const ScratchFolder& folder) {
  const std::string path = folder / "body.nrrd";
  write_body(path, row);
  SessionOptions options;
  options.material = parse_material(kTissue, "economy");
  BenchRow result = {{"case", "drag"}, {"around", row.around}, {"size", row.size}};
  const PeakMemory whole;
  std::optional<Session> session;
  session.emplace(path, options);
  State state = session->state();
  result["source_mb"] = double(state.density.bytes() + session->body().bytes()) / kMegabyte;
  measure_stage(result, "solve", [&] { session->drag(Vec3i(row.size / 2), {0, 5, 0}); });
  state = session->state();
  Pose pose;
  measure_stage(result, "displacement",
                [&] { pose.displacement = extended_displacement_of(state); });
  measure_stage(result, "inverse",
                [&] { pose.offsets = invert_displacement(state, pose.displacement); });
  std::optional<Renderer> renderer;
  measure_stage(result, "bricks", [&] { renderer.emplace(state.geometry, state.density); });
  measure_stage(result, "picture", [&] {
    renderer->set_offsets(&pose.offsets);
    Camera camera;
    camera.position_lps_mm = {0, -400, 0};
    camera.vertical_fov_degrees = 10;
    RenderSettings settings;
    settings.width = settings.height = kPictureSize;
    renderer->render_float(camera, ball_look(), settings);
  });
  renderer.reset();
  measure_stage(result, "warp", [&] {
    WarpOutput output;
    output.path = folder / "warp.vdb";
    output.grid = state.geometry;
    write_state_warp(output, state, pose, nullptr);
  });
  result["displacement_bricks"] = pose.displacement.u.vectors.stored_bricks();
  result["offset_bricks"] = pose.offsets.o.vectors.stored_bricks();
  result["bricks"] = state.density.bricks().brick_count();
  return result;
}

}  // namespace

std::vector<std::string> economy_row_names(const BenchOptions& options, Console&) {
  std::vector<std::string> names;
  for (const EconomyRow& row : plan_economy(options)) names.push_back(row.name());
  return names;
}

/// Rows: a ball of 24 voxels radius whose middle goes by five voxels along j, in a box of 64^3,
/// 128^3 and 256^3 voxels, of which the rest is air or tissue of the same kind. Throws UsageError
/// when `only` leaves no row, Cancelled.
BenchReport bench_economy(const BenchOptions& options, Console& console) {
  const std::vector<EconomyRow> plan = plan_economy(options);
  int threads = options.threads;
  if (threads == 0) threads = std::min(2, int(std::thread::hardware_concurrency()));
  const ThreadLimit limit(threads);
  BenchReport report{"economy", measure_machine(), {}};
  const ScratchFolder folder;
  measure_economy({"air", 64}, folder);  // libraries and threads are there from now on
  for (const EconomyRow& row : plan) {
    if (console.cancelled()) throw Cancelled();
    console.stage(row.name());
    BenchRow result = measure_economy(row, folder);
    result["threads"] = threads;
    report.rows.push_back(std::move(result));
  }
  return report;
}

}  // namespace supple::tools

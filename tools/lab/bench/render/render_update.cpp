#include "tools/lab/bench/render/render_update.h"

#include <algorithm>

#include "raycast/pictures/compare.h"
#include "raycast/render.h"
#include "tools/console/console.h"
#include "tools/lab/bench/bodies/block_topology.h"
#include "tools/lab/bench/bodies/dragged_head.h"
#include "tools/lab/bench/bodies/half_sampled_head.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/base/parallel.h"
#include "volumes/base/relayed_progress.h"
#include "volumes/field/inversion/forward_offsets.h"

namespace supple::tools {

namespace {

DensityGrid density_of(const Vec3i& size, const BrickTopology& shell) {
  const HalfSampledHead head(size);
  const auto fill = [&](std::size_t b, float* out) {
    for_each_active(shell.mask(b), [&](int n) {
      Vec3i voxel = shell.origin(b) + brick_local(n);
      for (int a = 0; a < 3; ++a) voxel[a] = std::clamp(voxel[a], 0, size[a] - 1);
      out[n] = head(voxel);
    });
  };
  return fill_density_grid(shell, fill, -1000);
}

/// The dragged head, the inversions that follow it, and the renderer of its pictures.
struct UpdateScene {
  UpdateScene(const Vec3i& size, int image_size, std::int64_t wanted, Progress& cancel)
      : head(size, wanted, cancel),
        inversion(head.displacement(), head.params(), &cancel),
        forward(std::make_shared<ForwardOffsets>(head.displacement())),
        renderer(head.body().geometry, density_of(size, head.shell())),
        camera(default_camera(head.body().geometry, 1)) {
    settings.width = settings.height = image_size;
    const OffsetField at_rest = inversion.field(head.displacement());
    renderer.set_offsets(&at_rest);
  }

  void follow(const std::string& method, const std::vector<std::int32_t>& changed, Times& solve,
              Times& bricks) {
    if (method == "forward") {
      solve.ms.push_back(time_ms([&] { forward->update(changed); }));
      bricks.ms.push_back(time_ms([&] { renderer.set_pointwise_offsets(forward); }));
      return;
    }
    std::vector<Vec3i> touched;
    solve.ms.push_back(time_ms([&] { touched = inversion.update(head.displacement(), changed); }));
    bricks.ms.push_back(time_ms([&] { renderer.update_offsets(touched, inversion.finder()); }));
  }
  Image draw(RenderReport& report) const {
    return renderer.render(camera, preset("Bone"), settings, &report);
  }

  DraggedHead head;
  IncrementalInversion inversion;
  std::shared_ptr<ForwardOffsets> forward;
  Renderer renderer;
  Camera camera;
  RenderSettings settings;
};

struct UpdateTimes {
  Times extend, solve, bricks, frame, march, all, cpu;
  Image image;
};

UpdateTimes drag_again_and_again(UpdateScene& scene, const std::string& method, int events,
                                 Progress& cancel) {
  UpdateTimes times;
  Times ignored;
  for (int n = 0; n < events; ++n) {
    report(&cancel, 0);
    const std::vector<std::int32_t> at_rest = scene.head.reset();
    scene.follow(method, at_rest, ignored, ignored);
    scene.head.drag();
    times.cpu.ms.push_back(cpu_time_ms([&] {
      std::vector<std::int32_t> changed;
      times.extend.ms.push_back(time_ms([&] { changed = scene.head.follow(); }));
      scene.follow(method, changed, times.solve, times.bricks);
    }));
    RenderReport report;
    times.image = scene.draw(report);
    times.frame.ms.push_back(report.prepare_ms);
    times.march.ms.push_back(report.march_ms);
    times.all.ms.push_back(times.extend.ms.back() + times.solve.ms.back() + times.bricks.ms.back() +
                           report.prepare_ms);
  }
  return times;
}

}  // namespace

std::vector<RenderUpdateSide> update_sides(int threads) {
  std::vector<RenderUpdateSide> sides;
  for (const std::string method : {"inverse", "forward"}) {
    sides.push_back({method, 1});
    if (threads > 1) sides.push_back({method, threads});
  }
  return sides;
}

std::string update_row_name(const RenderUpdateSide& side) {
  return "update/" + side.method + "/" + std::to_string(side.threads);
}

std::vector<BenchRow> measure_render_update(const Vec3i& size, int image_size, std::int64_t wanted,
                                            const std::vector<RenderUpdateSide>& sides, int events,
                                            Console& console) {
  CancelOnly cancel(&console);
  UpdateScene scene(size, image_size, wanted, cancel);
  RenderReport ignored;
  scene.head.reset();
  Renderer judge(scene.head.body().geometry, density_of(size, scene.head.shell()));
  scene.head.drag();
  scene.head.follow();
  const OffsetField whole = invert(scene.head.displacement(), scene.head.params(), &cancel);
  judge.set_offsets(&whole);
  const Image expected = judge.render(scene.camera, preset("Bone"), scene.settings, &ignored);

  std::vector<BenchRow> rows;
  for (const RenderUpdateSide& side : sides) {
    const ThreadLimit limit(side.threads);
    // The other method did not see the last drags.
    scene.forward->update(scene.head.reset());
    const UpdateTimes times = drag_again_and_again(scene, side.method, events, cancel);
    if (side.method == "inverse" && times.image.rgba != expected.rgba) {
      throw Error("bench render: the followed picture is not that of a full inversion");
    }
    BenchRow row = {{"case", "update"},
                    {"method", side.method},
                    {"size", {size.x, size.y, size.z}},
                    {"image", {image_size, image_size}},
                    {"moved", scene.head.moved()},
                    {"extend_ms", times.extend.median()},
                    {"solve_ms", times.solve.median()},
                    {"bricks_ms", times.bricks.median()},
                    {"frame_ms", times.frame.median()},
                    {"march_ms", times.march.median()},
                    {"cpu_ms", times.cpu.median()},
                    {"ssim", compare(times.image, expected, true).ssim}};
    add_times(row, times.all, side.threads);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace supple::tools

#include "tools/bench/invert_update.h"

#include <oneapi/tbb/global_control.h>

#include "tools/bench/cancel_only.h"
#include "tools/bench/ecm_bodies.h"
#include "tools/bench/ecm_engines.h"
#include "tools/bench/ecm_motion.h"
#include "tools/bench/timing.h"
#include "volumes/field/invert.h"
#include "volumes/state/live_displacement.h"

namespace supple::tools {

namespace {

/// A dragged head with what follows it.
struct Scene {
  Scene(const Vec3i& size, std::int64_t wanted, Progress& cancel)
      : body(head_phantom_body(size)),
        live(body.geometry, body.elements, dilate(body.elements, 2)),
        inversion(live.displacement(), params(), &cancel) {
    workload.direction = "+y";
    workload.start = "rest";
    voxel = cheek_element(body);
    amplitude = find_amplitude(workload, body, voxel, wanted, cancel);
    engine = make_engine("supple", body, &cancel);
  }
  InvertParams params() const {
    InvertParams invert_params;
    invert_params.material = &body.elements;
    return invert_params;
  }

  Body body;
  LiveDisplacement live;
  IncrementalInversion inversion;
  EcmWorkload workload;
  Vec3i voxel;
  double amplitude;
  std::unique_ptr<EcmEngine> engine;
};

void require_equal(const OffsetField& found, const OffsetField& expected) {
  if (found.o.topology == expected.o.topology && found.o.vectors == expected.o.vectors) return;
  throw Error("bench invert: the updated offsets are not those of a full inversion");
}

/// Times of single drags out of rest.
struct UpdateTimes {
  Times extend, invert, both, cpu;
  std::int64_t moved = 0, bricks = 0, nodes = 0;
};

UpdateTimes drag_again_and_again(Scene& scene, int events, Progress& cancel) {
  UpdateTimes times;
  for (int n = 0; n < events; ++n) {
    report(&cancel, 0);
    scene.engine->reset();
    scene.inversion.update(scene.live.displacement(), scene.live.update(scene.body.q));
    scene.engine->pull(pull_of(scene.voxel, scene.workload.direction, scene.amplitude));
    std::vector<std::int32_t> changed;
    std::vector<Vec3i> touched;
    times.cpu.ms.push_back(cpu_time_ms([&] {
      times.extend.ms.push_back(time_ms([&] { changed = scene.live.update(scene.body.q); }));
      times.invert.ms.push_back(
          time_ms([&] { touched = scene.inversion.update(scene.live.displacement(), changed); }));
    }));
    times.both.ms.push_back(times.extend.ms.back() + times.invert.ms.back());
    times.moved = scene.engine->moved();
    times.bricks = std::int64_t(touched.size());
    times.nodes = 0;
    for (const Vec3i& origin : touched) {
      const VectorBrickView brick = scene.inversion.finder()(origin);
      if (brick.mask != nullptr) times.nodes += mask_count(*brick.mask);
    }
  }
  return times;
}

}  // namespace

std::vector<BenchRow> measure_update(const Vec3i& size, std::int64_t wanted,
                                     const std::vector<int>& threads, int events,
                                     Console& console) {
  CancelOnly cancel(console);
  Scene scene(size, wanted, cancel);
  std::vector<BenchRow> rows;
  for (const int count : threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(count));
    const UpdateTimes times = drag_again_and_again(scene, events, cancel);
    if (rows.empty()) {
      require_equal(scene.inversion.field(),
                    invert(scene.live.displacement(), scene.params(), &cancel));
    }
    const InversionCertificate certificate = scene.inversion.certificate();
    BenchRow row = {{"case", "update"},
                    {"method", "newton"},
                    {"field", "head_phantom"},
                    {"size", {size.x, size.y, size.z}},
                    {"elements", scene.body.elements.active_count()},
                    {"moved", times.moved},
                    {"touched_bricks", times.bricks},
                    {"touched_voxels", times.nodes},
                    {"extend_ms", times.extend.median()},
                    {"invert_ms", times.invert.median()},
                    {"cpu_ms", times.cpu.median()},
                    {"residual_max", certificate.residual_max},
                    {"folded", certificate.folded_cells}};
    add_times(row, times.both, count);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace supple::tools

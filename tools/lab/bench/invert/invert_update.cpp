#include "tools/lab/bench/invert/invert_update.h"

#include "tools/console/console.h"
#include "tools/lab/bench/bodies/dragged_head.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/base/parallel.h"
#include "volumes/base/relayed_progress.h"

namespace supple::tools {

namespace {

void require_equal(const OffsetField& found, const OffsetField& expected) {
  if (found.o.topology == expected.o.topology && found.o.vectors == expected.o.vectors) return;
  throw Error("bench invert: the updated offsets are not those of a full inversion");
}

/// Times of single drags out of rest.
struct InvertUpdateTimes {
  Times extend, invert, both, cpu;
  std::int64_t moved = 0, bricks = 0, nodes = 0;
};

InvertUpdateTimes drag_again_and_again(DraggedHead& head, IncrementalInversion& inversion,
                                       int events, Progress& cancel) {
  InvertUpdateTimes times;
  for (int n = 0; n < events; ++n) {
    report(&cancel, 0);
    const std::vector<std::int32_t> at_rest = head.reset();
    inversion.update(head.displacement(), at_rest);
    head.drag();
    std::vector<std::int32_t> changed;
    std::vector<Vec3i> touched;
    times.cpu.ms.push_back(cpu_time_ms([&] {
      times.extend.ms.push_back(time_ms([&] { changed = head.follow(); }));
      times.invert.ms.push_back(
          time_ms([&] { touched = inversion.update(head.displacement(), changed); }));
    }));
    times.both.ms.push_back(times.extend.ms.back() + times.invert.ms.back());
    times.moved = head.moved();
    times.bricks = std::int64_t(touched.size());
    times.nodes = 0;
    for (const Vec3i& origin : touched) {
      const VectorBrickView brick = inversion.finder()(origin);
      if (brick.mask != nullptr) times.nodes += mask_count(*brick.mask);
    }
  }
  return times;
}

}  // namespace

std::vector<BenchRow> measure_update(const Vec3i& size, std::int64_t wanted,
                                     const std::vector<int>& threads, int events,
                                     Console& console) {
  CancelOnly cancel(&console);
  DraggedHead head(size, wanted, cancel);
  IncrementalInversion inversion(head.displacement(), head.params(), &cancel);
  std::vector<BenchRow> rows;
  for (const int count : threads) {
    const ThreadLimit limit(count);
    const InvertUpdateTimes times = drag_again_and_again(head, inversion, events, cancel);
    if (rows.empty()) {
      require_equal(inversion.field(head.displacement()),
                    invert(head.displacement(), head.params(), &cancel));
    }
    const InversionCertificate certificate = inversion.certificate(head.displacement());
    BenchRow row = {{"case", "update"},
                    {"method", "newton"},
                    {"field", "head_phantom"},
                    {"size", {size.x, size.y, size.z}},
                    {"elements", head.body().elements.active_count()},
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

#include "tools/lab/bench/ecm/ecm_sides.h"

#include "tools/lab/bench/report/memory.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

/// Smaller bodies drown in the pages that any program touches.
constexpr std::int64_t kPeakFromNodes = 1'000'000;

}  // namespace

double timed_pull(EcmEngine& engine, const BenchDrag& pull, int threads) {
  const ThreadLimit limit(threads);
  return time_ms([&] { engine.pull(pull); });
}

WarmSide warm_up(const EcmSide& side, MeasuredBody& measured, const std::vector<BenchDrag>& script,
                 Progress& cancel) {
  release_offsets(measured.body);
  WarmSide warm;
  warm.side = side;
  const std::int64_t heap_before = heap_bytes();
  const PeakMemory peak;
  warm.engine = make_engine(side.engine, measured.body, &cancel);
  for (const BenchDrag& pull : script) {
    report(&cancel, 0);
    warm.last_ms = timed_pull(*warm.engine, pull, side.threads);
  }
  // The reference has nodes of its own; the others work on the body.
  const std::int64_t shared = side.engine == "multiset" ? 0 : measured.bytes;
  warm.bytes = shared + heap_bytes() - heap_before;
  if (const auto growth = peak.growth()) warm.peak_bytes = shared + *growth;
  warm.moved = warm.engine->moved();
  warm.checksum = warm.engine->checksum();
  return warm;
}

void require_equal_offsets(const EcmWorkload& workload, const EcmSide& side, std::uint64_t found,
                           std::uint64_t expected) {
  if (found == expected) return;
  throw Error(row_name(workload, side) + ": found other offsets than " +
              row_name(workload, workload.sides.front()) + ", expected equal ones");
}

BenchRow row_of(const EcmWorkload& workload, const WarmSide& warm, const Body& body,
                std::int64_t moved, double ns_per_node) {
  const double nodes = double(body.elements.active_count());
  BenchRow row = {{"case", workload.kind},
                  {"engine", warm.side.engine},
                  {"path", warm.engine->path()},
                  {"field", workload.field},
                  {"size", {workload.size.x, workload.size.y, workload.size.z}},
                  {"direction", workload.direction},
                  {workload.kind == "stream" ? "script" : "start", workload.start},
                  {"nodes", body.elements.active_count()},
                  {"moved", moved},
                  {"ns_per_node", ns_per_node},
                  {"bytes_per_node", double(warm.bytes) / nodes}};
  if (nodes >= kPeakFromNodes && warm.peak_bytes) {
    row["peak_bytes_per_node"] = double(*warm.peak_bytes) / nodes;
  }
  row["max_list"] = warm.engine->max_list();
  return row;
}

}  // namespace supple::tools

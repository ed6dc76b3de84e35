// `supple bench ecm`: the thesis' multiset algorithm, a bucket-queue Dijkstra and the engine, on
// the workloads of design.md section 9.
#include <algorithm>
#include <filesystem>
#include <memory>

#include "tools/console/command.h"
#include "tools/console/console.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/bodies/ecm_bodies.h"
#include "tools/lab/bench/ecm/ecm_cases.h"
#include "tools/lab/bench/report/memory.h"
#include "volumes/base/relayed_progress.h"

namespace supple::tools {

namespace {

constexpr std::int64_t kMultisetMemory = std::int64_t(16) << 30;

/// Limits of a case: its rounds, and the size below which multiset rows repeat.
EcmCaseLimits limits_of(bool quick) {
  EcmCaseLimits limits;
  limits.rounds = quick ? RoundLimits{3, 25, 250} : RoundLimits{5, 100, 2000};
  limits.multiset_repeats_below = quick ? 150'000 : 3'000'000;
  return limits;
}

/// The multiset engine needs hundreds of bytes per node: left out, with the reason, where these do
/// not fit.
void drop_what_does_not_fit(EcmWorkload& workload, Console& console) {
  const std::int64_t needed = expected_multiset_bytes(workload.size);
  const std::int64_t allowed = std::min(kMultisetMemory, available_bytes() * 8 / 10);
  if (needed <= allowed) return;
  auto& sides = workload.sides;
  const auto is_multiset = [](const EcmSide& side) { return side.engine == "multiset"; };
  const auto kept = std::remove_if(sides.begin(), sides.end(), is_multiset);
  if (kept == sides.end()) return;
  sides.erase(kept, sides.end());
  console.note(workload_name(workload) + ": multiset left out, it would take about " +
               std::to_string(needed >> 30) + " GiB and may have " + std::to_string(allowed >> 30));
}

/// Keeps the last body, which the next workload often shares.
class Bodies {
 public:
  explicit Bodies(std::string head_file) : m_head_file(std::move(head_file)) {}

  MeasuredBody& of(const EcmWorkload& workload) {
    if (m_body && workload.field == m_field && workload.size == m_size) return *m_body;
    m_body.reset();
    const std::int64_t before = heap_bytes();
    m_body = std::make_unique<MeasuredBody>(MeasuredBody{make(workload), 0});
    m_body->bytes = heap_bytes() - before;
    m_field = workload.field;
    m_size = workload.size;
    return *m_body;
  }

 private:
  Body make(const EcmWorkload& workload) const {
    if (workload.field == "ct_head") return ct_head_body(m_head_file);
    if (workload.field == "head_phantom") return head_phantom_body(workload.size);
    return block_body(workload.field, workload.size);
  }

  std::string m_head_file;
  std::string m_field;
  Vec3i m_size;
  std::unique_ptr<MeasuredBody> m_body;
};

std::vector<EcmWorkload> checked_workloads(const BenchOptions& options, const std::string& head) {
  EcmPlanOptions plan_options;
  plan_options.quick = options.quick;
  plan_options.threads = options.threads;
  plan_options.only = options.only;
  if (!head.empty()) plan_options.ct_head_size = volume_dims(head);
  std::vector<EcmWorkload> plan = plan_ecm(plan_options);
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as "
                              "all/noise/128x128x128/+x/rest/supple/1"}));
  }
  return plan;
}

}  // namespace

std::vector<std::string> ecm_row_names(const BenchOptions& options, Console& console) {
  std::vector<std::string> names;
  for (const EcmWorkload& workload :
       checked_workloads(options, head_file(options.ct_head, options.only.empty(), console))) {
    for (const EcmSide& side : workload.sides) names.push_back(row_name(workload, side));
  }
  return names;
}

BenchReport bench_ecm(const BenchOptions& options, Console& console) {
  const std::string head = head_file(options.ct_head, options.only.empty(), console);
  std::vector<EcmWorkload> plan = checked_workloads(options, head);
  BenchReport result{"ecm", measure_machine(), {}};
  Bodies bodies(head);
  CancelOnly cancel(&console);
  for (EcmWorkload& workload : plan) {
    report(&cancel, 0);
    drop_what_does_not_fit(workload, console);
    if (workload.sides.empty()) continue;
    console.stage(workload_name(workload));
    for (BenchRow& row :
         measure_workload(workload, bodies.of(workload), limits_of(options.quick), cancel)) {
      result.rows.push_back(std::move(row));
    }
  }
  return result;
}

}  // namespace supple::tools

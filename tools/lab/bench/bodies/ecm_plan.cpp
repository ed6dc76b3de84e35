#include "tools/lab/bench/bodies/ecm_plan.h"

#include <algorithm>
#include <thread>

#include "tools/lab/bench/report/report.h"

namespace supple::tools {

namespace {

/// Thesis section 4.2.3, "Performance Analysis".
const Vec3i kThesisSizes[] = {{12, 12, 1},   {25, 25, 1},   {50, 50, 1},
                              {100, 100, 1}, {200, 200, 1}, {316, 316, 1},
                              {22, 26, 20},  {50, 50, 10},  {100, 100, 10}};
const std::string kStarts[] = {"rest", "repeat"};

class Planner {
 public:
  explicit Planner(const EcmPlanOptions& options) : m_options(options) {
    m_threads = options.threads;
    if (m_threads == 0) m_threads = std::min(2, int(std::thread::hardware_concurrency()));
  }

  std::vector<EcmWorkload> plan() {
    add_thesis_sizes();
    add_noise_cubes();
    add_other_fields();
    add_large_cubes();
    add_head();
    for (const int size : {64, 256, 512}) add_local(size);
    add_stream();
    add_ball();
    add_links();
    keep_only();
    return std::move(m_plan);
  }

 private:
  void add_thesis_sizes() {
    for (const Vec3i& size : kThesisSizes) {
      for (const std::string direction : {"+x", "-x", "xy", "xyz"}) {
        if (m_options.quick && direction != "+x") continue;
        for (const std::string& start : kStarts) {
          add("noise", size, direction, start, {"multiset", "bucket", "supple"});
        }
      }
    }
  }

  void add_noise_cubes() {
    for (const int n : {64, 128}) {
      add("noise", Vec3i(n), "+x", "rest", {"multiset", "bucket", "supple"});
      // Two pulls of the multiset algorithm at 128^3 take half of a quick run.
      std::vector<std::string> repeated = {"multiset", "bucket", "supple"};
      if (m_options.quick && n == 128) repeated.erase(repeated.begin());
      add("noise", Vec3i(n), "+x", "repeat", repeated);
      if (!m_options.quick) add("noise", Vec3i(n), "xyz", "repeat", {"bucket", "supple"});
      add("noise", Vec3i(n), "xyz", "rest", {"supple"});
      if (m_options.quick) add("noise", Vec3i(n), "xyz", "repeat", {"supple"});
    }
  }

  void add_other_fields() {
    for (const std::string field : {"ct", "smooth"}) {
      for (const std::string& start : kStarts) {
        if (m_options.quick && start == "repeat") continue;
        std::vector<std::string> engines = {"bucket", "supple"};
        if (!m_options.quick && start == "rest") engines.insert(engines.begin(), "multiset");
        add(field, Vec3i(128), "+x", start, engines);
        if (!m_options.quick) add(field, Vec3i(64), "+x", start, {"multiset", "bucket", "supple"});
      }
    }
  }

  void add_large_cubes() {
    for (const std::string field : {"noise", "ct", "smooth"}) {
      if (m_options.quick && field == "smooth") continue;
      for (const std::string& start : kStarts) {
        if (m_options.quick && start == "repeat") continue;
        std::vector<std::string> engines = {"supple"};
        if (!m_options.quick) engines.insert(engines.begin(), "bucket");
        if (!m_options.quick && field == "noise") engines.insert(engines.begin(), "multiset");
        add(field, Vec3i(256), "+x", start, engines);
      }
    }
    if (m_options.quick) {
      m_plan.push_back({"all", "noise", Vec3i(512), "+x", "rest", 0, {{"supple", 1}}});
      return;
    }
    add("noise", Vec3i(512), "+x", "rest", {"bucket", "supple"});
    add("noise", Vec3i(512), "+x", "repeat", {"supple"});
    for (const std::string& start : kStarts) add("noise", Vec3i(512), "xyz", start, {"supple"});
    add("ct", Vec3i(512), "+x", "rest", {"supple"});
  }

  void add_head() {
    if (m_options.ct_head_size == Vec3i(0)) return;
    for (const std::string& start : kStarts) {
      if (m_options.quick && start == "repeat") continue;
      std::vector<std::string> engines = {"bucket", "supple"};
      if (!m_options.quick) engines.insert(engines.begin(), "multiset");
      add("ct_head", m_options.ct_head_size, "+x", start, engines);
    }
  }

  void add_local(int size) {
    for (const std::int64_t wanted : {10'000, 100'000, 1'000'000}) {
      if (wanted > std::int64_t(size) * size * size) continue;
      for (const std::string& start : kStarts) {
        EcmWorkload workload{"local", "noise", Vec3i(size), "+x", start, wanted, {}};
        if (!m_options.quick) workload.sides.push_back({"bucket", 1});
        workload.sides.push_back({"supple", 1});
        if (!m_options.quick && m_threads > 1) workload.sides.push_back({"supple", m_threads});
        m_plan.push_back(workload);
      }
    }
  }

  void add_stream() {
    for (const std::string script : {"pull", "wander", "anchored"}) {
      EcmWorkload workload{"stream", "head_phantom", {512, 512, 256}, "+y", script, 1'000'000, {}};
      if (!m_options.quick && script != "anchored") {
        workload.sides.push_back({"bucket", 1});
        workload.sides.push_back({"supple", 1});
      }
      if (m_options.quick || m_threads > 1) workload.sides.push_back({"supple", m_threads});
      m_plan.push_back(workload);
    }
  }

  /// Small bodies, as ball limits are a sequential model and another one.
  void add_ball() {
    for (const Vec3i& size : kThesisSizes) {
      const bool is_quick = size == Vec3i(50, 50, 1) || size == Vec3i(22, 26, 20);
      if (size.x > 100 || (m_options.quick && !is_quick)) continue;
      for (const std::string field : {"noise", "smooth"}) {
        m_plan.push_back({"ball", field, size, "+x", "rest", 0, {{"supple", 1}, {"ball", 1}}});
      }
    }
  }

  /// Diagonals: every element moves, by what deform uses.
  void add_links() {
    for (const std::string field : {"noise", "smooth"}) {
      const int size = m_options.quick ? 64 : 128;
      EcmWorkload workload{"links", field, Vec3i(size), "+x", "rest", 0, {}};
      for (const std::string engine : {"links6", "links18", "links26"}) {
        workload.sides.push_back({engine, 1});
        if (m_threads > 1) workload.sides.push_back({engine, m_threads});
      }
      m_plan.push_back(workload);
    }
  }

  /// Every element moves; `supple` with one thread and with several.
  void add(const std::string& field, const Vec3i& size, const std::string& direction,
           const std::string& start, const std::vector<std::string>& engines) {
    EcmWorkload workload{"all", field, size, direction, start, 0, {}};
    for (const std::string& engine : engines) {
      workload.sides.push_back({engine, 1});
      if (engine == "supple" && m_threads > 1) workload.sides.push_back({engine, m_threads});
    }
    m_plan.push_back(workload);
  }

  void keep_only() {
    for (EcmWorkload& workload : m_plan) {
      const auto is_left_out = [&](const EcmSide& side) {
        return !is_wanted_row(m_options.only, row_name(workload, side));
      };
      auto& sides = workload.sides;
      sides.erase(std::remove_if(sides.begin(), sides.end(), is_left_out), sides.end());
    }
    m_plan.erase(std::remove_if(m_plan.begin(), m_plan.end(),
                                [](const EcmWorkload& w) { return w.sides.empty(); }),
                 m_plan.end());
  }

  const EcmPlanOptions& m_options;
  int m_threads;
  std::vector<EcmWorkload> m_plan;
};

}  // namespace

std::vector<EcmWorkload> plan_ecm(const EcmPlanOptions& options) {
  return Planner(options).plan();
}

std::string workload_name(const EcmWorkload& workload) {
  const Vec3i& size = workload.size;
  std::string name = workload.kind + "/" + workload.field + "/" + std::to_string(size.x) + "x" +
                     std::to_string(size.y) + "x" + std::to_string(size.z) + "/" +
                     workload.direction + "/" + workload.start;
  if (workload.kind == "local") name += "/" + std::to_string(workload.wanted);
  return name;
}

std::string row_name(const EcmWorkload& workload, const EcmSide& side) {
  return workload_name(workload) + "/" + side.engine + "/" + std::to_string(side.threads);
}

}  // namespace supple::tools

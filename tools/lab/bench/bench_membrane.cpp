// `supple bench membrane`: steps of a membrane in an eye, by its two models.
#include <algorithm>
#include <cmath>

#include "lib/membrane/membrane.h"
#include "tools/console/command.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

constexpr double kEyeMm = 11, kSheetMm = 2.6;
constexpr double kStep_s = 0.02;
constexpr int kSteps = 150;

/// The thing that a membrane meets, beside forceps that pull it by its rim.
enum class Meets { nothing, adhesion, contact, tearing };

struct MembraneRow {
  MembraneModel model;
  int nodes;
  Meets meets;

  const char* model_name() const { return model == MembraneModel::springs ? "springs" : "ecm"; }
  const char* case_name() const {
    static constexpr const char* kNames[] = {"free", "adhesion", "contact", "tearing"};
    return kNames[std::size_t(meets)];
  }
  std::string name() const {
    return std::string(case_name()) + "/" + std::to_string(nodes) + "/" + model_name();
  }
};

std::vector<MembraneRow> plan_membranes(const BenchOptions& options) {
  std::vector<MembraneRow> plan;
  for (const Meets meets : {Meets::nothing, Meets::adhesion, Meets::contact, Meets::tearing}) {
    for (const int nodes : {1500, 6000}) {
      for (const MembraneModel model : {MembraneModel::springs, MembraneModel::ecm}) {
        const MembraneRow row{model, nodes, meets};
        const bool tears_not = meets == Meets::tearing && model == MembraneModel::ecm;
        if (tears_not || (options.quick && nodes > 1500)) continue;
        if (is_wanted_row(options.only, row.name())) plan.push_back(row);
      }
    }
  }
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as adhesion/1500/springs"}));
  }
  return plan;
}

MembraneParams params_of(const MembraneRow& row) {
  MembraneParams params;
  params.model = row.model;
  if (row.meets == Meets::nothing) params.adhesion_j_m2 = 0;
  if (row.meets == Meets::tearing) {
    params.adhesion_j_m2 = 1;
    params.strength_n_m = 2;
  }
  return params;
}

/// Forceps whose grip is a ball of 0.3 mm, and a blunt tool of 0.4 mm radius.
std::vector<Instrument> make_tools() {
  std::vector<Instrument> tools(2);
  const RoundCone ball{{0, 0, 0}, {0, 0, 1e-3}, 0.3, 0.3};
  tools[0].grip = GripZone{ball, 5, 8};
  tools[1].parts = {{RoundCone{{0, 0, 0.4}, {0, 0, 20}, 0.4, 0.4}, 0}};
  return tools;
}

/// Forceps take the rim, peel it over the middle and up, 1 mm/s; the tool sweeps to and fro before
/// them, pressed by 0.02 mm into the ground.
InstrumentPose pose_at(std::size_t tool, const Vec3d& rim_mm, int step) {
  const double way_mm = 0.02 * step;
  InstrumentPose pose;
  if (tool == 0) {
    const Vec3d inwards = Vec3d(-rim_mm.x, -rim_mm.y, 0).normalized();
    pose.tip_mm = rim_mm + (inwards + Vec3d(0, 0, 0.75)) * way_mm;
    pose.opening_degrees = step == 0 ? 10 : 0;
  } else {
    const double x = 0.8 * std::sin(2 * way_mm), y = 1.2 * std::cos(0.7 * way_mm);
    const Vec3d down = Vec3d(x, y, -kEyeMm).normalized();
    pose.tip_mm = down * (kEyeMm + 0.02);
    pose.axis = -down;
  }
  return pose;
}

BenchRow measure_membrane(const MembraneRow& row) {
  const MembraneParams params = params_of(row);
  const TriangleMesh mesh =
      membrane_on_sphere({0, 0, 0}, kEyeMm - params.thickness_mm, {0, 0, -1}, kSheetMm, row.nodes);
  std::vector<Obstacle> under;
  if (row.meets != Meets::nothing) under.push_back({"retina", HollowSphere{{0, 0, 0}, kEyeMm}});
  Membrane membrane(mesh, params, under, "membrane");
  const std::vector<Instrument> tools = make_tools();
  const Vec3d rim_mm = mesh.vertices_lps_mm.back();
  const std::size_t tool_count = row.meets == Meets::contact ? 2 : 1;
  const double clung_mm2 = membrane.clinging_mm2();
  double longest = 1;
  int contacts = 0;
  Times times, cpu;
  for (int n = 0; n < kSteps; ++n) {
    std::vector<ToolMotion> motions;
    for (std::size_t t = 0; t < tool_count; ++t) {
      motions.push_back(
          motion_of(int(t), tools[t], pose_at(t, rim_mm, n), pose_at(t, rim_mm, n + 1)));
    }
    MembraneReport step;
    cpu.ms.push_back(cpu_time_ms([&] {
      times.ms.push_back(time_ms([&] { step = membrane.step(kStep_s, motions, tools); }));
    }));
    longest = std::max(longest, step.longest_stretch);
    contacts = std::max(contacts, step.contacts);
  }
  BenchRow fields{{"case", row.case_name()},
                  {"model", row.model_name()},
                  {"nodes", mesh.vertices_lps_mm.size()},
                  {"triangles", mesh.triangles.size()},
                  {"freed_mm2", clung_mm2 - membrane.clinging_mm2()}};
  fields["torn_mm"] = membrane.torn_mm();
  fields["most_contacts"] = contacts;
  fields["longest_stretch"] = longest;
  fields["us_per_node"] = 1e3 * cpu.median() / double(mesh.vertices_lps_mm.size());
  fields["cpu_ms"] = cpu.median();
  fields["cpu_p95_ms"] = cpu.quantile(0.95);
  add_times(fields, times, 1);
  return fields;
}

}  // namespace

std::vector<std::string> membrane_row_names(const BenchOptions& options, Console&) {
  std::vector<std::string> names;
  for (const MembraneRow& row : plan_membranes(options)) names.push_back(row.name());
  return names;
}

BenchReport bench_membrane(const BenchOptions& options, Console& console) {
  const ThreadLimit limit(1);
  BenchReport report{"membrane", measure_machine(), {}};
  for (const MembraneRow& row : plan_membranes(options)) {
    console.stage(row.name());
    report.rows.push_back(measure_membrane(row));
  }
  return report;
}

}  // namespace supple::tools

// `supple bench mesh`: tetrahedra of a round body of one and of five labels, by lattice cleaving.
#include <algorithm>
#include <thread>

#include "lib/mesh/tets/make_solid.h"
#include "lib/mesh/tets/solid_quality.h"
#include "tools/console/command.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

constexpr int kSize = 176;
constexpr double kRadius = 74;  // voxels of 1 mm, 1,700 ml

struct MeshRow {
  int labels, elements, coarser;

  std::string name() const {
    return "ball/" + std::to_string(labels) + "/" + std::to_string(elements) +
           (coarser > 0 ? "/coarser" : "");
  }
};

std::vector<MeshRow> plan_mesh(const BenchOptions& options) {
  std::vector<MeshRow> plan = {{1, 35'000, 0}, {5, 35'000, 0}};
  if (!options.quick) {
    for (const MeshRow& row : {MeshRow{1, 1'000'000, 0}, {5, 1'000'000, 0}, {1, 1'000'000, 3}}) {
      plan.push_back(row);
    }
  }
  const auto is_left_out = [&](const MeshRow& row) {
    return !is_wanted_row(options.only, row.name());
  };
  plan.erase(std::remove_if(plan.begin(), plan.end(), is_left_out), plan.end());
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as ball/1/35000"}));
  }
  return plan;
}

VoxelMask ball_mask() {
  const Geometry geometry(Vec3i(kSize), Vec3d(0), {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});
  const Vec3d middle(0.5 * (kSize - 1));
  VoxelMask mask{geometry, {Vec3i(0), Vec3i(kSize - 1)}, {}};
  for (int k = 0; k < kSize; ++k) {
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) {
        mask.inside.push_back((Vec3d(i, j, k) - middle).length() < kRadius ? 1 : 0);
      }
    }
  }
  return mask;
}

/// Two shells, two halves and a core.
std::int32_t label_at(const Vec3i& voxel) {
  const Vec3d from = Vec3d(voxel) - Vec3d(0.5 * (kSize - 1));
  const double radius = from.length() / kRadius;
  if (radius < 0.3) return 5;
  if (radius < 0.75) return from.x < 0.3 * from.z ? 3 : 4;
  return radius < 0.87 ? 2 : 1;
}

BenchRow measure_mesh(const MeshRow& row, int rounds, Progress& cancel) {
  const VoxelMask mask = ball_mask();
  const VoxelLabel label_of = row.labels > 1 ? VoxelLabel(label_at) : VoxelLabel();
  SolidParams params;
  params.elements = row.elements;
  params.coarser_levels = row.coarser;
  SolidMesh mesh;
  SolidReport made;
  Times times, cpu;
  for (int round = 0; round < rounds; ++round) {
    cpu.ms.push_back(cpu_time_ms([&] {
      times.ms.push_back(
          time_ms([&] { mesh = make_tets(mask, label_of, params, {}, &made, &cancel); }));
    }));
  }
  const SolidQuality quality = quality_of(mesh);
  const double voxels = mask.volume_mm3();
  BenchRow fields{{"case", "ball"},
                  {"labels", row.labels},
                  {"coarser", row.coarser},
                  {"elements", mesh.tets.size()}};
  fields["nodes"] = mesh.nodes_lps_mm.size();
  fields["passes"] = made.passes;
  fields["least_dihedral_deg"] = quality.least_dihedral_deg;
  fields["largest_dihedral_deg"] = quality.largest_dihedral_deg;
  fields["volume_percent"] = 100 * quality.mean_volume_mm3 * double(mesh.tets.size()) / voxels;
  fields["us_per_element"] = 1e3 * cpu.median() / double(mesh.tets.size());
  fields["cpu_ms"] = cpu.median();
  add_times(fields, times, 0);
  return fields;
}

}  // namespace

std::vector<std::string> mesh_row_names(const BenchOptions& options, Console&) {
  std::vector<std::string> names;
  for (const MeshRow& row : plan_mesh(options)) names.push_back(row.name());
  return names;
}

BenchReport bench_mesh(const BenchOptions& options, Console& console) {
  int threads = options.threads;
  if (threads == 0) threads = std::min(2, int(std::thread::hardware_concurrency()));
  const ThreadLimit limit(threads);
  BenchReport report{"mesh", measure_machine(), {}};
  for (const MeshRow& row : plan_mesh(options)) {
    console.stage(row.name());
    BenchRow result = measure_mesh(row, row.elements < 100'000 ? 5 : 3, console);
    result["threads"] = threads;
    report.rows.push_back(std::move(result));
  }
  return report;
}

}  // namespace supple::tools

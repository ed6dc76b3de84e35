#include "tools/lab/bench/elastic/tet_rows.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "tools/lab/bench/report/timing.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

constexpr double kRadiusMm = 74;                        // of 1,700 ml
constexpr double kTissueKpa = 6, kSwellingKpa = 2.666;  // 20 mmHg
constexpr const char* kElementNames[] = {"linear", "nodal_pressure", "quadratic"};
constexpr int kAxes[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};

/// The place of a lattice point -1 ... 1 on the sphere through it.
Vec3d on_sphere(const Vec3d& at) {
  const double most = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)});
  return most == 0 ? at : at * (kRadiusMm * most / at.length());
}

SolidMesh ball_of_tets(int n, double poisson) {
  SolidMesh mesh;
  const int nodes = n + 1;
  for (int at = 0; at < nodes * nodes * nodes; ++at) {
    const Vec3d lattice(at % nodes, at / nodes % nodes, at / nodes / nodes);
    mesh.nodes_lps_mm.push_back(on_sphere(lattice * (2.0 / n) - Vec3d(1)));
  }
  FaceSet surface{"surface", {}};
  const auto is_outside = [&](std::int32_t node) {
    return mesh.nodes_lps_mm[std::size_t(node)].length() > (1 - 1e-9) * kRadiusMm;
  };
  constexpr std::size_t kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  for (int cube = 0; cube < n * n * n; ++cube) {
    const int first = (cube / n / n * nodes + cube / n % n) * nodes + cube % n;
    for (const auto& axes : kAxes) {
      std::array<std::int32_t, 4> tet{first, 0, 0, 0};
      for (std::size_t c = 0; c < 3; ++c) {
        const int step = axes[c] == 0 ? 1 : axes[c] == 1 ? nodes : nodes * nodes;
        tet[c + 1] = tet[c] + step;
      }
      const auto corner = [&](std::size_t c) { return mesh.nodes_lps_mm[std::size_t(tet[c])]; };
      if (tet_shape(corner(0), corner(1), corner(2), corner(3)).volume_mm3 < 0) {
        std::swap(tet[0], tet[1]);
      }
      mesh.tets.push_back(tet);
      for (const auto& [a, b, c] : kFaces) {
        if (is_outside(tet[a]) && is_outside(tet[b]) && is_outside(tet[c])) {
          surface.triangles.push_back({tet[a], tet[b], tet[c]});
        }
      }
    }
  }
  mesh.faces.push_back(std::move(surface));
  mesh.materials = {{"tissue", kTissueKpa, poisson}};
  return mesh;
}

}  // namespace

std::string TetRow::name() const {
  return std::string("tets/") + kElementNames[int(element)] + "/" + std::to_string(size) + "/" +
         number_text(poisson) + (has_dura ? "/dura" : "") +
         (equations == TetEquations::factor ? "/factor" : "") +
         (strain == StrainTheory::finite ? "/finite" : "");
}

std::vector<TetRow> tet_rows(bool quick) {
  using Element = TetElement;
  const auto by_gradients = TetEquations::gradients, by_factor = TetEquations::factor;
  if (quick) return {{Element::linear, by_gradients, 18, 0.48, false}};
  return {{Element::linear, by_gradients, 18, 0.3, false},
          {Element::linear, by_gradients, 18, 0.48, false},
          {Element::linear, by_gradients, 18, 0.499, false},
          {Element::linear, by_gradients, 18, 0.47, true},
          {Element::linear, by_factor, 18, 0.48, false},
          {Element::nodal_pressure, by_gradients, 18, 0.47, true},
          {Element::nodal_pressure, by_gradients, 18, 0.499, false},
          {Element::nodal_pressure, by_factor, 18, 0.499, false},
          {Element::quadratic, by_gradients, 18, 0.3, false},
          {Element::linear, by_gradients, 18, 0.47, true, StrainTheory::finite},
          {Element::nodal_pressure, by_gradients, 18, 0.47, true, StrainTheory::finite}};
}

BenchRow measure_tets(const TetRow& row, int rounds, int threads, Progress& cancel) {
  const ThreadLimit limit(threads);
  const SolidMesh mesh = ball_of_tets(row.size, row.poisson);
  std::vector<ElasticSheet> sheets;
  if (row.has_dura) sheets.push_back({"surface", SheetKind::both, 2500, 0.48, 0.6});
  TetLoads loads;
  loads.swelling_kpa.assign(mesh.tets.size(), kSwellingKpa);
  TetParams params;
  params.equations = row.equations;
  params.strain = row.strain;
  TetSolution solution;
  Times assembly, times, cpu;
  for (int round = 0; round < rounds; ++round) {
    std::unique_ptr<TetModel> model;
    assembly.ms.push_back(
        time_ms([&] { model = std::make_unique<TetModel>(mesh, row.element, sheets); }));
    if (loads.held.empty()) {
      TetHeld held;
      for (const NodeIndex node : model->nodes_of_faces("surface")) {
        const Vec3d& at = model->volumes().positions()[std::size_t(node)];
        if (at.z < 40) held.nodes.push_back(node);
      }
      loads.held.push_back(held);
    }
    cpu.ms.push_back(cpu_time_ms([&] {
      times.ms.push_back(time_ms([&] { solution = model->solve(loads, params, &cancel); }));
    }));
  }
  const FemReport& report = solution.report;
  BenchRow fields{{"case", "tets"},
                  {"field", kElementNames[int(row.element)]},
                  {"size", row.size},
                  {"elements", report.elements},
                  {"unknowns", report.unknowns}};
  fields["poisson"] = row.poisson;
  fields["dura"] = row.has_dura;
  fields["solver"] = row.equations == TetEquations::factor ? "factor" : "gradients";
  fields["strain"] = row.strain == StrainTheory::finite ? "finite" : "linear";
  fields["iterations"] = report.iterations;
  fields["residual_max"] = report.residual_max;
  fields["force_balance"] = report.force_balance;
  fields["assembly_ms"] = assembly.median();
  fields["setup_ms"] = report.setup_ms;
  fields["solve_ms"] = report.solve_ms;
  fields["munknowns_per_cpu_s"] = double(report.unknowns) / 1e3 / cpu.median();
  fields["bytes_per_unknown"] = double(report.bytes) / double(report.unknowns);
  fields["cpu_ms"] = cpu.median();
  add_times(fields, times, threads);
  return fields;
}

}  // namespace supple::tools

#include "lib/session/tets/tet_task.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/chainmail/held_voxels.h"
#include "lib/mesh/tets/solid_quality.h"
#include "lib/model/fem_grips.h"
#include "lib/session/step_warnings.h"
#include "lib/session/tet_record.h"
#include "lib/session/tets/tet_grips.h"
#include "volumes/base/parallel.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/text.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// The part of the voxels' volume by which that of a mesh may differ without a warning.
constexpr double kLargeDifference = 0.1;

/// Shape functions of a tetrahedron's nodes at corner weights.
std::array<double, 10> shape_functions(const std::array<float, 4>& weight, std::size_t nodes) {
  std::array<double, 10> shape{};
  for (std::size_t c = 0; c < 4; ++c) shape[c] = weight[c];
  if (nodes == 4) return shape;
  constexpr std::size_t kEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  for (std::size_t e = 0; e < 6; ++e) {
    shape[4 + e] = 4.0 * weight[kEdges[e][0]] * weight[kEdges[e][1]];
  }
  for (std::size_t c = 0; c < 4; ++c) shape[c] *= 2 * shape[c] - 1;
  return shape;
}

/// One step: its model, loads and results.
class TetRun {
 public:
  TetRun(const FemStep& step, const FemTask& task, const TetBody& tets)
      : m_step(step),
        m_settings(*step.tets),
        m_task(task),
        m_tets(tets),
        m_mesh(tets.mesh),
        m_numbers(element_numbers(task.held.body.elements)) {}

  FemRecord run(const std::vector<Handle>& handles, Progress* progress);

 private:
  SlotSet elements_of_load(const FemLoad& load) const {
    return elements_of(load.part, m_task.held.body, m_task.density, m_task.labels,
                       name_of(load.kind));
  }
  const VoxelSite& site_of(Slot slot) const { return m_tets.sites[std::size_t(m_numbers[slot])]; }
  void name_pressures(TetLoads& loads);
  TetModel make_model() const;
  void add_force(const SlotSet& elements, const Vec3d& force_n, TetLoads& loads) const;
  void add_swelling(const SlotSet& elements, double pressure_kpa, TetLoads& loads) const;
  void add_loads(TetLoads& loads) const;
  void hold(const std::vector<FemGrip>& grips, TetLoads& loads) const;
  void solve(const TetLoads& loads, Progress* progress);
  void move_body(const std::vector<FemGrip>& grips) const;
  void record_openings(TetRecord& record) const;
  void record_elements(const TetLoads& loads, FemRecord& record, TetRecord& own) const;
  /// The voxel at the middle of a tetrahedron.
  Vec3i voxel_at(std::size_t tet) const {
    Vec3d middle(0);
    for (const std::int32_t node : m_mesh.tets[tet]) {
      middle += m_mesh.nodes_lps_mm[std::size_t(node)] / 4;
    }
    return nearest_voxel(m_task.held.body.geometry.index_from_world(middle));
  }
  Vec3d displacement(NodeIndex node) const {
    const double* u = &m_solution.u_mm[3 * std::size_t(node)];
    return {u[0], u[1], u[2]};
  }

  const FemStep& m_step;
  const TetStep& m_settings;
  const FemTask& m_task;
  const TetBody& m_tets;
  SolidMesh m_mesh;  // with the faces of pressures
  std::vector<std::int32_t> m_numbers;
  std::unique_ptr<TetModel> m_model;
  TetSolution m_solution;
  std::optional<ShellContactReport> m_shell;
};

void TetRun::name_pressures(TetLoads& loads) {
  for (std::size_t n = 0; n < m_step.loads.size(); ++n) {
    const FemLoad& load = m_step.loads[n];
    if (load.kind != LoadKind::pressure) continue;
    const std::string name = "pressure " + std::to_string(n + 1);
    m_mesh.faces.push_back(
        loaded_faces(name, elements_of_load(load), load.facing, m_task.held.body, m_tets));
    loads.pressures.push_back({name, load.pressure_kpa});
  }
}

TetModel TetRun::make_model() const {
  std::vector<ElasticSheet> sheets;
  for (const TetSheet& sheet : m_settings.sheets) {
    sheets.push_back(sheet.sheet);
    if (!sheet.between) continue;
    const auto [first, second] = *sheet.between;
    sheets.back().faces = border_name(first, second);
    const bool is_there =
        std::any_of(m_mesh.faces.begin(), m_mesh.faces.end(),
                    [&](const auto& set) { return set.name == sheets.back().faces; });
    if (!is_there) {
      throw InputError({"", "between",
                        "labels " + std::to_string(first) + " and " + std::to_string(second) +
                            ", which share no face",
                        "labels that touch"});
    }
  }
  return TetModel(m_mesh, m_settings.element, std::move(sheets));
}

/// Elements share a force alike, and hand their shares to the nodes around them.
void TetRun::add_force(const SlotSet& elements, const Vec3d& force_n, TetLoads& loads) const {
  std::map<NodeIndex, double> parts;
  double all = 0;
  const NodeSets& of_tets = m_model->volumes().elements();
  elements.for_each([&](Slot slot) {
    const VoxelSite& site = site_of(slot);
    if (site.tet < 0) return;
    const auto tet = std::size_t(site.tet);
    const std::array<double, 10> shape = shape_functions(site.weight, of_tets.count(tet));
    for (std::size_t n = 0; n < of_tets.count(tet); ++n) parts[of_tets.nodes(tet)[n]] += shape[n];
    ++all;
  });
  if (all == 0) {
    throw InputError({"", "forces", "voxels that no tetrahedron reaches", "voxels in the mesh"});
  }
  for (const auto& [node, part] : parts) {
    loads.forces.push_back({node, force_n * (part / all * kMnPerN)});
  }
}

/// A tetrahedron swells by the part of its voxels that do; without voxels, as that nearest to it.
void TetRun::add_swelling(const SlotSet& elements, double pressure_kpa, TetLoads& loads) const {
  const Body& body = m_task.held.body;
  std::vector<float> all(m_mesh.tets.size(), 0), swelling(m_mesh.tets.size(), 0);
  for_each_element(body.elements, [&](Slot slot) {
    const VoxelSite& site = site_of(slot);
    if (site.tet >= 0) ++all[std::size_t(site.tet)];
  });
  elements.for_each([&](Slot slot) {
    const VoxelSite& site = site_of(slot);
    if (site.tet >= 0) ++swelling[std::size_t(site.tet)];
  });
  loads.swelling_kpa.resize(m_mesh.tets.size(), 0);
  for (std::size_t e = 0; e < all.size(); ++e) {
    double part = all[e] > 0 ? double(swelling[e]) / double(all[e]) : 0;
    if (all[e] == 0) {
      const auto slot = nearest_slot(body.elements, Vec3d(voxel_at(e)));
      part = slot && elements.contains(*slot) ? 1 : 0;
    }
    loads.swelling_kpa[e] += part * pressure_kpa;
  }
}

void TetRun::add_loads(TetLoads& loads) const {
  loads.gravity_m_s2 = m_step.gravity_m_s2;
  loads.density_kg_m3 = m_tets.density_kg_m3;
  for (const FemLoad& load : m_step.loads) {
    if (load.kind == LoadKind::force) add_force(elements_of_load(load), load.force_n, loads);
    if (load.kind == LoadKind::swelling) {
      add_swelling(elements_of_load(load), load.pressure_kpa, loads);
    }
  }
}

/// Holds the nodes of grips, and after them those of the outer faces that no grip has.
void TetRun::hold(const std::vector<FemGrip>& grips, TetLoads& loads) const {
  loads.held = held_nodes(grips, m_task.held.body, *m_model, m_tets.sites);
  if (m_settings.outside == TetOutside::held) {
    std::vector<char> is_taken(m_model->place_count(), 0);
    for (const TetHeld& held : loads.held) {
      for (const NodeIndex node : held.nodes) is_taken[std::size_t(node)] = 1;
    }
    TetHeld outside;
    for (const NodeIndex node : m_model->nodes_of_faces(kOutside)) {
      if (is_taken[std::size_t(node)] == 0) outside.nodes.push_back(node);
    }
    loads.held.push_back(std::move(outside));
  }
  for (TetHeld& held : loads.held) held.holds_turns = m_settings.clamps;
}

void TetRun::solve(const TetLoads& loads, Progress* progress) {
  TetParams params;
  params.equations = m_settings.equations;
  params.strain = m_step.params.strain;
  params.tolerance = m_step.params.tolerance;
  params.reaction_tolerance = m_step.params.reaction_tolerance;
  params.max_iterations = m_step.params.max_iterations;
  params.loose = m_step.params.loose;
  params.limits = limits_of(m_step.params);
  if (m_settings.outside != TetOutside::shell) {
    m_solution = m_model->solve(loads, params, progress);
    return;
  }
  TetShellContact shell;
  shell.faces = {kOutside};
  for (const TetOpening& opening : m_settings.openings) shell.openings.push_back(opening.name);
  shell.frees_rims = m_settings.frees_rims;
  shell.has_planes = m_settings.has_planes;
  TetContactSolution found = solve_in_shell(*m_model, loads, shell, params, progress);
  m_solution = std::move(found.solution);
  m_shell = std::move(found.report);
}

void TetRun::move_body(const std::vector<FemGrip>& grips) const {
  const NodeSets& of_tets = m_model->volumes().elements();
  std::vector<Vec3d> moved(m_tets.sites.size(), Vec3d(0));
  parallel_for(moved.size(), Grain{4096}, [&](std::size_t n) {
    const VoxelSite& site = m_tets.sites[n];
    if (site.tet < 0) return;
    const auto tet = std::size_t(site.tet);
    const std::array<double, 10> shape = shape_functions(site.weight, of_tets.count(tet));
    for (std::size_t c = 0; c < of_tets.count(tet); ++c) {
      moved[n] += displacement(of_tets.nodes(tet)[c]) * shape[c];
    }
  });
  give_to_body(moved, {}, grips, true, m_task.held.body);
}

void TetRun::record_openings(TetRecord& record) const {
  const std::vector<Vec3d>& at = m_model->volumes().positions();
  for (std::size_t n = 0; n < m_settings.openings.size(); ++n) {
    TetOpeningRecord& opening = record.openings.emplace_back();
    opening.name = m_settings.openings[n].name;
    opening.area_mm2 = m_model->area_of_faces(opening.name);
    if (m_shell) opening.free_area_mm2 = m_shell->openings[n].free_area_mm2;
    double out_mm3 = 0;
    for (const auto& face : m_model->parts_of_faces({opening.name})) {
      const auto area_at = [&](double part) {
        const auto x = [&](std::size_t c) {
          return at[std::size_t(face[c])] + displacement(face[c]) * part;
        };
        return (x(1) - x(0)).cross(x(2) - x(0)) / 2;
      };
      const Vec3d rest = area_at(0);
      Vec3d way(0);
      for (const NodeIndex node : face) {
        way += displacement(node) / 3;
        opening.bulge_mm = std::max(opening.bulge_mm, rest.normalized().dot(displacement(node)));
      }
      // Simpson's rule is exact for what a triangle sweeps.
      out_mm3 += way.dot(rest + area_at(0.5) * 4 + area_at(1)) / 6;
    }
    opening.out_ml = out_mm3 * kMlPerMm3;
  }
}

/// Means over labels, values of voxels, and the mean pressure.
void TetRun::record_elements(const TetLoads& loads, FemRecord& record, TetRecord& own) const {
  const std::vector<ElementState> states = m_model->states(m_solution, loads);
  double volume = 0, turn = 0, strain = 0;
  for (std::size_t e = 0; e < states.size(); ++e) {
    const double mm3 = m_model->volumes().volume_mm3(e);
    own.mean_pressure_kpa += value_of(states[e], FemQuantity::pressure) * mm3;
    volume += mm3;
    const auto principal = eigenvalues(states[e].strain);
    const double stretch = std::max(std::abs(principal[0]), std::abs(principal[2]));
    if (states[e].rotation_rad.length() > turn) {
      turn = states[e].rotation_rad.length();
      record.report.turned = voxel_at(e);
    }
    if (stretch > strain) {
      strain = stretch;
      record.report.strained = voxel_at(e);
    }
  }
  own.mean_pressure_kpa /= volume;
  const BrickTopology& elements = m_task.held.body.elements;
  for (const FemQuantity quantity : m_step.wanted) {
    std::vector<float> values;
    for (const VoxelSite& site : m_tets.sites) {
      values.push_back(site.tet < 0 ? 0 : float(value_of(states[std::size_t(site.tet)], quantity)));
    }
    record.values.push_back({quantity, elements, std::move(values)});
  }
  if (m_task.labels.empty()) return;
  std::map<std::int32_t, StrainGauge> gauges;
  for_each_element(elements, [&](Slot slot) {
    const std::int32_t label = m_task.labels.at(slot), tet = site_of(slot).tet;
    if (label <= 0 || tet < 0) return;
    StrainGauge& gauge = gauges[label];
    gauge.label = label;
    ++gauge.elements;
    for (std::size_t n = 0; n < kFemQuantities.size(); ++n) {
      gauge.mean[n] += value_of(states[std::size_t(tet)], kFemQuantities[n].first);
    }
  });
  for (auto& [label, gauge] : gauges) {
    for (double& mean : gauge.mean) mean /= double(gauge.elements);
    record.gauges.push_back(gauge);
  }
}

FemRecord TetRun::run(const std::vector<Handle>& handles, Progress* progress) {
  const HeldBody& in = m_task.held;
  const FixedElements fixed = fix(in.body, in.anchors);
  HeldVoxels found = supple::hold(in.body, handles, fixed, in.holds);
  const std::vector<FemGrip> grips = fem_grips(in.body, found, m_task.gripped);
  TetLoads loads;
  name_pressures(loads);
  m_model = std::make_unique<TetModel>(make_model());
  add_loads(loads);
  hold(grips, loads);
  solve(loads, progress);
  move_body(grips);
  found.rest.anchored.add(found.grabbed);
  in.holds = std::move(found.rest);

  FemRecord record;
  auto own = std::make_shared<TetRecord>();
  own->tetrahedra = std::int64_t(m_mesh.tets.size());
  own->nodes = std::int64_t(m_mesh.nodes_lps_mm.size());
  own->outer_faces = std::int64_t(m_tets.outer.size());
  const SolidQuality quality = quality_of(m_mesh);
  own->least_dihedral_deg = quality.least_dihedral_deg;
  own->largest_dihedral_deg = quality.largest_dihedral_deg;
  for (const auto& [region, mm3] : quality.volume_mm3) own->mesh_ml += mm3 * kMlPerMm3;
  own->voxels_ml = m_tets.voxels_ml;
  own->unmeshed = m_tets.unmeshed;
  own->far = m_tets.far;
  own->shell = m_shell;
  record.report = m_solution.report;
  record.report.smallest_det_f = m_solution.least_det_f;
  record.report.volume_change_ml =
      m_model->volumes().displaced_volume_mm3(m_solution.u_mm) * kMlPerMm3 - own->mesh_ml;
  record_openings(*own);
  record_elements(loads, record, *own);
  std::vector<FemReaction> reactions = m_solution.reactions;
  if (m_settings.outside == TetOutside::held) {
    own->outside = reactions.back();
    reactions.pop_back();
  }
  record.reactions = sums_over(m_task.gripped, grips, reactions);
  for (std::size_t n = 0; n < grips.size(); ++n) {
    if (grips[n].is_anchor()) record.anchors = reactions[n];
  }
  record.tets = std::move(own);
  return record;
}

void warn_of_result(const FemStep& step, const FemRecord& record, Progress* progress) {
  const TetRecord& own = *record.tets;
  const FemReport& report = record.report;
  if (own.unmeshed > 0) {
    warn(progress, "tetrahedra: " + with_count(own.unmeshed, "voxel") +
                       " in parts that the mesh leaves out, left at rest");
  }
  if (own.far > 0) {
    warn(progress, "tetrahedra: " + with_count(own.far, "voxel") + " more than " +
                       std::to_string(kNearRings) + " voxels from all of them, led by the nearest");
  }
  if (std::abs(own.mesh_ml - own.voxels_ml) > kLargeDifference * own.voxels_ml) {
    warn(progress, "tetrahedra: the mesh has " + number_text(own.mesh_ml) + " ml, the voxels " +
                       number_text(own.voxels_ml) + " ml");
  }
  if (report.loose_islands > 0) {
    warn(progress, "tetrahedra: nothing holds " + with_count(report.loose_islands, "island") +
                       " of " + std::to_string(report.loose_elements) +
                       " tetrahedra, left at rest");
  }
  if (report.smallest_det_f <= 0) {
    warn(progress, std::string("tetrahedra: ") +
                       (step.params.strain == StrainTheory::linear
                            ? "linear theory has turned some inside out"
                            : "some are inside out") +
                       ": least det F " + number_text(report.smallest_det_f));
  }
  if (report.beyond_linear) {
    warn(progress, "tetrahedra: turns of up to " + number_text(report.largest_rotation_deg) +
                       " degrees at voxel " + voxel_text(report.turned) + " and strains of up to " +
                       number_text(report.largest_strain) + " at voxel " +
                       voxel_text(report.strained) + " are beyond linear theory in " +
                       std::to_string(report.beyond_elements) + " tetrahedra");
  }
  warn_of_links(record.links, "tetrahedra", "a later drag or relaxation projects them", progress);
}

}  // namespace

FemRecord move_by_tets(const FemStep& step, const FemTask& task, const TetBody& tets,
                       const std::vector<Handle>& handles, Progress* progress) {
  const Stopwatch clock;
  stage(progress, "tetrahedra");
  Body& body = task.held.body;
  FemRecord record = TetRun(step, task, tets).run(handles, progress);
  record.links = check_links(body);
  body.links_known_valid = record.links.violated == 0;
  body.beyond.reset();
  record.milliseconds = clock.ms();
  warn_of_result(step, record, progress);
  return record;
}

}  // namespace supple

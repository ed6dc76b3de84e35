#include "lib/session/tets/tet_task.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/chainmail/held_voxels.h"
#include "lib/model/fem_grips.h"
#include "lib/session/tets/tet_grips.h"
#include "lib/session/tets/tet_results.h"
#include "volumes/base/parallel.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

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
      const auto slot = nearest_slot(body.elements, Vec3d(middle_voxel(m_mesh, e, body.geometry)));
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
  params.tolerance = m_step.params.residual_limit();
  params.reaction_tolerance = m_step.params.reaction_limit();
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
      moved[n] += displacement_of(m_solution, of_tets.nodes(tet)[c]) * shape[c];
    }
  });
  give_to_body(moved, {}, grips, true, m_task.held.body);
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

  const SolvedTets solved{m_step, m_task, m_tets, m_mesh, *m_model, m_solution, loads, m_shell};
  FemRecord record = record_of(solved);
  std::vector<FemReaction> reactions = m_solution.reactions;
  if (m_settings.outside == TetOutside::held) reactions.pop_back();
  record.reactions = sums_over(m_task.gripped, grips, reactions);
  for (std::size_t n = 0; n < grips.size(); ++n) {
    if (grips[n].is_anchor()) record.anchors = reactions[n];
  }
  return record;
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
  warn_of_tets(step, record, progress);
  return record;
}

}  // namespace supple

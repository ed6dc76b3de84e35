#include "lib/model/fem_motion.h"

#include <algorithm>

#include "lib/model/held_corners.h"
#include "lib/model/quasi_static.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

bool is_zero(const std::vector<Vec3d>& values) {
  return std::all_of(values.begin(), values.end(), [](const Vec3d& of) { return of == Vec3d(0); });
}

bool is_held(const NodalLoads& loads, std::size_t n) {
  return (loads.held[n / 3] >> n % 3 & 1) != 0;
}

/// Sets held components to the values that `loads` has for them.
void take_held(const NodalLoads& loads, std::vector<double>& values) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (is_held(loads, n)) values[n] = loads.u_mm[n];
  }
}

}  // namespace

VoxelFemMotion::VoxelFemMotion(const HeldBody& held, FemMotionParams params, const Body* shape,
                               Progress* progress)
    : m_held(held),
      m_model(shape != nullptr ? *shape : held.body, params.elastic, params.elements, progress),
      m_params(std::move(params)) {
  m_params.newmark.validate();
  m_params.damping.validate();
}

FemNodes VoxelFemMotion::nodes_of_body(const NodalLoads& held) const {
  const HexMesh& mesh = m_model.mesh();
  const Body& body = m_held.body;
  const std::vector<Vec3d> moved = element_displacements(mesh, body);
  const std::vector<Vec3d> velocities = element_velocities(mesh, body);
  FemNodes nodes;
  if (m_start.u_mm.size() == 3 * std::size_t(mesh.node_count()) && m_start.elements_mm == moved) {
    nodes = m_start;
  } else {
    nodes.u_mm = at_nodes(mesh, body, moved);
    take_held(held, nodes.u_mm);
    if (!is_zero(velocities)) nodes.v_mm_s = at_nodes(mesh, body, velocities);
  }
  if (nodes.v_mm_s.empty()) nodes.v_mm_s.assign(nodes.u_mm.size(), 0.0);
  return nodes;
}

void VoxelFemMotion::move(const std::vector<Handle>& handles, int steps, Progress* progress) {
  const Body& body = m_held.body;
  const HexMesh& mesh = m_model.mesh();
  const FixedElements fixed = fix(body, m_held.anchors);
  HeldVoxels found = hold(body, handles, fixed, m_held.holds);
  m_grips = fem_grips(body, found, m_told);
  const VoxelCorners corners(mesh, body, nullptr);
  const HeldCorners at_end(corners, m_grips, true);
  m_reaches = at_end.reaches();
  m_params.loads.held = at_end.elements();
  FemLoads start;  // where what is held begins
  start.held = HeldCorners(corners, m_grips, false).elements();
  const NodalLoads before = nodal_loads(mesh, m_model.material(), start);
  FemNodes nodes = nodes_of_body(before);
  std::vector<double>& u = nodes.u_mm;
  NodalLoads loads = nodal_loads(mesh, m_model.material(), m_params.loads);
  // Nodes that are held where they are stay exactly there.
  for (std::size_t n = 0; n < u.size(); ++n) {
    if (is_held(loads, n) && loads.u_mm[n] == before.u_mm[n]) loads.u_mm[n] = u[n];
  }
  const HeldBits by_grips = loads.held;
  const bool holds_some = !m_grips.empty();
  m_loose = m_model.hold_loose(holds_some && m_params.loose == LooseIslands::hold, loads.held);
  if (holds_some && m_loose.loose_islands > 0 && m_params.loose == LooseIslands::refuse) {
    throw InputError({"", "finite elements",
                      std::to_string(m_loose.loose_islands) + " pieces of " +
                          std::to_string(m_loose.loose_elements) + " elements that nothing holds",
                      "every piece held so that it cannot move as a rigid body"});
  }
  for (std::size_t n = 0; n < u.size(); ++n) {
    if (((loads.held[n / 3] & ~by_grips[n / 3]) >> n % 3 & 1) != 0) loads.u_mm[n] = u[n];
  }
  m_newmark = std::make_unique<Newmark>(m_model, m_params.density, m_params.damping,
                                        std::move(loads), m_params.newmark, progress);
  m_newmark->start(std::move(u), std::move(nodes.v_mm_s), progress);
  m_steps = steps;
  found.rest.anchored.add(found.grabbed);
  m_held.holds = std::move(found.rest);
}

bool VoxelFemMotion::step(const Progress* progress) {
  const double h = m_params.newmark.step_s;
  m_newmark->step(smooth_way((m_newmark->steps() + 1) * h, m_steps * h), progress);
  return true;
}

ModelEnergy VoxelFemMotion::energy() {
  const MotionEnergy energy = m_newmark->energy();
  return {energy.elastic_mj * kJPerMj, energy.kinetic_mj * kJPerMj, 0};
}

std::vector<Reaction> VoxelFemMotion::reactions(const std::vector<Handle>& handles) {
  std::vector<Reaction> found;
  for (const FemReaction& reaction : reactions(elements_of_handles(m_held.body, handles))) {
    found.push_back({reaction.force_n});
  }
  return found;
}

std::vector<FemReaction> VoxelFemMotion::reactions(const std::vector<SlotSet>& elements) const {
  return sums_over(elements, m_grips,
                   reactions_of(m_model, m_newmark->loads(), m_newmark->reaction_mn()));
}

FemReaction VoxelFemMotion::anchor_reaction() const {
  const auto anchors = std::find_if(m_grips.begin(), m_grips.end(),
                                    [](const FemGrip& grip) { return grip.is_anchor(); });
  if (anchors == m_grips.end()) return {};
  return reactions({anchors->slots}).front();
}

void VoxelFemMotion::store() {
  if (!m_newmark) return;
  const HexMesh& mesh = m_model.mesh();
  give_to_body(at_centres(mesh, m_newmark->u_mm()), at_centres(mesh, m_newmark->v_mm_s()), m_grips,
               m_newmark->steps() >= m_steps, m_held.body);
}

}  // namespace supple

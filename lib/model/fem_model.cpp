#include "lib/model/fem_model.h"

#include "lib/model/quasi_static.h"

namespace supple {

ElasticTable material_elasticity(const MaterialTable& material) {
  ElasticTable table;
  const MaterialClasses classes(material);
  for (int c = 0; c <= kLastClass; ++c) {
    table.young_kpa[std::size_t(c)] = classes.physics(c, c).stiffness_kpa;
    table.poisson[std::size_t(c)] = classes.poisson_of_class(c);
  }
  return table;
}

VoxelFemModel::VoxelFemModel(const HeldBody& held, const ElasticTable& elastic, FemLoads loads,
                             const FemParams& params, const Body* shape, Progress* progress)
    : m_held(held),
      m_model(shape != nullptr ? *shape : held.body, elastic, Dilatation::mean, progress),
      m_loads(std::move(loads)),
      m_params(params) {
  params.validate();
}

void VoxelFemModel::move(const std::vector<Handle>& handles, int, Progress* progress) {
  const FixedElements fixed = fix(m_held.body, m_held.anchors);
  HeldVoxels found = hold(m_held.body, handles, fixed, m_held.holds);
  m_grips = fem_grips(m_held.body, found, m_told);
  m_loads.held.clear();
  for (const FemGrip& grip : m_grips) m_loads.held.push_back(held_at_end(m_held.body, grip));
  m_solution = m_model.solve(m_loads, m_params, progress);
  found.rest.anchored.add(found.grabbed);
  m_held.holds = std::move(found.rest);
}

ModelEnergy VoxelFemModel::energy() {
  return {m_solution.report.energy_mj * kJoulePerMillijoule, 0, 0};
}

std::vector<Reaction> VoxelFemModel::reactions(const std::vector<Handle>& handles) {
  std::vector<Reaction> found;
  for (const FemReaction& reaction : reactions(elements_of_handles(m_held.body, handles))) {
    found.push_back({reaction.force_n});
  }
  return found;
}

std::vector<FemReaction> VoxelFemModel::reactions(const std::vector<SlotSet>& elements) const {
  return sums_over(elements, m_grips, m_solution.reactions);
}

FemReaction VoxelFemModel::anchor_reaction() const {
  for (std::size_t n = 0; n < m_grips.size(); ++n) {
    if (m_grips[n].is_anchor) return m_solution.reactions[n];
  }
  return {};
}

void VoxelFemModel::store() {
  if (m_solution.u_mm.empty()) return;
  give_to_body(m_model.mesh(), m_solution.u_mm, {}, m_grips, true, m_held.body);
}

}  // namespace supple

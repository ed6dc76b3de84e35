#include "lib/model/voxel_ecm_model.h"

#include "lib/model/quasi_static.h"
#include "lib/relax/relaxation.h"

namespace supple {

VoxelEcmModel::VoxelEcmModel(const HeldBody& held) : m_held(held), m_solver(held.body) {}

void VoxelEcmModel::move(const std::vector<Handle>& handles, int, Progress* progress) {
  m_report = m_solver.drag(handles, m_held.anchors, m_held.holds, progress);
}

bool VoxelEcmModel::move_whole(const std::vector<Handle>& handles, Progress* progress) {
  m_report = m_solver.drag_whole(handles, m_held.anchors, m_held.holds, progress);
  return m_report.fraction_numerator == m_report.fraction_denominator;
}

bool VoxelEcmModel::allows(const std::vector<Handle>& handles, Progress* progress) {
  return m_solver.allows(handles, m_held.anchors, m_held.holds, progress);
}

ModelEnergy VoxelEcmModel::energy() {
  const SlotSet none;
  RelaxParams params;
  params.method = RelaxMethod::jacobi;
  Relaxation springs(m_held.body, none, m_held.holds, params);
  return {springs.energy() * kJoulePerMicrojoule, 0, 0};
}

std::vector<Reaction> VoxelEcmModel::reactions(const std::vector<Handle>& handles) {
  return quasi_static_reactions(m_held, elements_of_handles(m_held.body, handles), 0);
}

}  // namespace supple

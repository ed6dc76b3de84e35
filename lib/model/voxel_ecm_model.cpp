#include "lib/model/voxel_ecm_model.h"

#include "lib/chainmail/ecm.h"
#include "lib/model/quasi_static.h"
#include "lib/relax/relaxation.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple {

VoxelEcmModel::VoxelEcmModel(const HeldBody& held)
    : m_held(held), m_solver(std::make_unique<EcmSolver>(held.body)) {}

VoxelEcmModel::~VoxelEcmModel() = default;

std::size_t VoxelEcmModel::bytes() const {
  return m_solver->bytes();
}

void VoxelEcmModel::move(const std::vector<Handle>& handles, int, Progress* progress) {
  m_report = m_solver->drag(handles, m_held.anchors, m_held.holds, progress);
}

bool VoxelEcmModel::move_whole(const std::vector<Handle>& handles, Progress* progress) {
  m_report = m_solver->drag_whole(handles, m_held.anchors, m_held.holds, progress);
  return m_report.fraction_numerator == m_report.fraction_denominator;
}

bool VoxelEcmModel::move_unless_pieces_shift(const std::vector<Handle>& handles, bool whole,
                                             Progress* progress) {
  m_report =
      m_solver->drag_unless_pieces_shift(handles, m_held.anchors, m_held.holds, whole, progress);
  return m_report.shifted.empty();
}

bool VoxelEcmModel::move_whole_or_unshifted(const std::vector<Handle>& handles,
                                            Progress* progress) {
  m_report = m_solver->drag_whole_or_unshifted(handles, m_held.anchors, m_held.holds, progress);
  return m_report.fraction_numerator == m_report.fraction_denominator || m_report.shifted.empty();
}

bool VoxelEcmModel::allows(const std::vector<Handle>& handles, Progress* progress) {
  try {
    m_report = m_solver->try_whole(handles, m_held.anchors, m_held.holds, progress);
  } catch (const InputError&) {
    return false;
  }
  return m_report.fraction_numerator == m_report.fraction_denominator;
}

std::vector<std::vector<ElementBounds>> VoxelEcmModel::bounds_of(
    const std::vector<const RigidPiece*>& pieces, const std::vector<Handle>& handles,
    std::int32_t reach_q, LastingBounds& lasting, Progress* progress) {
  return m_solver->bounds_of(pieces, handles, m_held.anchors, m_held.holds, reach_q, lasting,
                             progress);
}

ModelEnergy VoxelEcmModel::energy() {
  const SlotSet none;
  RelaxParams params;
  params.method = RelaxMethod::jacobi;
  Relaxation springs(m_held.body, none, m_held.holds, params);
  return {springs.energy() * kJPerUj, 0, 0};
}

std::vector<Reaction> VoxelEcmModel::reactions(const std::vector<Handle>& handles) {
  return quasi_static_reactions(m_held, elements_of_handles(m_held.body, handles), {});
}

std::unique_ptr<Model<Handle>> make_ecm_model(const HeldBody& held) {
  return std::make_unique<VoxelEcmModel>(held);
}

}  // namespace supple

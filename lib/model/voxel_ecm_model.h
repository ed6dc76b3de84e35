// Enhanced ChainMail as a model of voxel bodies: the whole drag is done by move(), and there is
// nothing to step.
#pragma once

#include <memory>
#include <vector>

#include "lib/model/model.h"

namespace supple {

class EcmSolver;
struct ElementBounds;
struct LastingBounds;

class VoxelEcmModel final : public Model<Handle> {
 public:
  explicit VoxelEcmModel(const HeldBody& held);
  ~VoxelEcmModel() override;

  void move(const std::vector<Handle>& handles, int steps, Progress* progress) override;
  /// Moves all or nothing; false where anchors stop a part of the drag.
  bool move_whole(const std::vector<Handle>& handles, Progress* progress);
  /// move(), or move_whole(), unless free pieces would shift: false then, and report() says which.
  bool move_unless_pieces_shift(const std::vector<Handle>& handles, bool whole, Progress* progress);
  /// Does EcmSolver::drag_whole_or_unshifted(); true where anything was done.
  bool move_whole_or_unshifted(const std::vector<Handle>& handles, Progress* progress);
  /// True where anchors and other handles allow the whole drag, which is not done.
  bool allows(const std::vector<Handle>& handles, Progress* progress);
  /// EcmSolver::bounds_of()
  std::vector<std::vector<ElementBounds>> bounds_of(const std::vector<const RigidPiece*>& pieces,
                                                    const std::vector<Handle>& handles,
                                                    std::int32_t reach_q, LastingBounds& lasting,
                                                    Progress* progress);
  bool step(const Progress* = nullptr) override { return false; }
  /// The energy of the springs that relaxation would find.
  ModelEnergy energy() override;
  std::vector<Reaction> reactions(const std::vector<Handle>& handles) override;
  void store() override {}

  /// The report of the last move, done or not.
  const EcmReport& report() const { return m_report; }
  std::size_t bytes() const;

 private:
  HeldBody m_held;
  std::unique_ptr<EcmSolver> m_solver;
  EcmReport m_report;
};

}  // namespace supple

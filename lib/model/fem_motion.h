// Finite elements in time as a model of voxel bodies (lib/fem/dynamics/newmark.h): every step is
// one of time. The motion goes on from where the body is and how fast it moves; the nodes between
// its elements are those of the step before, or interpolated (fem_grips.h). Held elements go
// smoothly along straight ways, or stay; all else has inertia. Limits of links play no part.
#pragma once

#include <memory>
#include <vector>

#include "lib/fem/dynamics/newmark.h"
#include "lib/fem/voxel/fem.h"
#include "lib/model/fem_grips.h"
#include "lib/model/model.h"

namespace supple {

/// Data of a motion of finite elements, beside the body.
struct FemMotionParams {
  ElasticTable elastic;
  MassDensities density;  // kg/m^3
  RayleighDamping damping;
  NewmarkParams newmark;
  FemLoads loads;  // all but what is held
  /// Treatment of pieces that nothing holds, beside others that are held. Where nothing is held at
  /// all, all move freely.
  LooseIslands loose = LooseIslands::hold;
  ElementChoice elements = {};
};

class VoxelFemMotion final : public Model<Handle> {
 public:
  /// `shape`: elements, classes and cuts of the solid, where they are not those of the body; it
  /// is needed no more afterwards. Throws InputError as FemModel and Newmark.
  VoxelFemMotion(const HeldBody& held, FemMotionParams params, const Body* shape = nullptr,
                 Progress* progress = nullptr);

  /// Asks for the reactions of these elements, which earlier moves have left held.
  void tell_of(std::vector<SlotSet> elements) { m_told = std::move(elements); }

  /// Gives nodes from which a move() may begin, in place of interpolated ones: used where the
  /// elements of the body are still where they were with these nodes.
  void start_from(FemNodes nodes) { m_start = std::move(nodes); }

  /// Begins a motion; the handles go over the next `steps` steps (smooth_way), or are there at once
  /// with 0. Throws InputError as hold(), for push handles, and for loose islands that are refused;
  /// NotConverged; Cancelled.
  void move(const std::vector<Handle>& handles, int steps, Progress* progress) override;
  /// Always true: what rests for a moment may move again. Throws NotConverged; Cancelled, the
  /// motion as it was.
  bool step(const Progress* progress = nullptr) override;
  ModelEnergy energy() override;
  std::vector<Reaction> reactions(const std::vector<Handle>& handles) override;
  /// Gives the body offsets and velocities. Throws InputError for an offset beyond the range, the
  /// body unchanged.
  void store() override;

  /// Reactions as VoxelFemModel's, of this moment.
  std::vector<FemReaction> reactions(const std::vector<SlotSet>& elements) const;
  FemReaction anchor_reaction() const;
  /// Reaches and grips as VoxelFemModel's, of the end of the handles' ways.
  const std::vector<GripReach>& reaches() const { return m_reaches; }
  const std::vector<FemGrip>& grips() const { return m_grips; }
  const Newmark& motion() const { return *m_newmark; }
  const FemModel& solid() const { return m_model; }
  /// Pieces that nothing holds, and how many of them stay where they are therefore.
  const LooseCount& loose() const { return m_loose; }
  std::int64_t held_islands() const { return m_grips.empty() ? 0 : m_loose.loose_islands; }
  std::size_t bytes() const { return m_model.bytes() + m_newmark->bytes(); }

 private:
  /// Nodes where the body is; held ones are where `held` has them, unless start_from() gave all.
  FemNodes nodes_of_body(const NodalLoads& held) const;
  HeldBody m_held;
  FemModel m_model;
  FemMotionParams m_params;
  std::vector<SlotSet> m_told;
  std::vector<FemGrip> m_grips;
  std::vector<GripReach> m_reaches;
  std::unique_ptr<Newmark> m_newmark;
  LooseCount m_loose;
  FemNodes m_start;
  int m_steps = 0;  // of the handles' ways
};

}  // namespace supple

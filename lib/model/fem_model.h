// Finite elements as a model of voxel bodies (lib/fem/voxel/fem.h): one linear problem per move,
// whose displacements count from rest. Held elements prescribe the corners of their voxels; the
// offset of a voxel is the mean of its eight corners. Limits of links play no part, and nothing is
// remembered: the result depends on what is held where, and on the loads, not on where the rest of
// the body was before.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "lib/fem/response/response_set.h"
#include "lib/model/fem_grips.h"
#include "lib/model/model.h"
#include "lib/model/refined_shape.h"
#include "volumes/base/fields.h"

namespace supple {

/// Young's modulus and Poisson's ratio of the body's material, or their defaults (material.h).
ElasticTable material_elasticity(const MaterialTable& material);

class VoxelFemModel final : public Model<Handle> {
 public:
  /// `shape`: elements, classes and cuts of the solid, where they are not those of the body; it
  /// must outlive this. `loads` are all but what is held. `halvings`: of the voxels'
  /// edges, for smaller elements (refined_shape.h). Throws InputError as FemModel.
  VoxelFemModel(const HeldBody& held, const ElasticTable& elastic, FemLoads loads = {},
                const FemParams& params = {}, const Body* shape = nullptr, int halvings = 0,
                Progress* progress = nullptr);

  /// The next move begins from an earlier equilibrium, whose result differs within the tolerance.
  void begin_from(std::shared_ptr<const NodeStart> start) { m_start = std::move(start); }
  /// Shares the elements of another model of the same body, which may be elsewhere and held
  /// otherwise; touching voxels are apart.
  VoxelFemModel(const HeldBody& held, const VoxelFemModel& of);

  /// Moves are sums of these solutions, which must be those of this model, and add theirs; null:
  /// each is solved by itself. Outlives the moves.
  void sum_by(ResponseSet* known) { m_known = known; }
  /// Loads and parameters of the moves from now on; elements stay of the kind that they are.
  void set_loads(FemLoads loads);
  void set_params(const FemParams& params) { m_params = params; }
  /// Asks for the reactions of these elements, which earlier moves have left held.
  void tell_of(std::vector<SlotSet> elements) { m_told = std::move(elements); }

  /// The loads of a move of these handles, which moves nothing. Throws as move().
  const FemLoads& loads_of(const std::vector<Handle>& handles, Progress* progress);

  /// Solves. Throws InputError as hold(), and for push handles, whose sides linear equations do not
  /// know; NotConverged; Cancelled.
  void move(const std::vector<Handle>& handles, int steps, Progress* progress) override;
  bool step(const Progress* = nullptr) override { return false; }
  /// The elastic energy of the last move.
  ModelEnergy energy() override;
  /// The reactions of handles of the last move, or of elements told of before it.
  std::vector<Reaction> reactions(const std::vector<Handle>& handles) override;
  /// Throws InputError for an offset beyond the range, the body unchanged.
  void store() override;

  /// The reactions summed over each of the sets; moments are about the mean of their nodes.
  std::vector<FemReaction> reactions(const std::vector<SlotSet>& elements) const;
  /// The reaction of anchors alone.
  FemReaction anchor_reaction() const;
  /// Grips of the last move that share corners, and grips() in their order.
  const std::vector<GripReach>& reaches() const { return m_reaches; }
  const std::vector<FemGrip>& grips() const { return m_grips; }
  /// Report of the last move. Its energy is without the false strain of rigid pieces that are held.
  const FemReport& report() const { return m_solution.report; }
  const FemModel& solid() const { return *m_model; }
  /// Displacements of the voxels' centres, in the order of the bricks.
  std::vector<Vec3d> centres_mm(const std::vector<double>& u_mm) const;
  /// The elements of its mesh that the voxels of the body consist of, in the order of the bricks;
  /// empty where each is one element.
  std::vector<std::vector<std::int32_t>> parts() const;
  /// The displacements of the nodes of its mesh.
  const std::vector<double>& displacement_mm() const { return m_solution.u_mm; }
  /// The pressure within each of its elements that the last move had; empty where none swells.
  const std::vector<double>& swelling_kpa() const { return m_solution.swelling_kpa; }

 private:
  HeldVoxels find(const std::vector<Handle>& handles, const FixedElements& fixed,
                  Progress* progress);
  void hold_corners();
  const Body& shape() const;
  double false_energy_mj() const;

  HeldBody m_held;
  const Body* m_shape;                            // or null
  std::shared_ptr<const RefinedShape> m_refined;  // or null
  std::shared_ptr<FemModel> m_model;
  FemLoads m_loads;
  FemParams m_params;
  std::shared_ptr<const NodeStart> m_start;
  ResponseSet* m_known = nullptr;
  std::vector<SlotSet> m_told;
  std::vector<FemGrip> m_grips;  // of the last move, in the order of its held elements
  std::vector<GripReach> m_reaches;
  FemSolution m_solution;
};

/// How exactly systems of equations are solved, and by whom.
Fields solver_fields(FemParams& params);

}  // namespace supple

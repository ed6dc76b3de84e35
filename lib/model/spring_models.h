// Springs as models of voxel bodies and of mesh bodies: steps of time, or a minimisation of the
// energy. Limits of links play no part, so the result may be no valid ChainMail configuration. The
// next ECM drag or relaxation projects it and says so (thesis section 4.2.3, second method).
//
// Fixed nodes and handles are held nodes. Velocities go from the body to the springs and back; a
// minimum has none.
#pragma once

#include "lib/model/model.h"
#include "lib/model/spring_motion.h"
#include "lib/springs/lattice_springs.h"
#include "lib/springs/mesh_springs.h"

namespace supple {

class VoxelSpringModel final : public Model<Handle> {
 public:
  /// Throws InputError as make_springs and MotionParams::validate, for an anchor without element
  /// and for push handles that are still held: springs know no one-sided handles; Cancelled.
  VoxelSpringModel(const HeldBody& held, const LatticeSpringParams& springs,
                   const MotionParams& params, const Progress* progress = nullptr);

  /// Throws InputError for push handles, too.
  void move(const std::vector<Handle>& handles, int steps, Progress* progress) override;
  bool step(const Progress* progress = nullptr) override { return m_motion.step(progress); }
  ModelEnergy energy() override { return m_motion.energy(); }
  std::vector<Reaction> reactions(const std::vector<Handle>& handles) override;
  /// The same of any elements.
  std::vector<Reaction> reactions(const std::vector<SlotSet>& elements) const;
  void store() override { give_state(m_springs, m_held.body); }

  const SpringMotion& motion() const { return m_motion; }
  const SpringSystem& system() const { return m_springs.system; }

 private:
  std::vector<int> nodes_of(const SlotSet& slots) const;

  HeldBody m_held;
  LatticeSprings m_springs;
  SpringMotion m_motion;
};

class MeshSpringModel final : public Model<MeshHandle> {
 public:
  /// Throws InputError as make_springs and MotionParams::validate, for an anchor or held
  /// nodes that name no node.
  MeshSpringModel(const HeldMesh& held, const MeshSpringParams& springs,
                  const MotionParams& params);

  /// Throws InputError as MeshEcm::drag for indices, for push handles, and for moves that are not
  /// finite.
  void move(const std::vector<MeshHandle>& handles, int steps, Progress* progress) override;
  bool step(const Progress* progress = nullptr) override { return m_motion.step(progress); }
  ModelEnergy energy() override { return m_motion.energy(); }
  std::vector<Reaction> reactions(const std::vector<MeshHandle>& handles) override;
  void store() override { give_state(m_system, m_held.body); }

  const SpringMotion& motion() const { return m_motion; }
  const SpringSystem& system() const { return m_system; }

 private:
  HeldMesh m_held;
  SpringSystem m_system;
  SpringMotion m_motion;
};

}  // namespace supple

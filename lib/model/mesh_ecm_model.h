// Enhanced ChainMail as a model of mesh bodies: the whole drag is done by move(), and there is
// nothing to step.
#pragma once

#include "lib/chainmail/mesh_ecm.h"
#include "lib/model/model.h"

namespace supple {

class MeshEcmModel final : public Model<MeshHandle> {
 public:
  /// Throws InputError as MeshEcm.
  MeshEcmModel(const HeldMesh& held, const MeshLimits& limits);

  void move(const std::vector<MeshHandle>& handles, int steps, Progress* progress) override;
  bool step(const Progress* = nullptr) override { return false; }
  /// ChainMail knows limits only: no energy, and no force at any handle.
  ModelEnergy energy() override { return {}; }
  std::vector<Reaction> reactions(const std::vector<MeshHandle>& handles) override {
    return std::vector<Reaction>(handles.size());
  }
  void store() override {}

  /// The report of the last move.
  const MeshEcmReport& report() const { return m_report; }

 private:
  HeldMesh m_held;
  MeshEcm m_ecm;
  MeshEcmReport m_report;
};

}  // namespace supple

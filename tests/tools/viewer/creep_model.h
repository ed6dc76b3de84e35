// Creep, a model that tests add to those of the library: each pass takes every handle some voxels
// on, and Enhanced ChainMail puts the body in order.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "lib/model/voxel_ecm_model.h"
#include "lib/session/step.h"
#include "lib/session/step_model.h"

namespace supple::test {

struct CreepStep {
  double voxels = 1;
  int passes = 100;
};

inline Fields fields(CreepStep& step) {
  return {Field("voxels", step.voxels, "How far each pass goes").positive(),
          Field("passes", step.passes, "At most so many").range(1, 1000)};
}

inline int step_count(const CreepStep& step) {
  return step.passes;
}

inline ModelCost cost_of(const CreepStep& step, const Body& body) {
  ModelCost cost{{double(body.elements.active_count()), "elements"},
                 {double(step.passes), "passes"}};
  cost.bytes = 12 * cost.size.count;
  cost.units = cost.size.count * cost.passes.count;
  cost.unit = {"creep_element", 20, "An element, per pass"};
  return cost;
}

class Creep final : public Model<Handle> {
 public:
  Creep(const CreepStep& step, const HeldBody& held)
      : m_most_q(std::int32_t(step.voxels * kFixedOne)), m_ecm(held) {}

  void move(const std::vector<Handle>& handles, int, Progress*) override { m_left = handles; }
  bool step(const Progress*) override {
    std::vector<Handle> now = m_left;
    bool moves = false;
    for (std::size_t n = 0; n < now.size(); ++n) {
      for (std::size_t c = 0; c < 3; ++c) {
        now[n].by_q[c] = std::clamp(m_left[n].by_q[c], -m_most_q, m_most_q);
        m_left[n].by_q[c] -= now[n].by_q[c];
        moves = moves || now[n].by_q[c] != 0;
      }
    }
    if (moves) m_ecm.move(now, 1, nullptr);
    return moves;
  }
  ModelEnergy energy() override { return m_ecm.energy(); }
  std::vector<Reaction> reactions(const std::vector<Handle>& handles) override {
    return m_ecm.reactions(handles);
  }
  void store() override { m_ecm.store(); }

 private:
  std::int32_t m_most_q;
  VoxelEcmModel m_ecm;
  std::vector<Handle> m_left;
};

inline std::unique_ptr<Model<Handle>> make_model(const CreepStep& step, const HeldBody& held) {
  return std::make_unique<Creep>(step, held);
}

inline StepModel creep_model() {
  StepModel model = own_model<CreepStep>("creep", "creep");
  const auto solve = [](Step& step, double voxels) { step.own = CreepStep{voxels, 100}; };
  model.methods = {{{"creep", "creep", "voxels", 0.01, 100, false, {4, 1, 0.25}}, 0, solve}};
  return model;
}

}  // namespace supple::test

// Relaxation as a model of voxel bodies: handles are moved by Enhanced ChainMail, then every step
// is a pass.
#pragma once

#include <chrono>
#include <memory>

#include "lib/model/model.h"
#include "lib/relax/cell_moduli.h"
#include "lib/relax/relax_report.h"
#include "lib/relax/relaxation.h"

namespace supple {

class RelaxModel final : public Model<Handle> {
 public:
  /// An invalid start is projected first, as drag() does. Throws InputError, the body unchanged:
  /// params out of range, an anchor without element.
  RelaxModel(const HeldBody& held, const RelaxParams& params);
  ~RelaxModel() override;

  void move(const std::vector<Handle>& handles, int steps, Progress* progress) override;
  /// False when converged, when no element can move any more, or when the budget is spent.
  bool step(const Progress* progress = nullptr) override;
  /// The part of the budget that is spent.
  double part_done() const override;
  ModelEnergy energy() override;
  std::vector<Reaction> reactions(const std::vector<Handle>& handles) override;
  /// Ends with plastic flow, where links have yielded in passes since the last store().
  void store() override;

  /// The report of all passes and stores so far; its last energy costs as much as a pass.
  RelaxReport report();

 private:
  void begin();
  bool forces_agree();
  void put();
  bool knows_all_links() const;
  void keep_diagonals();

  HeldBody m_held;
  RelaxParams m_params;
  CellModuli m_moduli;
  SlotSet m_anchored;
  std::unique_ptr<Relaxation> m_relaxation;
  RelaxReport m_report;
  int m_stored_passes = 0;
  int m_next_look = 0;  // pass in which the forces are asked next
  double m_work = 0;    // of earlier relaxations, when a move began a new one
  std::optional<double> m_energy_before_flow;  // uJ, since the last step
  std::chrono::steady_clock::time_point m_begin;
};

/// Makes up to params.passes passes of a body whose elements in `fixed` and `held.anchored` stay,
/// and those of push handles at or beyond where they were pushed to; then plastic flow. `progress`
/// may cancel between two passes: Cancelled is thrown, and the body is as after a relaxation of
/// that many passes. Throws InputError as RelaxModel.
RelaxReport relax(Body& body, const std::vector<Region>& fixed, const Holds& held,
                  const RelaxParams& params, Progress* progress = nullptr);

}  // namespace supple

// Steps that a session can take back: after each one the bricks that it changed, as they were.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/body/node_change.h"
#include "lib/session/session_body.h"
#include "volumes/base/value.h"

namespace supple {

/// Memory of all steps that can be taken back; beyond that the oldest go.
constexpr std::size_t kMostUndoBytes = std::size_t(512) << 20;

/// A material, and a body's classes and slacks that it leads to.
struct MaterialBefore {
  MaterialTable material;
  std::string toml;
  std::vector<std::uint8_t> classes;
  SlackTable slacks;
};

class UndoHistory {
 public:
  explicit UndoHistory(SessionBody& session) : m_in(session) {}

  /// Notes the body before a step.
  void begin(const Step& step);
  /// Makes the body as it was when the step began.
  void give_up();
  /// The step is done: only what it changed is kept, and of the oldest steps nothing where all take
  /// too much. `handed_over`: nodes of the step before.
  void keep(FemNodes handed_over);
  /// Takes the last step back; returns the nodes of the step before.
  FemNodes take_back();
  std::size_t steps() const { return m_kept.size(); }
  std::size_t bytes() const { return m_bytes; }

 private:
  struct Before {
    std::optional<NodeChange> change;          // once the step is done
    std::optional<LinkCuts> cuts, state_cuts;  // once the step is done, where it changed them
    RigidPieces rigid;
    bool links_known_valid;
    BeyondLimits beyond;
    LinkCheck links;
    std::vector<IndexBox> anchors;
    std::vector<std::int32_t> anchor_labels;
    std::vector<Value> anchor_selections;
    Holds holds;
    HandleLedger ledger;
    RelaxParams relaxed_by;
    std::shared_ptr<const MaterialBefore> material;  // before it changes
    FemNodes handed_over;                            // by the record of the step before
    /// The start of pictures before the step, where the step has replaced it.
    std::optional<std::shared_ptr<const NodeStart>> equilibrium;
    /// All else of the state and the body, before elements are removed.
    std::shared_ptr<std::pair<State, Body>> whole;

    std::size_t bytes() const;
  };

  void restore(Before&& before);

  SessionBody& m_in;
  std::optional<Before> m_begun;
  std::deque<Before> m_kept;
  std::unique_ptr<StepNodes> m_nodes;  // of the body between steps; null: of no step yet
  std::size_t m_bytes = 0;
};

}  // namespace supple

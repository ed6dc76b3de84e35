// Data that a session keeps of itself before a step, for its own sources.
#pragma once

#include <memory>
#include <optional>

#include "lib/session/node_change.h"
#include "lib/session/session.h"
#include "volumes/base/value.h"

namespace supple {

/// A material, and a body's classes and slacks that it leads to.
struct MaterialBefore {
  MaterialTable material;
  std::string toml;
  std::vector<std::uint8_t> classes;
  SlackTable slacks;
};

struct Session::Before {
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

}  // namespace supple

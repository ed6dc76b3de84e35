// Data that a session keeps of itself before a step, for its own sources.
#pragma once

#include <memory>
#include <optional>

#include "lib/session/node_change.h"
#include "lib/session/session.h"
#include "volumes/base/value.h"

namespace supple {

/// What a material makes of a body.
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
  /// Where the step has replaced it.
  std::optional<std::shared_ptr<const NodeStart>> equilibrium;
  /// Before elements are removed: all else of the state and the body.
  std::shared_ptr<std::pair<State, Body>> whole;

  std::size_t bytes() const;
};

}  // namespace supple

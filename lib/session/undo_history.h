// Steps that a session can take back: after each one the bricks that it changed, as they were.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lib/body/node_change.h"
#include "lib/session/deformable_mesh.h"
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
  /// Keeps a step of a mesh body by the shape that it had before.
  void keep(const std::string& mesh, DeformableMesh::Shape before);
  /// Takes the last step back, of whichever body; returns the nodes of the step before.
  FemNodes take_back(std::vector<DeformableMesh>& meshes);
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
    /// Solutions of finite elements before it, likewise.
    std::optional<std::shared_ptr<const FemResponses>> responses;
    std::size_t responses_bytes = 0;  // of what later steps do not share
    /// All else of the state and the body, before elements are removed.
    std::shared_ptr<std::pair<State, Body>> whole;

    std::size_t bytes() const;
  };
  struct MeshBefore {
    std::string name;
    DeformableMesh::Shape shape;

    std::size_t bytes() const;
  };
  using Kept = std::variant<Before, MeshBefore>;
  static std::size_t size_of(const Kept& kept);
  void keep(Kept&& kept);

  void restore(Before&& before);

  SessionBody& m_in;
  std::optional<Before> m_begun;
  std::deque<Kept> m_kept;
  std::unique_ptr<StepNodes> m_nodes;  // of the body between steps; null: of no step yet
  std::size_t m_bytes = 0;
};

}  // namespace supple

// The part of a session that takes steps back.
#include <stdexcept>

#include "lib/session/session_before.h"

namespace supple {

namespace {

std::size_t bytes_of(const SlotSet& set) {
  return set.bricks().size() * sizeof(SlotSet::Brick);
}

}  // namespace

std::size_t Session::Before::bytes() const {
  std::size_t total = sizeof *this + (change ? change->bytes() : 0) +
                      (material ? material->classes.size() : 0) + (cuts ? cuts->bytes() : 0) +
                      (state_cuts ? state_cuts->bytes() : 0) + bytes_of(holds.anchored) +
                      rigid.list.size() * sizeof(RigidPiece) + (whole ? whole->second.bytes() : 0);
  for (std::size_t c = 0; c < 3; ++c) {
    total += (holds.at_least[c].size() + holds.at_most[c].size()) * sizeof(Bound);
  }
  for (const SlotSet& held : ledger.elements()) total += bytes_of(held);
  if (equilibrium && *equilibrium) total += (*equilibrium)->size() * sizeof(float);
  return total + (handed_over.u_mm.size() + handed_over.v_mm_s.size()) * sizeof(double) +
         handed_over.elements_mm.size() * sizeof(Vec3d);
}

Session::Before Session::before(const Step& request) {
  if (!m_nodes_before) m_nodes_before = std::make_unique<StepNodes>(m_body);
  return {
      std::nullopt,
      m_body.cuts,
      m_state.cuts,
      m_body.rigid,
      m_body.links_known_valid,
      m_body.beyond,
      m_links,
      m_state.anchors,
      m_state.anchor_labels,
      m_state.anchor_selections,
      m_holds,
      m_ledger,
      m_relaxed_by,
      request.material ? std::make_shared<const MaterialBefore>(MaterialBefore{
                             m_material, m_state.material_toml, m_body.classes, m_body.slacks})
                       : nullptr,
      {},
      m_equilibrium,
      request.remove.empty() ? nullptr : std::make_shared<std::pair<State, Body>>(m_state, m_body)};
}

void Session::restore(Before&& before) {
  m_lips_before.reset();
  if (before.whole) {
    m_state = std::move(before.whole->first);
    m_body = std::move(before.whole->second);
    m_ecm = std::make_unique<VoxelEcmModel>(held());
    m_nodes_before.reset();
  } else if (before.change) {
    before.change->take_back(m_body);
    if (m_nodes_before) m_nodes_before->follow(m_body, *before.change);
  } else {
    NodeChange(*m_nodes_before, m_body).take_back(m_body);
  }
  if (before.material) {
    m_material = before.material->material;
    m_state.material_toml = before.material->toml;
    m_body.material = m_material;
    m_body.classes = before.material->classes;
    m_body.slacks = before.material->slacks;
    m_ecm = std::make_unique<VoxelEcmModel>(held());
  }
  if (before.cuts) m_body.cuts = std::move(*before.cuts);
  if (before.state_cuts) m_state.cuts = std::move(*before.state_cuts);
  m_body.rigid = std::move(before.rigid);
  m_body.links_known_valid = before.links_known_valid;
  m_body.beyond = std::move(before.beyond);
  m_links = before.links;
  m_state.anchors = std::move(before.anchors);
  m_state.anchor_labels = std::move(before.anchor_labels);
  m_state.anchor_selections = std::move(before.anchor_selections);
  m_holds = std::move(before.holds);
  m_ledger = std::move(before.ledger);
  m_relaxed_by = before.relaxed_by;
  if (before.equilibrium) m_equilibrium = std::move(*before.equilibrium);
  find_anchors();
}

/// The step is done: only what it changed is kept, and of the oldest steps nothing where all take
/// too much.
void Session::keep(Before&& before) {
  if (before.whole) {
    m_nodes_before.reset();
  } else {
    before.change.emplace(*m_nodes_before, m_body);
    m_nodes_before->follow(m_body, *before.change);
  }
  if (!before.whole && *before.cuts == m_body.cuts) before.cuts.reset();
  if (!before.whole && *before.state_cuts == m_state.cuts) before.state_cuts.reset();
  if (*before.equilibrium == m_equilibrium) before.equilibrium.reset();
  m_undo_bytes += before.bytes();
  m_undo.push_back(std::move(before));
  while (m_undo.size() > 1 && m_undo_bytes > kMostUndoBytes) {
    m_undo_bytes -= m_undo.front().bytes();
    m_undo.pop_front();
  }
}

std::size_t Session::undo_steps() const {
  return m_undo.size();
}

bool Session::undo() {
  if (!m_keeps_undo)
    throw std::logic_error("undo() of a session without SessionOptions::keeps_undo");
  if (m_undo.empty()) return false;
  m_undo_bytes -= m_undo.back().bytes();
  FemNodes handed_over = std::move(m_undo.back().handed_over);
  restore(std::move(m_undo.back()));
  m_undo.pop_back();
  m_records.pop_back();
  if (!m_records.empty()) m_records.back().equilibrium.nodes = std::move(handed_over);
  m_pose.reset();
  return true;
}

}  // namespace supple

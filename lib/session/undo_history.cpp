#include "lib/session/undo_history.h"

#include <algorithm>

#include "lib/session/kept_voxels.h"

namespace supple {

namespace {

std::size_t bytes_of(const SlotSet& set) {
  return set.bricks().size() * sizeof(SlotSet::Brick);
}

}  // namespace

std::size_t UndoHistory::Before::bytes() const {
  std::size_t total = sizeof *this + (change ? change->bytes() : 0) +
                      (material ? material->classes.size() : 0) + (cuts ? cuts->bytes() : 0) +
                      (state_cuts ? state_cuts->bytes() : 0) + bytes_of(holds.anchored) +
                      rigid.list.size() * sizeof(RigidPiece) + (whole ? whole->second.bytes() : 0);
  for (std::size_t c = 0; c < 3; ++c) {
    total += (holds.at_least[c].size() + holds.at_most[c].size()) * sizeof(Bound);
  }
  for (const SlotSet& held : ledger.elements()) total += bytes_of(held);
  if (equilibrium && *equilibrium) total += (*equilibrium)->size() * sizeof(float);
  total += responses_bytes;
  return total + (handed_over.u_mm.size() + handed_over.v_mm_s.size()) * sizeof(double) +
         handed_over.elements_mm.size() * sizeof(Vec3d);
}

std::size_t UndoHistory::MeshBefore::bytes() const {
  return sizeof *this + (shape.pos_mm.size() + shape.velocity_mm_s.size()) * sizeof(Vec3d) +
         (shape.fixed.size() + shape.held.size()) * sizeof(int);
}

std::size_t UndoHistory::size_of(const Kept& kept) {
  return std::visit([](const auto& before) { return before.bytes(); }, kept);
}

void UndoHistory::begin(const Step& step) {
  if (!m_nodes) m_nodes = std::make_unique<StepNodes>(m_in.body);
  m_begun = Before{
      std::nullopt,
      m_in.body.cuts,
      m_in.state.cuts,
      m_in.body.rigid,
      m_in.body.links_known_valid,
      m_in.body.beyond,
      m_in.links,
      m_in.state.anchors,
      m_in.state.anchor_labels,
      m_in.state.anchor_selections,
      m_in.holds,
      m_in.ledger,
      m_in.relaxed_by,
      step.material
          ? std::make_shared<const MaterialBefore>(MaterialBefore{
                m_in.material, m_in.state.material_toml, m_in.body.classes, m_in.body.slacks})
          : nullptr,
      {},
      m_in.equilibrium,
      m_in.responses,
      0,
      step.remove.empty() ? nullptr
                          : std::make_shared<std::pair<State, Body>>(m_in.state, m_in.body)};
}

void UndoHistory::give_up() {
  restore(std::move(*m_begun));
  m_begun.reset();
}

void UndoHistory::restore(Before&& before) {
  m_in.contact.lips_before.reset();
  if (before.whole) {
    m_in.state = std::move(before.whole->first);
    m_in.body = std::move(before.whole->second);
    m_in.ecm = std::make_unique<VoxelEcmModel>(m_in.held());
    m_nodes.reset();
  } else if (before.change) {
    before.change->take_back(m_in.body);
    if (m_nodes) m_nodes->follow(m_in.body, *before.change);
  } else {
    NodeChange(*m_nodes, m_in.body).take_back(m_in.body);
  }
  if (before.material) {
    m_in.material = before.material->material;
    m_in.state.material_toml = before.material->toml;
    m_in.body.material = m_in.material;
    m_in.body.classes = before.material->classes;
    m_in.body.slacks = before.material->slacks;
    m_in.ecm = std::make_unique<VoxelEcmModel>(m_in.held());
  }
  if (before.cuts) m_in.body.cuts = std::move(*before.cuts);
  if (before.state_cuts) m_in.state.cuts = std::move(*before.state_cuts);
  m_in.body.rigid = std::move(before.rigid);
  m_in.body.links_known_valid = before.links_known_valid;
  m_in.body.beyond = std::move(before.beyond);
  m_in.links = before.links;
  m_in.state.anchors = std::move(before.anchors);
  m_in.state.anchor_labels = std::move(before.anchor_labels);
  m_in.state.anchor_selections = std::move(before.anchor_selections);
  m_in.holds = std::move(before.holds);
  m_in.ledger = std::move(before.ledger);
  m_in.relaxed_by = before.relaxed_by;
  if (before.equilibrium) m_in.equilibrium = std::move(*before.equilibrium);
  if (before.responses) m_in.responses = std::move(*before.responses);
  m_in.find_anchors();
}

void UndoHistory::keep(FemNodes handed_over) {
  Before& before = *m_begun;
  before.handed_over = std::move(handed_over);
  if (before.whole) {
    m_nodes.reset();
  } else {
    before.change.emplace(*m_nodes, m_in.body);
    m_nodes->follow(m_in.body, *before.change);
  }
  if (!before.whole && *before.cuts == m_in.body.cuts) before.cuts.reset();
  if (!before.whole && *before.state_cuts == m_in.state.cuts) before.state_cuts.reset();
  if (*before.equilibrium == m_in.equilibrium) before.equilibrium.reset();
  if (*before.responses == m_in.responses) {
    before.responses.reset();
  } else if (*before.responses) {
    before.responses_bytes = (*before.responses)->bytes_beyond(m_in.responses.get());
  }
  keep(Kept(std::move(before)));
  m_begun.reset();
}

void UndoHistory::keep(const std::string& mesh, DeformableMesh::Shape before) {
  keep(Kept(MeshBefore{mesh, std::move(before)}));
}

void UndoHistory::keep(Kept&& kept) {
  m_bytes += size_of(kept);
  m_kept.push_back(std::move(kept));
  while (m_kept.size() > 1 && m_bytes > kMostUndoBytes) {
    m_bytes -= size_of(m_kept.front());
    m_kept.pop_front();
  }
}

FemNodes UndoHistory::take_back(std::vector<DeformableMesh>& meshes) {
  Kept kept = std::move(m_kept.back());
  m_kept.pop_back();
  m_bytes -= size_of(kept);
  if (auto* of_mesh = std::get_if<MeshBefore>(&kept)) {
    const auto is_it = [&](const DeformableMesh& mesh) { return mesh.name() == of_mesh->name; };
    std::find_if(meshes.begin(), meshes.end(), is_it)->restore(std::move(of_mesh->shape));
    return {};
  }
  Before& before = std::get<Before>(kept);
  FemNodes handed_over = std::move(before.handed_over);
  restore(std::move(before));
  return handed_over;
}

}  // namespace supple

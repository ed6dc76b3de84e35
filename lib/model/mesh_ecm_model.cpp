#include "lib/model/mesh_ecm_model.h"

namespace supple {

MeshEcmModel::MeshEcmModel(const HeldMesh& held, const MeshLimits& limits)
    : m_held(held), m_ecm(held.body, limits) {}

void MeshEcmModel::move(const std::vector<MeshHandle>& handles, int, Progress* progress) {
  NodeSet grabbed, follows;
  for (const MeshHandle& handle : handles) {
    grabbed.insert(grabbed.end(), handle.nodes.begin(), handle.nodes.end());
    if (handle.kind == HandleKind::push) continue;
    follows.insert(follows.end(), handle.nodes.begin(), handle.nodes.end());
  }
  // Held nodes stay through the projection, also those that are grabbed anew.
  std::vector<NodeSet> anchors = m_held.anchors;
  if (!m_held.anchored.empty()) anchors.push_back(m_held.anchored);
  const std::vector<Vec3d> before = m_held.body.pos_mm;
  const MeshProjection projection = m_ecm.project(anchors, progress);
  NodeSet anchored = m_held.anchored;
  remove_nodes(anchored, grabbed);
  anchors = m_held.anchors;
  if (!anchored.empty()) anchors.push_back(anchored);
  try {
    m_report = m_ecm.drag(handles, anchors, progress);
  } catch (...) {
    m_held.body.pos_mm = before;
    throw;
  }
  m_report.projection = projection;
  add_nodes(anchored, follows);
  m_held.anchored = std::move(anchored);
}

}  // namespace supple

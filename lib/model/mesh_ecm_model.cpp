#include "lib/model/mesh_ecm_model.h"

#include <algorithm>

namespace supple {

MeshEcmModel::MeshEcmModel(const HeldMesh& held, const MeshLimits& limits)
    : m_held(held), m_ecm(held.body, limits) {}

void MeshEcmModel::move(const std::vector<MeshHandle>& handles, int, Progress* progress) {
  NodeSet grabbed;
  for (const MeshHandle& handle : handles) {
    grabbed.insert(grabbed.end(), handle.nodes.begin(), handle.nodes.end());
  }
  std::sort(grabbed.begin(), grabbed.end());
  NodeSet still = m_held.still;
  still.erase(std::remove_if(still.begin(), still.end(),
                             [&](int node) {
                               return std::binary_search(grabbed.begin(), grabbed.end(), node);
                             }),
              still.end());
  std::vector<NodeSet> anchors = m_held.anchors;
  if (!still.empty()) anchors.push_back(still);
  m_report = m_ecm.drag(handles, anchors, progress);
  m_held.still = std::move(still);
  for (const MeshHandle& handle : handles) {
    if (handle.kind == HandleKind::push) continue;
    m_held.still.insert(m_held.still.end(), handle.nodes.begin(), handle.nodes.end());
  }
}

}  // namespace supple

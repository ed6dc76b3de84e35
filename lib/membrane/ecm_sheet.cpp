#include "lib/membrane/ecm_sheet.h"

#include "volumes/base/error.h"

namespace supple {

void EcmSheet::follow(const std::vector<int>& nodes, const std::vector<Vec3d>& targets_mm) {
  if (nodes.empty()) return;
  std::vector<Vec3d>& pos = m_sheet.body.pos_mm;
  // Springs may have left links beyond the limits.
  m_ecm.project();
  std::vector<MeshHandle> handles;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    handles.push_back({{nodes[n]}, targets_mm[n] - pos[nodes[n]]});
  }
  try {
    m_ecm.drag(handles, {});
  } catch (const InputError&) {
    // Targets that contradict each other: the nodes go there as far as links let them.
    for (std::size_t n = 0; n < nodes.size(); ++n) pos[nodes[n]] = targets_mm[n];
    m_ecm.project({nodes});
  }
}

}  // namespace supple

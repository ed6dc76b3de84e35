#include "tools/lab/bench/bodies/dragged_head.h"

#include "lib/chainmail/ecm.h"
#include "tools/lab/bench/bodies/ecm_bodies.h"

namespace supple::tools {

DraggedHead::DraggedHead(const Vec3i& size, std::int64_t wanted, Progress& cancel)
    : m_body(head_phantom_body(size)),
      m_shell(dilate(m_body.elements, 2)),
      m_live(m_body.geometry, m_body.elements, m_shell),
      m_voxel(cheek_element(m_body)) {
  m_workload.direction = "+y";
  m_workload.start = "rest";
  m_amplitude = find_amplitude(m_workload, m_body, m_voxel, wanted, cancel);
  m_engine = make_engine("supple", m_body, &cancel);
}

std::vector<std::int32_t> DraggedHead::reset() {
  m_engine->reset();
  return follow();
}

void DraggedHead::drag() {
  m_engine->pull(pull_of(m_voxel, m_workload.direction, m_amplitude));
}

InvertParams DraggedHead::params() const {
  InvertParams params;
  params.material = &m_body.elements;
  return params;
}

}  // namespace supple::tools

#include "lib/session/hand/solid_ahead.h"

#include <utility>

#include "lib/session/fem_task.h"
#include "lib/session/kept_voxels.h"
#include "lib/session/session_body.h"

namespace supple {

namespace {

/// Calls use(task) with the task of a step of a body of which nothing counts but the solid.
template <class Use>
auto with_task(Body& body, const LinkCuts& cuts, Use&& use) {
  std::vector<Region> anchors;
  Holds holds;
  const DensityGrid density;
  const BrickValues labels;
  std::shared_ptr<const FemResponses> none;
  return use(FemTask{{body, anchors, holds}, cuts, density, labels, {}, {}, {}, nullptr, none, {}});
}

ResponseKey key_of_solid(Body& body, const LinkCuts& cuts, const FemStep& step) {
  return with_task(body, cuts, [&](const FemTask& task) { return solid_key(step, task); });
}

}  // namespace

SolidAhead::SolidAhead(SessionBody& in, const FemStep& step)
    : m_step(step),
      m_body(in.body),
      m_cuts(in.cuts()),
      m_key(key_of_solid(in.body, m_cuts, step)) {}

SolidAhead::~SolidAhead() = default;

bool SolidAhead::is_of(SessionBody& in, const FemStep& step) const {
  return m_key.change_to(key_of_solid(in.body, in.cuts(), step)).empty();
}

void SolidAhead::run(Progress* progress) {
  auto voxels = with_task(m_body, m_cuts, [&](const FemTask& task) {
    return std::make_shared<KeptVoxels>(m_key, m_step, task, progress);
  });
  const std::lock_guard<std::mutex> lock(m_mutex);
  m_voxels = std::move(voxels);
}

std::shared_ptr<KeptVoxels> SolidAhead::voxels() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  return m_voxels;
}

}  // namespace supple

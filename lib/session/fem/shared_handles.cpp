#include "lib/session/fem/shared_handles.h"

#include <algorithm>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

std::string mm_text(const Vec3d& mm) {
  return to_text(mm, ", ") + " mm";
}

}  // namespace

std::vector<SharedHandle> shared_handles(const std::vector<GripReach>& reaches,
                                         const std::vector<FemGrip>& grips,
                                         const std::vector<Handle>& handles,
                                         const Geometry& geometry) {
  std::vector<SharedHandle> shared;
  for (const GripReach& reach : reaches) {
    const FemGrip& grip = grips[reach.grip];
    if (grip.kind != GripKind::handle) continue;
    shared.push_back({handles[grip.handle].region.name(),
                      geometry.world_vector_from_index(reach.asked),
                      geometry.world_vector_from_index(reach.reached), reach.off_voxels});
  }
  return shared;
}

void warn_of_shared(const std::vector<SharedHandle>& shared, Progress* progress) {
  if (shared.empty()) return;
  const auto worst = std::max_element(
      shared.begin(), shared.end(),
      [](const SharedHandle& a, const SharedHandle& b) { return a.off_voxels < b.off_voxels; });
  warn(progress, "finite elements: shared corners keep " +
                     with_count(std::int64_t(shared.size()), "handle") +
                     (shared.size() == 1 ? " from its place: " : " from their places: ") +
                     worst->name + " goes to an offset of " + mm_text(worst->reached_mm) +
                     " instead of " + mm_text(worst->asked_mm) + ", one element is off by " +
                     number_text(worst->off_voxels) + " voxels");
}

}  // namespace supple

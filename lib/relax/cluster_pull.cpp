#include "lib/relax/cluster_pull.h"

#include <algorithm>
#include <limits>

namespace supple {

namespace {

/// Finds the bound of an element; null where it has none.
const Bound* bound_of(const std::vector<Bound>& bounds, Slot slot) {
  const auto place =
      std::lower_bound(bounds.begin(), bounds.end(), slot,
                       [](const Bound& bound, Slot wanted) { return bound.slot < wanted; });
  return place != bounds.end() && place->slot == slot ? &*place : nullptr;
}

}  // namespace

ClusterPull pull_of_cluster(const Clusters& clusters, std::size_t cluster,
                            const BrickArray<double>& offsets, const std::vector<Bound>& at_least,
                            const std::vector<Bound>& at_most, double share) {
  ClusterPull pull;
  pull.rise = pull.sink = std::numeric_limits<double>::infinity();
  for (std::uint32_t n = clusters.first_link[cluster]; n < clusters.first_link[cluster + 1]; ++n) {
    const Clusters::Boundary& link = clusters.boundary[n];
    const double apart = offsets.at(link.outside) - offsets.at(link.inside);
    const double part = link.shared ? share : 1;
    const double upper = link.values.upper * kFinePerUnit, lower = link.values.lower * kFinePerUnit;
    pull.force +=
        link.values.stiffness * pulled_stretch(link.values, apart - link.rest * kFinePerUnit);
    pull.stiffness += link.values.stiffness;
    pull.rise = std::min(pull.rise, part * (apart + (link.inside_is_low ? lower : upper)));
    pull.sink = std::min(pull.sink, part * ((link.inside_is_low ? upper : lower) - apart));
    pull.touches_other = pull.touches_other || link.shared;
  }
  if (at_least.empty() && at_most.empty()) return pull;
  for (std::uint32_t n = clusters.first[cluster]; n < clusters.first[cluster + 1]; ++n) {
    const Slot slot = clusters.members[n];
    if (const Bound* least = bound_of(at_least, slot)) {
      pull.sink =
          std::min(pull.sink, std::max(0.0, offsets.at(slot) - least->value * kFinePerUnit));
    }
    if (const Bound* most = bound_of(at_most, slot)) {
      pull.rise = std::min(pull.rise, std::max(0.0, most->value * kFinePerUnit - offsets.at(slot)));
    }
  }
  return pull;
}

}  // namespace supple

#include "lib/relax/spring_shares.h"

#include <algorithm>

namespace supple {

std::array<double, kLinkKinds> spring_shares(const Vec3d& spacing_mm, int links) {
  const double across_face = links == 18 ? 1.0 / 6 : 1.0 / 9, across_cell = 1.0 / 36;
  const double volume = spacing_mm.x * spacing_mm.y * spacing_mm.z;
  std::array<double, kLinkKinds> shares{};
  for (int axis = 0; axis < kAxisKinds; ++axis) {
    shares[std::size_t(axis)] =
        spacing_mm[(axis + 1) % 3] * spacing_mm[(axis + 2) % 3] / spacing_mm[axis];
  }
  for (int kind = kAxisKinds; kind < kinds_of(links); ++kind) {
    const int direction = kDirectionOfKind[std::size_t(kind)];
    const LinkStep step = step_of_direction(direction);
    double longest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (step[std::size_t(axis)] != 0) longest = std::max(longest, spacing_mm[axis]);
    }
    const double weight = axes_of_direction(direction) == 2 ? across_face : across_cell;
    const double share = weight * volume / (longest * longest);
    shares[std::size_t(kind)] = share;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (step[axis] != 0) shares[axis] -= share;
    }
  }
  return shares;
}

}  // namespace supple

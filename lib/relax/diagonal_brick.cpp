#include "lib/relax/diagonal_brick.h"

#include <algorithm>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Fills all 1,000 values of `out`; `sources` by direction of the brick.
template <class From, class To>
void pad(const std::array<const From*, kDirections>& sources, PaddedBrick<To>& out) {
  for (int i = -1; i <= 8; ++i) {
    for (int j = -1; j <= 8; ++j) {
      const From* const* along = &sources[std::size_t(direction_of_step(i >> 3, j >> 3, 0))];
      const int first = 64 * (i & 7) + 8 * (j & 7);
      To* row = out.row(i, j);
      row[-1] = To(along[-1][first + 7]);
      for (int k = 0; k < 8; ++k) row[k] = To(along[0][first + k]);
      row[8] = To(along[1][first]);
    }
  }
}

}  // namespace

std::vector<std::int16_t> classes_of_bricks(const Body& body) {
  std::vector<std::int16_t> classes(body.elements.brick_count());
  parallel_for(classes.size(), Grain{4}, [&](std::size_t b) {
    int least = kLastClass, most = 0;
    for_each_active(body.elements.mask(b), [&](int offset) {
      const int here = body.classes[b * kBrickVoxels + std::size_t(offset)];
      least = std::min(least, here);
      most = std::max(most, here);
    });
    classes[b] = std::int16_t(least == most ? least : -1);
  });
  return classes;
}

int brick_colour(const Vec3i& origin) {
  return (origin.x >> 3 & 1) << 2 | (origin.y >> 3 & 1) << 1 | (origin.z >> 3 & 1);
}

void load_brick(const Body& body, int links, std::size_t b, const BrickArray<double>& offsets,
                const std::vector<std::int16_t>& one_class, DiagonalBrick& out) {
  static constexpr double kAtRest[kBrickVoxels] = {};
  static constexpr std::uint8_t kNoClasses[kBrickVoxels] = {};
  const BrickNeighbours bricks = neighbours_of(body.elements, b);
  find_links(body.elements, body.cuts, links, bricks, out.links);
  out.colour = brick_colour(body.elements.origin(b));
  out.of_one_class = one_class[b];
  std::array<const double*, kDirections> values;
  std::array<const std::uint8_t*, kDirections> classes;
  for (std::size_t direction = 0; direction < kDirections; ++direction) {
    const bool exists = bricks[direction] >= 0;
    const auto other = std::size_t(exists ? bricks[direction] : 0);
    values[direction] = exists ? offsets.brick_or_zero(other) : kAtRest;
    classes[direction] = exists ? body.classes.data() + kBrickVoxels * other : kNoClasses;
    if (exists && one_class[other] != out.of_one_class) out.of_one_class = -1;
  }
  pad(values, out.offsets);
  if (out.of_one_class < 0) pad(classes, out.classes);
}

}  // namespace supple

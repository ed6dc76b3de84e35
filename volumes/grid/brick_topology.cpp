#include "volumes/grid/brick_topology.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

constexpr std::array<std::array<int, 3>, 6> kFaces = {
    {{-8, 0, 0}, {8, 0, 0}, {0, -8, 0}, {0, 8, 0}, {0, 0, -8}, {0, 0, 8}}};

bool origin_less(const Vec3i& a, const Vec3i& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

bool is_empty(const BrickMask& mask) {
  return std::all_of(mask.begin(), mask.end(), [](std::uint64_t word) { return word == 0; });
}

}  // namespace

int mask_count(const BrickMask& mask) {
  int count = 0;
  for (const std::uint64_t word : mask) count += __builtin_popcountll(word);
  return count;
}

IndexBox mask_bounds(const BrickMask& mask) {
  IndexBox box;
  std::uint64_t layers = 0;  // all of them as one; a byte is a row along z
  for (int x = 0; x < kBrickDim; ++x) {
    if (mask[x] == 0) continue;
    if (layers == 0) box.lo.x = x;
    box.hi.x = x;
    layers |= mask[x];
  }
  if (layers == 0) return {};
  std::uint64_t row = layers | layers >> 32;
  row |= row >> 16;
  row = (row | row >> 8) & 0xff;
  box.lo.y = __builtin_ctzll(layers) >> 3;
  box.hi.y = (63 - __builtin_clzll(layers)) >> 3;
  box.lo.z = __builtin_ctzll(row);
  box.hi.z = 63 - __builtin_clzll(row);
  return box;
}

IndexBox join(const IndexBox& a, const IndexBox& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  IndexBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = std::min(a.lo[axis], b.lo[axis]);
    box.hi[axis] = std::max(a.hi[axis], b.hi[axis]);
  }
  return box;
}

BrickTopology::BrickTopology(std::vector<Vec3i> origins, std::vector<BrickMask> masks) {
  struct Source {
    Vec3i origin;
    std::uint32_t place;  // in the arguments
  };
  std::vector<Source> sources;
  for (std::size_t b = 0; b < origins.size(); ++b) {
    if (!is_empty(masks[b])) sources.push_back({origins[b], std::uint32_t(b)});
  }
  const auto comes_first = [](const Source& a, const Source& b) {
    return origin_less(a.origin, b.origin);
  };
  if (!std::is_sorted(sources.begin(), sources.end(), comes_first)) {
    parallel_sort(sources.begin(), sources.end(), comes_first);
  }
  const auto bricks = std::make_shared<Bricks>();
  std::vector<Vec3i> sorted;
  sorted.reserve(sources.size());
  bricks->masks.reserve(sources.size());
  for (const Source& source : sources) {
    const BrickMask& mask = masks[source.place];
    sorted.push_back(source.origin);
    bricks->masks.push_back(mask);
    bricks->active_count += mask_count(mask);
    const IndexBox box = mask_bounds(mask);
    bricks->active_bounds =
        join(bricks->active_bounds, {source.origin + box.lo, source.origin + box.hi});
  }
  bricks->index = BrickIndex(std::move(sorted));
  const BrickIndex& index = bricks->index;
  bricks->neighbours.resize(index.count());
  parallel_for(index.count(), [&](std::size_t b) {
    for (int face = 0; face < 6; ++face) {
      const Vec3i step(kFaces[face][0], kFaces[face][1], kFaces[face][2]);
      bricks->neighbours[b][face] = index.find(index.origin(b) + step);
    }
  });
  m_bricks = bricks;
}

const std::shared_ptr<const BrickTopology::Bricks>& BrickTopology::none() {
  static const auto bricks = std::make_shared<const Bricks>();
  return bricks;
}

std::size_t BrickTopology::bytes() const {
  return index().bytes() + m_bricks->masks.capacity() * sizeof(BrickMask) +
         m_bricks->neighbours.capacity() * sizeof(m_bricks->neighbours[0]);
}

bool touches(const BrickTopology& topology, const Vec3d& pos) {
  for (int a = 0; a < 3; ++a) {
    if (!(std::abs(pos[a]) < kMaxCoordinate)) return false;
  }
  const Vec3i lo(int(std::floor(pos.x)), int(std::floor(pos.y)), int(std::floor(pos.z)));
  const Vec3i span(pos.x > lo.x, pos.y > lo.y, pos.z > lo.z);
  for (int n = 0; n < 8; ++n) {
    const Vec3i step = cell_corner(n);
    if (step.x > span.x || step.y > span.y || step.z > span.z) continue;
    if (topology.is_active(lo + step)) return true;
  }
  return false;
}

}  // namespace supple

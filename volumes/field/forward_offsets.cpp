#include "volumes/field/forward_offsets.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/parallel_for.h>

#include "volumes/field/output_bricks.h"

namespace supple {

namespace {

constexpr double kTolerance = 1e-4;  // voxels
constexpr int kMaxSteps = 12;
constexpr double kMaxStep = 4;  // voxels
constexpr double kMinDet = 1e-3;
constexpr int kSeedSpacing = 4;

Vec3i floor_of(const Vec3d& p) {
  return {int(std::floor(p.x)), int(std::floor(p.y)), int(std::floor(p.z))};
}
Vec3d to_vector(const Float4& v) {
  return {double(v[0]), double(v[1]), double(v[2])};
}
int octant_of(const Vec3i& voxel) {
  return (voxel.x & 4) | (voxel.y & 4) >> 1 | (voxel.z & 4) >> 2;
}
double largest(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// x with (I + grad u) x = b; false where the cell is flat.
bool solve_linear(const Vec3d along[3], const Vec3d& b, Vec3d& x) {
  const Vec3d c0 = along[0] + Vec3d(1, 0, 0), c1 = along[1] + Vec3d(0, 1, 0),
              c2 = along[2] + Vec3d(0, 0, 1);
  const Vec3d n0 = c1.cross(c2), n1 = c2.cross(c0), n2 = c0.cross(c1);
  const double det = c0.dot(n0);
  if (!(std::abs(det) > kMinDet)) return false;
  x = Vec3d(n0.dot(b), n1.dot(b), n2.dot(b)) / det;
  return true;
}

}  // namespace

ForwardOffsets::ForwardOffsets(const Displacement& displacement)
    : m_source(displacement.u.topology),
      m_slots(m_source.brick_count(), kStill),
      m_lo(m_source.brick_count()),
      m_hi(m_source.brick_count()) {
  std::vector<std::int32_t> all(m_source.brick_count());
  std::iota(all.begin(), all.end(), 0);
  gather(displacement, all);
  find_reached();
}

void ForwardOffsets::update(const Displacement& displacement,
                            const std::vector<std::int32_t>& changed) {
  gather(displacement, with_lower_neighbours(m_source, changed));
  find_reached();
}

void ForwardOffsets::gather(const Displacement& displacement,
                            const std::vector<std::int32_t>& bricks) {
  const VectorBrickFinder find = finder_of(displacement.u);
  // A brick that has a slot is written at once; others first show whether they need one.
  const auto gather_brick = [&](std::size_t b) {
    BrickNodes nodes;
    float scratch[BrickNodes::kFloats];
    gather_nodes(find, m_source, false, m_source.origin(b),
                 m_slots[b] >= 0 ? m_nodes.at(m_slots[b]) : scratch, nodes);
    m_lo[b] = nodes.lo;
    m_hi[b] = nodes.hi;
    return nodes.is_zero;
  };
  std::vector<std::uint8_t> is_still(bricks.size());
  tbb::parallel_for(std::size_t(0), bricks.size(),
                    [&](std::size_t n) { is_still[n] = gather_brick(std::size_t(bricks[n])); });
  std::vector<std::size_t> fresh;
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    std::int32_t& slot = m_slots[bricks[n]];
    if (is_still[n]) {
      if (slot >= 0) m_nodes.give_back(slot);
      slot = kStill;
    } else if (slot < 0) {
      slot = m_nodes.take();
      fresh.push_back(std::size_t(bricks[n]));
    }
  }
  m_nodes.reserve();
  tbb::parallel_for(std::size_t(0), fresh.size(), [&](std::size_t n) { gather_brick(fresh[n]); });
}

/// The output bricks that cells of moving bricks reach, and those that such bricks have left.
void ForwardOffsets::find_reached() {
  BrickIndex index;
  std::vector<Reached> reached;
  const auto add = [&](const Vec3i& origin, const IndexBox& cells) {
    const std::size_t n = index.add(origin);
    if (n == reached.size()) {
      reached.emplace_back();
    }
    reached[n].source = join(reached[n].source, cells);
  };
  for (std::size_t b = 0; b < m_slots.size(); ++b) {
    if (m_slots[b] == kStill) continue;
    const Vec3i origin = m_source.origin(b), end = origin + Vec3i(kBrickDim);
    add(origin, {origin, end});
    const Vec3i first = floor_of(Vec3d(origin) + Vec3d(m_lo[b]) - Vec3d(kTolerance));
    const Vec3i last = floor_of(Vec3d(end) + Vec3d(m_hi[b]) + Vec3d(kTolerance));
    for (int x = first.x & ~7; x <= last.x; x += kBrickDim) {
      for (int y = first.y & ~7; y <= last.y; y += kBrickDim) {
        for (int z = first.z & ~7; z <= last.z; z += kBrickDim) add({x, y, z}, {origin, end});
      }
    }
  }
  for (std::size_t b = 0; b < m_slots.size(); ++b) {
    if (m_slots[b] != kStill) plant_seeds(b, index, reached);
  }

  std::vector<Vec3i> origins = index.origins();
  std::sort(origins.begin(), origins.end(), voxel_less);
  m_reached.clear();
  for (const Vec3i& origin : origins) m_reached.push_back(reached[std::size_t(index.find(origin))]);
  set_bricks(std::move(origins));
}

/// Where some nodes of a moving brick go, for samples beside them to begin with; the shortest way
/// wins.
void ForwardOffsets::plant_seeds(std::size_t b, const BrickIndex& index,
                                 std::vector<Reached>& reached) const {
  for (int n = 0; n < 8; ++n) {
    const Vec3i local = Vec3i(n >> 2, (n >> 1) & 1, n & 1) * kSeedSpacing + Vec3i(kSeedSpacing / 2);
    const float* u = m_nodes.at(m_slots[b]) + local.x * BrickNodes::kStepX +
                     local.y * BrickNodes::kStepY + local.z * BrickNodes::kStepZ;
    const Vec3f offset(-u[0], -u[1], -u[2]);
    if (!(offset.length2() >= 0)) continue;
    const Vec3i image = floor_of(Vec3d(m_source.origin(b) + local) - Vec3d(offset));
    const std::int32_t at = index.find(image);
    if (at < 0) continue;
    Vec3f& seed = reached[at].seed[octant_of(image)];
    if (!(seed.length2() <= offset.length2())) seed = offset;
  }
}

/// False where a corner of the cell has no displacement.
bool ForwardOffsets::place_at(const Vec3d& y, Place& place) const {
  const Vec3i voxel = floor_of(y);
  const std::int32_t b = m_source.find(voxel);
  if (b < 0) return false;
  place.piece = b * kBrickVoxels + brick_offset(voxel);
  if (m_slots[b] == kStill) {
    place.u = place.along[0] = place.along[1] = place.along[2] = Vec3d(0);
    return true;
  }
  const Vec3f f(y - Vec3d(voxel));
  const Vec3i local = voxel - m_source.origin(std::size_t(b));
  const float* node = m_nodes.at(m_slots[b]) + local.x * BrickNodes::kStepX +
                      local.y * BrickNodes::kStepY + local.z * BrickNodes::kStepZ;
  const NodeDerivatives d = derivatives_in({node, f.x, f.y, f.z});
  place.u = to_vector(d.value);
  place.along[0] = to_vector(d.along_x);
  place.along[1] = to_vector(d.along_y);
  place.along[2] = to_vector(d.along_z);
  return place.u.length2() >= 0;
}

/// Newton from x + offset; steps that leave the material are halved.
bool ForwardOffsets::solve(const Vec3d& x, const Vec3d& offset, Sample& found) const {
  Vec3d y = x + offset, before = y;
  for (int n = 0; n < kMaxSteps; ++n) {
    Place place;
    if (!place_at(y, place)) {
      if (y == before) return false;
      y = (y + before) / 2;
      continue;
    }
    const Vec3d residual = y + place.u - x;
    if (largest(residual) <= kTolerance) {
      found = {y - x, place.piece};
      return true;
    }
    Vec3d step;
    if (!solve_linear(place.along, residual, step)) return false;
    const double size = largest(step);
    if (size > kMaxStep) step *= kMaxStep / size;
    before = y;
    y -= step;
  }
  return false;
}

bool ForwardOffsets::sample(std::size_t b, const Vec3d& x, Sample& found) const {
  if (found.piece >= 0 && solve(x, found.offset, found)) return true;
  const Reached& reached = m_reached[b];
  const int octant = octant_of(floor_of(x));
  for (int n = 0; n < kSeeds; ++n) {
    const Vec3f& seed = reached.seed[octant ^ n];
    if (seed.length2() >= 0 && solve(x, Vec3d(seed), found)) return true;
  }
  return solve(x, Vec3d(0), found);
}

void ForwardOffsets::reach(std::size_t b, Vec3d& lo, Vec3d& hi) const {
  const Vec3i& origin = bricks().origin(b);
  const IndexBox box = join(m_reached[b].source, {origin, origin + Vec3i(kBrickDim)});
  lo = Vec3d(box.lo);
  hi = Vec3d(box.hi);
}

Vec3d ForwardOffsets::pull_back(int piece, const Vec3d& x, const Vec3d& gradient) const {
  const std::size_t b = std::size_t(piece / kBrickVoxels);
  if (m_slots[b] == kStill) return gradient;
  const Vec3i local = brick_local(piece % kBrickVoxels);
  const Vec3d low(m_source.origin(b) + local);
  const float* node = m_nodes.at(m_slots[b]) + local.x * BrickNodes::kStepX +
                      local.y * BrickNodes::kStepY + local.z * BrickNodes::kStepZ;
  // The place in its cell again, which is all there is to know of it.
  Vec3d f(0.5), along[3];
  for (int n = 0; n < 4; ++n) {
    const NodeDerivatives d = derivatives_in({node, float(f.x), float(f.y), float(f.z)});
    along[0] = to_vector(d.along_x);
    along[1] = to_vector(d.along_y);
    along[2] = to_vector(d.along_z);
    const Vec3d residual = low + f + to_vector(d.value) - x;
    Vec3d step;
    if (largest(residual) <= kTolerance || !solve_linear(along, residual, step)) break;
    f -= step;
  }
  // g' = F^-T g: the columns of F^-T are the rows of F^-1.
  const Vec3d c0 = along[0] + Vec3d(1, 0, 0), c1 = along[1] + Vec3d(0, 1, 0),
              c2 = along[2] + Vec3d(0, 0, 1);
  const Vec3d n0 = c1.cross(c2), n1 = c2.cross(c0), n2 = c0.cross(c1);
  const double det = c0.dot(n0);
  if (!(std::abs(det) > kMinDet)) return gradient;
  return (n0 * gradient.x + n1 * gradient.y + n2 * gradient.z) / det;
}

std::size_t ForwardOffsets::bytes() const {
  return m_nodes.bytes() + m_source.bytes() + bricks().bytes() +
         m_reached.capacity() * sizeof(Reached) +
         m_slots.capacity() * (sizeof(std::int32_t) + 2 * sizeof(Vec3f));
}

}  // namespace supple

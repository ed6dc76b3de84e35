#include "raycast/offset_bricks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <oneapi/tbb/parallel_for.h>

#include "volumes/field/invert.h"

namespace supple {

namespace {

constexpr int kExtrapolatedRings = 1;  // every corner of a cell that has a valid one
constexpr double kReachGuard = 1e-3;   // voxels; covers the rounding of interpolated offsets
constexpr double kMaxReachedBricks = 4096;
constexpr float kMaxOffsetVoxels = 1 << 20;  // what is larger, or not a number, leads nowhere

Float4 load(const float* p) {
  Float4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
Float4 mix(const Float4& a, const Float4& b, float t) {
  return a + t * (b - a);
}

using Corners = std::array<Float4, 8>;  // x slowest

Corners corners_of(const OffsetCell& cell) {
  constexpr int sx = OffsetBricks::kStepX, sy = OffsetBricks::kStepY, sz = OffsetBricks::kStepZ;
  const float* n = cell.node;
  return {load(n),      load(n + sz),      load(n + sy),      load(n + sy + sz),
          load(n + sx), load(n + sx + sz), load(n + sx + sy), load(n + sx + sy + sz)};
}

float dot(const Float4& v, const Vec3f& g) {
  return v[0] * g.x + v[1] * g.y + v[2] * g.z;
}

/// Densities of all source bricks that the positions lo … hi (index space) fall into.
EncodedRange reached_range(const SourceBricks& source, const Vec3d& lo, const Vec3d& hi) {
  Vec3i first, last;
  double count = 1;
  for (int a = 0; a < 3; ++a) {
    first[a] = int(std::floor(lo[a])) >> 3;
    last[a] = int(std::floor(hi[a])) >> 3;
    count *= last[a] - first[a] + 1;
  }
  if (count > kMaxReachedBricks) return source.range();
  EncodedRange range;
  for (int x = first.x; x <= last.x; ++x) {
    for (int y = first.y; y <= last.y; ++y) {
      for (int z = first.z; z <= last.z; ++z) {
        const std::int32_t b = source.topology().find(Vec3i(x, y, z) * kBrickDim);
        if (b >= 0) range.add(source.range(b));
      }
    }
  }
  return range;
}

}  // namespace

/// The nodes of one brick, its apron included, and what they say about it.
struct OffsetBricks::Gathered {
  std::array<float, kBrickFloats> offsets;
  bool identity = true;
  Vec3f lo{HUGE_VALF, HUGE_VALF, HUGE_VALF};
  Vec3f hi{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

  void set(float* out, const Vec3f& offset) {
    const float size = std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z);
    if (!(size < kMaxOffsetVoxels)) {
      set_missing(out, false);
      return;
    }
    for (int a = 0; a < 3; ++a) {
      out[a] = offset[a];
      lo[a] = std::min(lo[a], offset[a]);
      hi[a] = std::max(hi[a], offset[a]);
    }
    identity = identity && offset == Vec3f(0, 0, 0);
  }
  /// Reading the source without offset is right in a cell that has none only if it is void there.
  void set_missing(float* out, bool source_is_void) {
    std::fill(out, out + 3, std::numeric_limits<float>::quiet_NaN());
    identity = identity && source_is_void;
  }
};

OffsetBricks::OffsetBricks(const SourceBricks& source) : m_topology(source.topology()) {
  m_slots.assign(m_topology.brick_count(), kIdentity);
  m_ranges.reserve(m_topology.brick_count());
  for (std::size_t b = 0; b < m_topology.brick_count(); ++b) m_ranges.push_back(source.range(b));
}

OffsetBricks::Gathered OffsetBricks::gather(const VectorBricks& extrapolated,
                                            const SourceBricks& source, std::size_t b) {
  const Vec3i origin = extrapolated.topology.origin(b);
  std::array<std::int32_t, 8> from, beneath;
  for (int n = 0; n < 8; ++n) {
    const Vec3i neighbour = origin + Vec3i(n >> 2, (n >> 1) & 1, n & 1) * kBrickDim;
    from[n] = extrapolated.topology.find(neighbour);
    beneath[n] = source.topology().find(neighbour);
  }
  Gathered result;
  float* out = result.offsets.data();
  for (int x = 0; x < kDim; ++x) {
    for (int y = 0; y < kDim; ++y) {
      for (int z = 0; z < kDim; ++z, out += 3) {
        const int n = ((x >> 3) << 2) | ((y >> 3) << 1) | (z >> 3);
        const int offset = brick_offset({x, y, z});
        if (from[n] >= 0 && mask_test(extrapolated.topology.mask(from[n]), offset)) {
          result.set(out, extrapolated.vectors[std::size_t(from[n]) * kBrickVoxels + offset]);
        } else {
          result.set_missing(
              out, beneath[n] < 0 || !mask_test(source.topology().mask(beneath[n]), offset));
        }
      }
    }
  }
  return result;
}

OffsetBricks::OffsetBricks(const SourceBricks& source, const VectorBricks& offsets,
                           std::shared_ptr<const SplitOffsets> split)
    : m_split(std::move(split)), m_valid_bounds(offsets.topology.active_bounds()) {
  const VectorBricks extrapolated = extrapolate_into_bricks(offsets, kExtrapolatedRings);
  m_topology = extrapolated.topology;
  const std::size_t count = m_topology.brick_count();
  m_slots.resize(count);
  m_ranges.resize(count);

  // First find the identity bricks, then give the others a slot each.
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t b) {
    const Gathered found = gather(extrapolated, source, b);
    m_slots[b] = found.identity ? kIdentity : 0;
    if (found.identity) {
      const std::int32_t beneath = source.topology().find(m_topology.origin(b));
      if (beneath >= 0) m_ranges[b] = source.range(beneath);
    } else if (found.lo.x <= found.hi.x) {
      const Vec3d guard(kReachGuard), lo(m_topology.origin(b));
      m_ranges[b] = reached_range(source, lo + Vec3d(found.lo) - guard,
                                  lo + Vec3d(kBrickDim) + Vec3d(found.hi) + guard);
    }
  });
  if (m_split != nullptr) mark_split_bricks(source);
  std::int32_t slots = 0;
  for (std::int32_t& slot : m_slots) {
    if (slot >= 0) slot = slots++;
  }

  // One float more, so that the last node can be read as four.
  m_offsets.resize(slots * kBrickFloats + 1);
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t b) {
    if (m_slots[b] < 0) return;
    const Gathered found = gather(extrapolated, source, b);
    std::copy(found.offsets.begin(), found.offsets.end(),
              m_offsets.begin() + m_slots[b] * kBrickFloats);
  });
}

void OffsetBricks::mark_split_bricks(const SourceBricks& source) {
  for (std::size_t b = 0; b < m_slots.size(); ++b) {
    const std::int32_t n = m_split->bricks().find(m_topology.origin(b));
    if (n < 0) continue;
    m_slots[b] = kIdentity - 1 - n;
    Vec3d lo, hi;
    m_split->reach(std::size_t(n), lo, hi);
    m_ranges[b] =
        lo.x > hi.x ? EncodedRange() : reached_range(source, lo - Vec3d(1), hi + Vec3d(1));
  }
}

std::size_t OffsetBricks::bytes() const {
  return m_topology.bytes() + m_slots.capacity() * sizeof(std::int32_t) +
         m_ranges.capacity() * sizeof(EncodedRange) + m_offsets.capacity() * sizeof(float);
}

Vec3f pull_back_gradient(const OffsetCell& cell, const Vec3f& gradient) {
  const Corners c = corners_of(cell);
  const Float4 y0 = mix(c[0], c[1], cell.z), y1 = mix(c[2], c[3], cell.z);
  const Float4 y2 = mix(c[4], c[5], cell.z), y3 = mix(c[6], c[7], cell.z);
  const Float4 along_x = mix(y2, y3, cell.y) - mix(y0, y1, cell.y);
  const Float4 along_y = mix(y1 - y0, y3 - y2, cell.x);
  const Float4 along_z =
      mix(mix(c[1] - c[0], c[3] - c[2], cell.y), mix(c[5] - c[4], c[7] - c[6], cell.y), cell.x);
  return {gradient.x + dot(along_x, gradient), gradient.y + dot(along_y, gradient),
          gradient.z + dot(along_z, gradient)};
}

}  // namespace supple

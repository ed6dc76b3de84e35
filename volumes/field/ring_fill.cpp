#include "volumes/field/ring_fill.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "volumes/base/parallel.h"
#include "volumes/field/brick_lists.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/padded_rows.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

bool any_bit(const BrickMask& mask) {
  return std::any_of(mask.begin(), mask.end(), [](std::uint64_t word) { return word != 0; });
}

/// Wanted voxels of one brick that touch a valid one.
BrickMask next_ring(const MasksAround& around, const BrickMask& wanted, const BrickMask& valid) {
  BrickMask ring = dilated(around);
  for (std::size_t x = 0; x < ring.size(); ++x) ring[x] &= wanted[x] & ~valid[x];
  return ring;
}

/// Fills ring `number` of one brick: calls `set(offset, vector)`.
template <class MaskOf, class Set>
void fill_ring(const BrickMask& ring, int number, RingFill fill, const Surroundings& around,
               MaskOf&& mask_of, const BrickVectors& vectors, Set&& set) {
  if (!any_bit(ring)) return;
  std::array<const Vec3f*, 27> bricks;  // of absent ones nothing is read
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    bricks[n] = vectors.brick_or_zero(std::size_t(around[n]));
  }
  const auto vectors_of = [&](int n) { return bricks[std::size_t(n)]; };
  if (number <= int(fill)) {
    const PaddedRows<2> padded = padded_rows<2>(around, mask_of);
    for_each_active(ring, [&](int offset) {
      set(offset, extrapolate<true>(padded, brick_local(offset), vectors_of));
    });
  } else {
    const PaddedRows<1> padded = padded_rows<1>(around, mask_of);
    for_each_active(ring, [&](int offset) {
      set(offset, extrapolate<false>(padded, brick_local(offset), vectors_of));
    });
  }
}

/// Drops what is not valid; brick order stays. `valid_of(b)`: the valid voxels of brick b.
template <class ValidOf>
VectorBricks compact(const BrickTopology& bricks, const ValidOf& valid_of, BrickVectors vectors,
                     std::vector<std::uint8_t>* ring_of) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  std::vector<std::size_t> kept;
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    if (!any_bit(valid_of(b))) continue;
    const std::size_t from = b * kBrickVoxels, to = origins.size() * kBrickVoxels;
    if (from != to && ring_of) {
      std::copy_n(ring_of->begin() + from, kBrickVoxels, ring_of->begin() + to);
    }
    origins.push_back(bricks.origin(b));
    masks.push_back(valid_of(b));
    kept.push_back(b);
  }
  vectors.keep_only(kept);
  if (ring_of) ring_of->resize(kept.size() * kBrickVoxels);
  return {BrickTopology(std::move(origins), std::move(masks)), std::move(vectors)};
}

/// The bricks of a target with wanted voxels, and what is valid in them so far, also beyond the
/// target. Everywhere else it is the voxels of the target.
struct Pending {
  std::vector<std::size_t> bricks;
  std::vector<BrickMask> valid;
  std::vector<std::int32_t> number_of;  // per brick of the target; -1: not pending
  std::vector<std::size_t> places;      // of the bricks of the seed in the target

  /// False when the target does not have all bricks of the seed.
  bool find(const BrickTopology& seed, const BrickTopology& target) {
    number_of.assign(target.brick_count(), -1);
    places.resize(seed.brick_count());
    std::size_t held = 0;
    std::size_t next = 0;  // in the seed, after the brick found last: mostly the one looked for
    for (std::size_t b = 0; b < target.brick_count(); ++b) {
      const Vec3i& origin = target.origin(b);
      const bool is_next = next < seed.brick_count() && seed.origin(next) == origin;
      const std::int32_t s = is_next ? std::int32_t(next) : seed.find(origin);
      const BrickMask& wanted = target.mask(b);
      const BrickMask given = s < 0 ? BrickMask{} : seed.mask(std::size_t(s));
      if (s >= 0) {
        places[std::size_t(s)] = b;
        next = std::size_t(s) + 1;
        ++held;
      }
      if (given == wanted) continue;
      number_of[b] = std::int32_t(bricks.size());
      bricks.push_back(b);
      valid.push_back(given);
    }
    return held == seed.brick_count();
  }
};

/// True if some of these bricks may hold a vector other than 0.
bool is_stored(const BrickVectors& vectors, const Surroundings& bricks) {
  return std::any_of(bricks.begin(), bricks.end(),
                     [&](std::int32_t b) { return vectors.brick(std::size_t(b)) != nullptr; });
}

}  // namespace

VectorBricks fill_rings(VectorBricks seed, const BrickTopology& target, int max_rings,
                        RingFill fill, std::vector<std::uint8_t>* ring_of) {
  BrickTopology bricks = target;
  Pending wanted;
  if (!wanted.find(seed.topology, bricks)) {
    bricks = unite(seed.topology, target);
    wanted = {};
    wanted.find(seed.topology, bricks);
  }
  const std::vector<std::size_t>& pending = wanted.bricks;
  std::vector<BrickMask>& valid = wanted.valid;
  const std::size_t count = bricks.brick_count();
  if (ring_of) ring_of->assign(count * kBrickVoxels, 0);
  BrickVectors vectors = std::move(seed.vectors);
  vectors.resize(seed.topology.brick_count());
  vectors.place_at(wanted.places, count);
  const auto mask_of = [&](std::int32_t b) -> const BrickMask& {
    const std::int32_t number = wanted.number_of[std::size_t(b)];
    return number < 0 ? bricks.mask(std::size_t(b)) : valid[std::size_t(number)];
  };

  // Vectors of a ring are written beside the valid ones, which alone are read. Where no brick
  // around is stored the ring is of zeros, and its brick is not stored either.
  std::vector<Surroundings> around(pending.size());
  parallel_for(pending.size(),
               [&](std::size_t n) { around[n] = surroundings_of(bricks, pending[n]); });
  std::vector<BrickMask> ring(pending.size());
  std::vector<std::uint8_t> moves(pending.size());
  std::vector<std::size_t> open(pending.size());  // numbers of those that still want voxels
  std::iota(open.begin(), open.end(), std::size_t(0));
  for (int number = 1; number <= max_rings && !open.empty(); ++number) {
    parallel_for(open.size(), [&](std::size_t at) {
      const std::size_t n = open[at], b = pending[n];
      ring[n] = next_ring(masks_around(around[n], mask_of), bricks.mask(b), valid[n]);
      moves[n] = any_bit(ring[n]) && is_stored(vectors, around[n]);
    });
    for (const std::size_t n : open) {
      if (moves[n]) vectors.touch(pending[n]);
    }
    parallel_for(open.size(), [&](std::size_t at) {
      const std::size_t n = open[at], b = pending[n];
      if (ring_of) {
        for_each_active(ring[n], [&](int offset) {
          (*ring_of)[b * kBrickVoxels + std::size_t(offset)] = std::uint8_t(std::min(number, 255));
        });
      }
      if (!moves[n]) return;
      Vec3f* const own = vectors.touch(b);
      fill_ring(ring[n], number, fill, around[n], mask_of, vectors,
                [&](int offset, const Vec3f& v) { own[offset] = v; });
    });
    bool grown = false;
    std::size_t left = 0;
    for (const std::size_t n : open) {
      // A ring beside a brick that moves at its far side alone has only zeros.
      if (moves[n] && are_zeros(vectors.brick(pending[n]))) vectors.release(pending[n]);
      grown = grown || any_bit(ring[n]);
      for (int word = 0; word < 8; ++word) valid[n][word] |= ring[n][word];
      if (valid[n] != bricks.mask(pending[n])) open[left++] = n;
    }
    open.resize(left);
    if (!grown) break;
  }
  if (open.empty()) return {bricks, std::move(vectors)};
  const auto valid_of = [&](std::size_t b) { return mask_of(std::int32_t(b)); };
  return compact(bricks, valid_of, std::move(vectors), ring_of);
}

RingOrder::RingOrder(const BrickTopology& topology, const std::vector<std::uint8_t>& ring_of)
    : m_last(topology.brick_count(), 0) {
  std::vector<BrickMask> valid(topology.brick_count());  // so far
  for (int ring = 0;; ++ring) {
    bool is_last = true;
    for (std::size_t b = 0; b < valid.size(); ++b) {
      for_each_active(topology.mask(b), [&](int offset) {
        const int number = ring_of[b * kBrickVoxels + std::size_t(offset)];
        if (number == ring) mask_set(valid[b], offset);
        if (number == ring && ring > 0) m_last[b] = std::uint8_t(ring);
        is_last = is_last && number <= ring;
      });
    }
    if (is_last) return;
    m_before.push_back(valid);
  }
}

std::vector<std::int32_t> refill_rings(VectorBricks& field, const RingOrder& order,
                                       const std::vector<std::int32_t>& changed) {
  const BrickTopology& topology = field.topology;
  // A ring sees at most two voxels further than the one before.
  std::vector<std::int32_t> bricks = with_neighbours(topology, changed);
  int last = 0;
  for (int reach = kBrickDim;; reach += kBrickDim) {
    for (const std::int32_t b : bricks) last = std::max(last, order.last(std::size_t(b)));
    if (2 * last <= reach) break;
    const std::size_t before = bricks.size();
    bricks = with_neighbours(topology, bricks);
    if (bricks.size() == before) break;
  }
  std::vector<std::uint8_t> is_changed(bricks.size());
  for (std::size_t n = 0, next = 0; n < bricks.size() && next < changed.size(); ++n) {
    is_changed[n] = bricks[n] == changed[next];
    next += is_changed[n];
  }
  for (const std::int32_t b : bricks) field.vectors.touch(std::size_t(b));
  for (int number = 1; number <= last; ++number) {
    parallel_for(bricks.size(), [&](std::size_t n) {
      const std::size_t b = std::size_t(bricks[n]);
      Vec3f* const own = field.vectors.touch(b);
      if (order.last(b) < number) return;
      BrickMask ring = number == order.rings() ? topology.mask(b) : order.before(number + 1, b);
      take_out(order.before(number, b), ring);
      if (!any_bit(ring)) return;
      const Surroundings around = surroundings_of(topology, b);
      const auto mask_of = [&](std::int32_t m) -> const BrickMask& {
        return order.before(number, std::size_t(m));
      };
      fill_ring(ring, number, RingFill::linear, around, mask_of, field.vectors,
                [&](int offset, const Vec3f& v) {
                  Vec3f& vector = own[offset];
                  is_changed[n] = is_changed[n] || v != vector;
                  vector = v;
                });
    });
  }
  std::vector<std::int32_t> result;
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    if (is_changed[n]) result.push_back(bricks[n]);
  }
  return result;
}

}  // namespace supple

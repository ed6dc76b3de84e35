#include "raycast/sample/offset_bricks.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/padded_rows.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

constexpr double kReachGuard = 1e-3;  // voxels; covers the rounding of interpolated offsets
constexpr double kMaxReachedBricks = 4096;

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

/// The bricks at these origins and all that touch them.
BrickIndex with_neighbours(const std::vector<Vec3i>& origins) {
  BrickIndex found;
  for (const Vec3i& origin : origins) {
    for (int n = 0; n < 27; ++n) {
      found.add(origin + surrounding_step(n) * kBrickDim);
    }
  }
  return found;
}

std::vector<std::size_t> all_numbers(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t(0));
  return numbers;
}

void keep_every_second(const float* all, float* out) {
  for (int x = 0; x < BrickNodes::kDim; x += 2) {
    for (int y = 0; y < BrickNodes::kDim; y += 2) {
      for (int z = 0; z < BrickNodes::kDim; z += 2, out += 3) {
        std::copy_n(all + x * BrickNodes::kStepX + y * BrickNodes::kStepY + z * BrickNodes::kStepZ,
                    3, out);
      }
    }
  }
}

/// True if the brick at an origin has valid voxels, and all source voxels that its cells touch are
/// valid.
bool is_covered(const BrickTopology& source, const Vec3i& origin, const BrickTopology& valid) {
  if (valid.find(origin) < 0) return false;
  for (int n = 0; n < 8; ++n) {
    const Vec3i corner = origin + cell_corner(n) * kBrickDim;
    const std::int32_t wanted = source.find(corner), given = valid.find(corner);
    if (wanted < 0) continue;
    if (given < 0) return false;
    if (!holds(valid.mask(std::size_t(given)), source.mask(std::size_t(wanted)))) return false;
  }
  return true;
}

Float4 load(const float* p) {
  Float4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

/// Nodes per voxel along an axis.
double nodes_per_voxel(const OffsetBricks& bricks) {
  return double(bricks.node_dim() - 1) / kBrickDim;
}

/// The offset at a place; false where it is void.
bool offset_at(const OffsetBricks& bricks, const Vec3d& place, Vec3f& offset) {
  const std::int32_t found = bricks.find(floor_voxel(place));
  if (found < 0) return false;
  const auto b = std::size_t(found);
  if (bricks.is_identity(b)) {
    offset = Vec3f(0.0F);
    return true;
  }
  if (bricks.is_pointwise(b)) {
    PointwiseOffsets::Sample sample;
    const std::size_t n = bricks.pointwise_brick(b);
    if (!bricks.pointwise()->sample(n, place, sample)) return false;
    offset = Vec3f(sample.offset);
    return true;
  }
  if (!bricks.is_deformed(b)) return false;
  const Vec3d at = (place - Vec3d(bricks.index().origin(b))) * nodes_per_voxel(bricks);
  const Vec3i cell(int(at.x), int(at.y), int(at.z));
  const float* node = bricks.node(b, cell);
  const int sz = 3, sy = sz * bricks.node_dim(), sx = sy * bricks.node_dim();
  Float4 corners[8];
  for (int n = 0; n < 8; ++n) {
    corners[n] = load(node + (n & 4 ? sx : 0) + (n & 2 ? sy : 0) + (n & 1 ? sz : 0));
  }
  const Vec3f in(at - Vec3d(cell));
  const Float4 value = derivatives_of(corners, in.x, in.y, in.z).value;
  offset = {value[0], value[1], value[2]};
  return offset.x == offset.x;
}

}  // namespace

OffsetBricks::OffsetBricks(const SourceBricks& source)
    : m_source(&source), m_index(source.topology().index()) {
  const std::size_t count = m_index.count();
  m_states.assign(count, kIdentity);
  m_valid.resize(count);
  m_beneath.resize(count);
  std::iota(m_beneath.begin(), m_beneath.end(), 0);
  m_ranges.reserve(count);
  for (std::size_t b = 0; b < count; ++b) m_ranges.push_back(source.range(b));
}

OffsetBricks::OffsetBricks(const SourceBricks& source, const VectorBricks& offsets,
                           std::shared_ptr<const PointwiseOffsets> pointwise, int node_spacing)
    : m_source(&source),
      m_node_spacing(node_spacing),
      m_offsets(kBrickDim / node_spacing + 1),
      m_pointwise(std::move(pointwise)) {
  take_over(offsets);
  if (m_pointwise == nullptr) return;
  mark_pointwise();
  find_pointwise_ranges(all_numbers(m_states.size()));
}

std::size_t OffsetBricks::add_brick(const Vec3i& origin) {
  const std::size_t b = m_index.add(origin);
  if (b < m_states.size()) return b;
  m_states.push_back(kEmpty);
  m_beneath.push_back(m_source->topology().find(origin));
  m_ranges.emplace_back();
  m_valid.emplace_back();
  return b;
}

std::vector<std::size_t> OffsetBricks::update(const std::vector<Vec3i>& changed,
                                              const VectorBrickFinder& offsets,
                                              std::shared_ptr<const PointwiseOffsets> pointwise) {
  const BrickIndex touched = with_neighbours(changed);
  std::vector<std::size_t> bricks;
  for (const Vec3i& origin : touched.origins()) bricks.push_back(add_brick(origin));
  std::vector<std::int32_t> before;
  for (const std::size_t b : bricks) before.push_back(m_states[b]);
  unmark_pointwise();
  gather(bricks, offsets);
  join_valid();
  m_pointwise = std::move(pointwise);
  if (m_pointwise != nullptr) {
    mark_pointwise();
    find_pointwise_ranges(bricks);
  }
  std::vector<std::size_t> others;
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    const std::int32_t state = m_states[bricks[n]];
    const bool stays = before[n] < kDeformed && before[n] > kPointwise && before[n] == state;
    if (!stays) others.push_back(bricks[n]);
  }
  return others;
}

void OffsetBricks::join_valid() {
  m_valid_bounds = {};
  for (const IndexBox& valid : m_valid) m_valid_bounds = join(m_valid_bounds, valid);
}

/// All offsets, at first: begins at the bricks that move. Elsewhere offsets are 0, and most bricks
/// are identity bricks by their masks alone.
void OffsetBricks::take_over(const VectorBricks& offsets) {
  std::vector<Vec3i> moving;
  for (std::size_t n = 0; n < offsets.topology.brick_count(); ++n) {
    if (offsets.vectors.brick(n) != nullptr) moving.push_back(offsets.topology.origin(n));
  }
  const BrickIndex near = with_neighbours(moving);
  const BrickTopology& source = m_source->topology();
  m_index = source.index();
  const std::size_t count = m_index.count();
  m_states.assign(count, kEmpty);
  m_beneath.resize(count);
  std::iota(m_beneath.begin(), m_beneath.end(), 0);
  m_ranges.resize(count);
  m_valid.resize(count);
  for (const Vec3i& origin : offsets.topology.index().origins()) add_brick(origin);
  for (const Vec3i& origin : near.origins()) add_brick(origin);

  const bool is_same = offsets.topology == source;
  parallel_for(m_index.count(), [&](std::size_t b) {
    if (near.find(m_index.origin(b)) >= 0) return;
    if (!is_same && !is_covered(source, m_index.origin(b), offsets.topology)) return;
    m_states[b] = kIdentity;
    m_ranges[b] = range_beneath(b);
    const std::int32_t n = offsets.topology.find(m_index.origin(b));
    const IndexBox box = mask_bounds(offsets.topology.mask(std::size_t(n)));
    m_valid[b] = {m_index.origin(b) + box.lo, m_index.origin(b) + box.hi};
  });
  std::vector<std::size_t> rest;
  for (std::size_t b = 0; b < m_states.size(); ++b) {
    if (m_states[b] == kEmpty) rest.push_back(b);
  }
  gather(rest, finder_of(offsets));
  join_valid();
}

void OffsetBricks::gather(const std::vector<std::size_t>& bricks,
                          const VectorBrickFinder& offsets) {
  // Bricks are gathered in chunks, all of which have slots until those turn out not to be needed.
  constexpr std::size_t kChunk = 512;
  m_offsets.reserve(bricks.size());
  std::vector<std::int32_t> found(kChunk);
  for (std::size_t start = 0; start < bricks.size(); start += kChunk) {
    const std::size_t end = std::min(start + kChunk, bricks.size());
    for (std::size_t n = start; n < end; ++n) {
      std::int32_t& state = m_states[bricks[n]];
      if (state < 0) state = m_offsets.take();
    }
    m_offsets.grow();
    parallel_for(start, end,
                 [&](std::size_t n) { found[n - start] = gather_brick(bricks[n], offsets); });
    for (std::size_t n = start; n < end; ++n) {
      if (found[n - start] == kDeformed) continue;
      std::int32_t& state = m_states[bricks[n]];
      m_offsets.give_back(state);
      state = found[n - start];
    }
  }
}

/// Fills the slot of brick b and returns what the brick is: kDeformed if it needs the slot.
std::int32_t OffsetBricks::gather_brick(std::size_t b, const VectorBrickFinder& offsets) {
  const Vec3i& origin = m_index.origin(b);
  const VectorBrickView view = offsets(origin);
  m_valid[b] = {};
  if (view.mask != nullptr) {
    const IndexBox box = mask_bounds(*view.mask);
    m_valid[b] = {origin + box.lo, origin + box.hi};
  }
  BrickNodes nodes;
  float* out = m_offsets.at(m_states[b]);
  if (m_node_spacing == 1) {
    gather_nodes(offsets, m_source->topology(), origin, out, nodes);
  } else {
    float all[BrickNodes::kFloats];
    gather_nodes(offsets, m_source->topology(), origin, all, nodes);
    if (!is_straight(b, nodes)) keep_every_second(all, out);
  }
  m_ranges[b] = range_of(b, nodes);
  return is_straight(b, nodes) ? kIdentity : nodes.empty() ? kEmpty : kDeformed;
}

/// True if samples in brick b read the source where they are, or read nothing.
bool OffsetBricks::is_straight(std::size_t b, const BrickNodes& nodes) const {
  return nodes.is_identity() || (nodes.is_zero && m_beneath[b] < 0);
}

EncodedRange OffsetBricks::range_beneath(std::size_t b) const {
  return m_beneath[b] < 0 ? EncodedRange() : m_source->range(std::size_t(m_beneath[b]));
}

EncodedRange OffsetBricks::range_of(std::size_t b, const BrickNodes& nodes) const {
  if (is_straight(b, nodes)) return range_beneath(b);
  if (nodes.empty()) return {};
  const Vec3d guard(kReachGuard), lo(m_index.origin(b));
  return reached_range(*m_source, lo + Vec3d(nodes.lo) - guard,
                       lo + Vec3d(kBrickDim) + Vec3d(nodes.hi) + guard);
}

void OffsetBricks::set_pointwise(std::shared_ptr<const PointwiseOffsets> pointwise) {
  for (std::size_t b = 0; b < m_states.size(); ++b) {
    if (!is_pointwise(b)) continue;
    m_states[b] = kIdentity;
    m_ranges[b] = range_beneath(b);
  }
  m_pointwise = std::move(pointwise);
  m_valid_bounds = {};
  if (m_pointwise == nullptr) return;
  const BrickTopology& bricks = m_pointwise->bricks();
  mark_pointwise();
  find_pointwise_ranges(all_numbers(m_states.size()));
  m_valid_bounds = bricks.active_bounds();
}

/// Notes the slot of pointwise brick n's interpolated offsets; false if none are interpolated.
bool OffsetBricks::keep_interpolated(std::size_t n, std::int32_t slot) {
  const BrickMask* cells = m_pointwise->interpolated(n);
  if (m_node_spacing > 1 || cells == nullptr || mask_count(*cells) == 0) return false;
  m_pointwise_slots.resize(m_pointwise->bricks().brick_count(), -1);
  m_interpolated.resize(m_pointwise_slots.size());
  m_pointwise_slots[n] = slot;
  m_interpolated[n] = *cells;
  return true;
}

/// Pointwise bricks are deformed ones again where they have interpolated cells, else empty.
void OffsetBricks::unmark_pointwise() {
  for (std::size_t b = 0; b < m_states.size(); ++b) {
    if (!is_pointwise(b)) continue;
    const std::size_t n = pointwise_brick(b);
    const std::int32_t slot = n < m_pointwise_slots.size() ? m_pointwise_slots[n] : -1;
    m_states[b] = slot >= 0 ? slot : kEmpty;
  }
  m_pointwise_slots.clear();
  m_interpolated.clear();
}

void OffsetBricks::mark_pointwise() {
  const BrickTopology& bricks = m_pointwise->bricks();
  for (std::size_t n = 0; n < bricks.brick_count(); ++n) {
    const std::size_t b = add_brick(bricks.origin(n));
    if (is_deformed(b) && !keep_interpolated(n, m_states[b])) m_offsets.give_back(m_states[b]);
    m_states[b] = kPointwise - std::int32_t(n);
  }
}

void OffsetBricks::find_pointwise_ranges(const std::vector<std::size_t>& bricks) {
  parallel_for(bricks.size(), [&](std::size_t n) {
    const std::size_t b = bricks[n];
    if (!is_pointwise(b)) return;
    Vec3d lo, hi;
    m_pointwise->source_box(pointwise_brick(b), lo, hi);
    m_ranges[b] =
        lo.x > hi.x ? EncodedRange() : reached_range(*m_source, lo - Vec3d(1), hi + Vec3d(1));
  });
}

std::size_t OffsetBricks::bytes() const {
  return m_index.bytes() + (m_states.capacity() + m_beneath.capacity()) * sizeof(std::int32_t) +
         m_ranges.capacity() * sizeof(EncodedRange) + m_valid.capacity() * sizeof(IndexBox) +
         m_offsets.bytes();
}

bool pull_back_smoothly(const OffsetBricks& bricks, const Vec3d& place, const Vec3f& gradient,
                        Vec3f& pulled) {
  const double per_voxel = nodes_per_voxel(bricks);
  pulled = gradient;
  for (int a = 0; a < 3; ++a) {
    Vec3d half(0.0);
    half[a] = 0.5 / per_voxel;
    Vec3f below, above;
    if (!offset_at(bricks, place - half, below) || !offset_at(bricks, place + half, above)) {
      return false;
    }
    pulled[a] += (above - below).dot(gradient) * float(per_voxel);
  }
  return true;
}

Vec3f pull_back_gradient(const NodeCell& cell, const Vec3f& gradient) {
  const int sz = 3, sy = sz * cell.dim, sx = sy * cell.dim;
  const float* n = cell.node;
  const Float4 corners[8] = {load(n),           load(n + sz),          load(n + sy),
                             load(n + sy + sz), load(n + sx),          load(n + sx + sz),
                             load(n + sx + sy), load(n + sx + sy + sz)};
  const NodeDerivatives o = derivatives_of(corners, cell.x, cell.y, cell.z);
  const float per_voxel = float(cell.dim - 1) / kBrickDim;
  return gradient + per_voxel * Vec3f(dot(o.along_x, gradient), dot(o.along_y, gradient),
                                      dot(o.along_z, gradient));
}

}  // namespace supple

// Offsets of lanes: read from the nodes of deformed bricks, or found by each lane itself.
#if defined(SUPPLE_RAYCAST_SAMPLE_OFFSETS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUPPLE_RAYCAST_SAMPLE_OFFSETS_INL_H
#undef SUPPLE_RAYCAST_SAMPLE_OFFSETS_INL_H
#else
#define SUPPLE_RAYCAST_SAMPLE_OFFSETS_INL_H
#endif

#include <cstring>

#include "raycast/sample/sample_batch.h"
#include "raycast/sample/sample_nodes-inl.h"
#include "volumes/field/brick_nodes.h"

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

HWY_INLINE HWY_ATTR Float4 load4(const float* from) {
  Float4 value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
HWY_INLINE HWY_ATTR Float4 mix4(Float4 a, Float4 b, float t) {
  return a + t * (b - a);
}

/// Trilinear offset of one lane; not a number when a corner has none.
HWY_INLINE HWY_ATTR Float4 trilinear_offset(const float* node, int dim, float x, float y, float z) {
  const int sz = 3, sy = sz * dim, sx = sy * dim;
  const Float4 a = mix4(load4(node), load4(node + sz), z);
  const Float4 b = mix4(load4(node + sy), load4(node + sy + sz), z);
  const Float4 c = mix4(load4(node + sx), load4(node + sx + sz), z);
  const Float4 d = mix4(load4(node + sx + sy), load4(node + sx + sy + sz), z);
  return mix4(mix4(a, b, y), mix4(c, d, y), x);
}

/// The place in a cell of two voxels, from that in the cell of one.
HWY_INLINE HWY_ATTR VF in_wide_cell(VI voxel, VF f) {
  return hn::Mul(floats(0.5f), hn::Add(f, hn::ConvertTo(kFloats, hn::And(voxel, ints(1)))));
}

/// Stores the places of lanes among the nodes of their slots, `dim` along every axis.
HWY_INLINE HWY_ATTR void store_offset_cells(int dim, VI slot, IntVector voxel, FloatVector f,
                                            int at, SampleBatch& batch) {
  const VI low = ints(7);
  voxel = {hn::And(voxel.x, low), hn::And(voxel.y, low), hn::And(voxel.z, low)};
  if (dim < BrickNodes::kDim) {
    f = {in_wide_cell(voxel.x, f.x), in_wide_cell(voxel.y, f.y), in_wide_cell(voxel.z, f.z)};
    voxel = {hn::ShiftRight<1>(voxel.x), hn::ShiftRight<1>(voxel.y), hn::ShiftRight<1>(voxel.z)};
  }
  const VI along = ints(dim);
  const VI row = hn::Add(hn::Mul(hn::Add(hn::Mul(slot, along), voxel.x), along), voxel.y);
  hn::Store(hn::Add(hn::Mul(row, along), voxel.z), kInts, batch.offset_node + at);
  hn::Store(f.x, kFloats, batch.ox + at);
  hn::Store(f.y, kFloats, batch.oy + at);
  hn::Store(f.z, kFloats, batch.oz + at);
}

/// How far lanes are moved, and those for which that is known.
struct Moves {
  alignas(64) float along[3][SampleBatch::kLanes] = {};
  std::uint32_t known = 0;
};

/// The offsets of the lanes `bent`; the batch holds where their offset cells are.
HWY_INLINE HWY_ATTR void follow_offsets(const SamplingTables& tables, std::uint32_t bent, int at,
                                        const SampleBatch& batch, Moves& moves) {
  for (std::uint32_t rest = bent; rest != 0; rest &= rest - 1) {
    const int lane = __builtin_ctz(rest);
    const int n = at + lane;
    const Float4 offset =
        trilinear_offset(tables.offsets + std::int64_t(batch.offset_node[n]) * 3, tables.offset_dim,
                         batch.ox[n], batch.oy[n], batch.oz[n]);
    const float sum = offset[0] + offset[1] + offset[2];
    if (!(sum == sum)) continue;
    for (int a = 0; a < 3; ++a) moves.along[a][lane] = offset[a];
    moves.known |= 1u << lane;
  }
}

/// The offsets of these lanes, which each finds for itself, beginning where those before lead.
HWY_INLINE HWY_ATTR void find_offsets(const SamplingTables& tables, std::uint32_t lanes, VI entry,
                                      const FloatVector& p, const Vec3i& base, int at,
                                      SampleBatch& batch, Moves& moves) {
  alignas(64) std::int32_t entries[SampleBatch::kLanes];
  alignas(64) float x[SampleBatch::kLanes], y[SampleBatch::kLanes], z[SampleBatch::kLanes];
  hn::Store(entry, kInts, entries);
  hn::Store(p.x, kFloats, x);
  hn::Store(p.y, kFloats, y);
  hn::Store(p.z, kFloats, z);
  PointwiseOffsets::Sample found;
  Vec3d slope(0);  // of the offset from lane to lane
  int last = -1;   // lane that was found
  for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
    const int lane = __builtin_ctz(rest);
    const Vec3d place = Vec3d(base) + Vec3d(x[lane], y[lane], z[lane]);
    const std::size_t brick = std::size_t(entries[lane] - SamplingTables::kPointwise);
    const Vec3d before = found.offset;
    if (last >= 0) found.offset += slope * double(lane - last);
    if (!tables.pointwise->sample(brick, place, found)) {
      found.offset = before;
      continue;
    }
    if (last >= 0) slope = (found.offset - before) / double(lane - last);
    last = lane;
    for (int a = 0; a < 3; ++a) moves.along[a][lane] = float(found.offset[a]);
    moves.known |= 1u << lane;
    batch.piece[at + lane] = found.piece;
  }
}

/// Turns the lanes of pointwise bricks whose cells are interpolated into lanes of deformed bricks:
/// their entries become slots.
HWY_INLINE HWY_ATTR void interpolate_cells(const SamplingTables& tables, std::uint32_t lanes,
                                           const IntVector& voxel, VI& entry) {
  alignas(64) std::int32_t entries[SampleBatch::kLanes], cells[SampleBatch::kLanes];
  hn::Store(entry, kInts, entries);
  hn::Store(node_of(voxel, 64, 8, 1), kInts, cells);
  for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
    const int lane = __builtin_ctz(rest);
    const std::size_t brick = std::size_t(entries[lane] - SamplingTables::kPointwise);
    const std::int32_t slot = tables.pointwise_slots[brick];
    if (slot < 0 || !mask_test(tables.interpolated[brick], cells[lane])) continue;
    entries[lane] = SamplingTables::kDeformed + slot;
  }
  entry = hn::Load(kInts, entries);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();

#endif

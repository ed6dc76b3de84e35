#include "raycast/sample/sample_batch.h"

#include "raycast/sample/source_bricks.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raycast/sample/sample_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// This include is not above: foreach_target.h comes first.
#include "raycast/sample/sample_nodes-inl.h"
#include "raycast/sample/sample_offsets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

/// 0 <= value < limit.
HWY_INLINE HWY_ATTR MI in_range(VI value, std::int32_t limit) {
  return hn::And(hn::Gt(value, ints(-1)), hn::Lt(value, ints(limit)));
}

/// table[index], index 0 in lanes that are not wanted. The samples of a ray mostly ask for the same
/// one, which is read once.
HWY_INLINE HWY_ATTR VI read_shared(const std::int32_t* table, VI index, MI wanted) {
  const std::int32_t first = hn::GetLane(index);
  const MI differs = hn::And(wanted, hn::Ne(index, ints(first)));
  if (hn::AllFalse(kInts, differs)) return ints(table[first]);
  return hn::GatherIndex(kInts, table, index);
}

/// Places of voxels' bricks in the tables of a look-up; `found`: lanes whose tables are there.
struct Places {
  VI place;
  MI found;
};
HWY_INLINE HWY_ATTR Places find_places(const BrickLookup& lookup, const IntVector& voxel,
                                       MI wanted) {
  const VI rx = hn::Sub(hn::ShiftRight<7>(voxel.x), ints(lookup.region_lo.x));
  const VI ry = hn::Sub(hn::ShiftRight<7>(voxel.y), ints(lookup.region_lo.y));
  const VI rz = hn::Sub(hn::ShiftRight<7>(voxel.z), ints(lookup.region_lo.z));
  const MI inside =
      hn::And(hn::And(wanted, in_range(rx, lookup.region_dims.x)),
              hn::And(in_range(ry, lookup.region_dims.y), in_range(rz, lookup.region_dims.z)));
  const VI row = hn::Add(hn::Mul(rx, ints(lookup.region_dims.y)), ry);
  const VI region = hn::Add(hn::Mul(row, ints(lookup.region_dims.z)), rz);
  const VI table = read_shared(lookup.regions, hn::IfThenElseZero(inside, region), inside);
  const MI found = hn::And(inside, hn::Gt(table, ints(-1)));

  const VI low = ints(15);
  const VI bx = hn::And(hn::ShiftRight<3>(voxel.x), low);
  const VI by = hn::And(hn::ShiftRight<3>(voxel.y), low);
  const VI bz = hn::And(hn::ShiftRight<3>(voxel.z), low);
  const VI place = hn::Or(hn::ShiftLeft<12>(table),
                          hn::Or(hn::ShiftLeft<8>(bx), hn::Or(hn::ShiftLeft<4>(by), bz)));
  return {hn::IfThenElseZero(found, place), found};
}

/// Entries of the tables at these places; kSkip where there is no brick.
HWY_INLINE HWY_ATTR VI entries_at(const BrickLookup& lookup, const Places& places) {
  const VI entry = hn::GatherIndex(kInts, lookup.tables, places.place);
  return hn::IfThenElse(places.found, entry, ints(SamplingTables::kSkip));
}

/// Voxel below a position, and the place in its cell.
HWY_INLINE HWY_ATTR IntVector split(const FloatVector& p, FloatVector& fraction) {
  const VF x = hn::Floor(p.x), y = hn::Floor(p.y), z = hn::Floor(p.z);
  fraction = {hn::Sub(p.x, x), hn::Sub(p.y, y), hn::Sub(p.z, z)};
  return {hn::ConvertTo(kInts, x), hn::ConvertTo(kInts, y), hn::ConvertTo(kInts, z)};
}

HWY_INLINE HWY_ATTR IntVector from_base(const IntVector& v, const Vec3i& base) {
  return {hn::Add(v.x, ints(base.x)), hn::Add(v.y, ints(base.y)), hn::Add(v.z, ints(base.z))};
}

/// Lanes whose density is not transparent.
HWY_INLINE HWY_ATTR MI visible_lanes(const SamplingTables& tables, VF encoded, MI inside) {
  const VF entry = hn::Min(
      hn::Max(hn::Mul(hn::Sub(encoded, floats(tables.first_code)), floats(tables.entries_per_code)),
              floats(0)),
      floats(tables.last_entry));
  const VI n = hn::IfThenElseZero(inside, hn::ConvertTo(kInts, entry));
  const MI between = hn::And(hn::And(inside, hn::Gt(n, ints(tables.first_visible - 1))),
                             hn::Lt(n, ints(tables.last_visible + 1)));
  if (tables.visible_bits == nullptr || hn::AllFalse(kInts, between)) return between;
  const VI word = hn::GatherIndex(kInts, tables.visible_bits, hn::ShiftRight<5>(n));
  const VI bit = hn::Shl(ints(1), hn::And(n, ints(31)));
  return hn::And(between, hn::TestBit(word, bit));
}

HWY_INLINE HWY_ATTR void ensure_bricks(const SourceBricks& bricks, const std::int32_t* of_lane,
                                       std::uint32_t lanes) {
  std::int32_t last = -1;
  for (std::uint32_t rest = lanes; rest != 0; rest &= rest - 1) {
    const std::int32_t brick = of_lane[__builtin_ctz(rest)];
    if (brick != last) bricks.ensure(std::size_t(brick));
    last = brick;
  }
}

/// Reads one vector of lanes, starting at lane `at`; `wanted` is relative to it.
HWY_INLINE HWY_ATTR void sample_lanes(const SamplingTables& tables, const RayPiece& piece,
                                      FloatVector p, MI wanted, int at, SampleBatch& batch) {
  FloatVector f;
  IntVector voxel = from_base(split(p, f), piece.base);
  const Places places = find_places(tables.output, voxel, wanted);
  VI entry = entries_at(tables.output, places);
  MI reading = hn::And(wanted, hn::Gt(entry, ints(SamplingTables::kSkip)));
  if (piece.above > -std::numeric_limits<float>::infinity()) {
    const VF highest = hn::GatherIndex(kFloats, tables.output_highest, places.place);
    reading = hn::And(reading, hn::RebindMask(kInts, hn::Gt(highest, floats(piece.above))));
  }
  if (hn::AllFalse(kInts, reading)) return;

  const MI moved = hn::And(reading, hn::Gt(entry, ints(SamplingTables::kPointwise - 1)));
  std::uint32_t bent = 0, pointwise = 0, split_lanes = 0;
  if (!hn::AllFalse(kInts, moved)) {
    const auto deformed_lanes = [&] {
      return bits_of(hn::And(moved, hn::Gt(entry, ints(SamplingTables::kDeformed - 1))));
    };
    bent = deformed_lanes();
    pointwise = bits_of(moved) & ~bent;
    if (pointwise != 0 && tables.pointwise_slots != nullptr) {
      interpolate_cells(tables, pointwise, voxel, entry);
      bent = deformed_lanes();
      split_lanes = pointwise & bent;
      pointwise &= ~bent;
    }
    const VI slot = hn::Sub(entry, ints(SamplingTables::kDeformed));
    store_offset_cells(tables.offset_dim, slot, voxel, f, at, batch);
    Moves moves;
    follow_offsets(tables, bent, at, batch, moves);
    if (pointwise != 0) {
      find_offsets(tables, pointwise, entry, p, piece.base, at, batch, moves);
    }
    p = {hn::Add(p.x, hn::Load(kFloats, moves.along[0])),
         hn::Add(p.y, hn::Load(kFloats, moves.along[1])),
         hn::Add(p.z, hn::Load(kFloats, moves.along[2]))};
    voxel = from_base(split(p, f), piece.base);
    const VI source =
        entries_at(tables.source, find_places(tables.source, voxel, mask_of(moves.known)));
    entry = hn::IfThenElse(moved, source, entry);
    reading = hn::And(reading, hn::Gt(entry, ints(SamplingTables::kSkip)));
  }

  const VI node =
      hn::Add(node_of(voxel, kStepX, kStepY, 1), ints(kStepX + kStepY + SourceBricks::kStepZ));
  hn::Store(entry, kInts, batch.brick + at);
  hn::Store(node, kInts, batch.node + at);
  hn::Store(f.x, kFloats, batch.x + at);
  hn::Store(f.y, kFloats, batch.y + at);
  hn::Store(f.z, kFloats, batch.z + at);
  hn::Store(p.x, kFloats, batch.px + at);
  hn::Store(p.y, kFloats, batch.py + at);
  hn::Store(p.z, kFloats, batch.pz + at);

  const std::uint32_t read = bits_of(reading);
  ensure_bricks(*tables.bricks, batch.brick + at, read);
  std::uint32_t inside = 0, visible = 0;
  for (std::uint32_t rest = read; rest != 0;) {
    const NodeReader nodes(tables, batch.brick[at + __builtin_ctz(rest)], entry, node,
                           mask_of(rest));
    Interpolated density = read_density(nodes, f);
    if (tables.is_cubic) density.value = read_cubic_density(nodes, f, density.value);
    const MI known = hn::And(density.known, nodes.near());
    hn::BlendedStore(density.value, hn::RebindMask(kFloats, known), kFloats, batch.encoded + at);
    inside |= bits_of(known);
    visible |= bits_of(visible_lanes(tables, density.value, known));
    rest &= ~bits_of(nodes.near());
  }
  batch.read |= read << at;
  batch.inside |= inside << at;
  batch.visible |= visible << at;
  batch.bent |= (bent & read) << at;
  batch.pointwise |= (pointwise & read) << at;
  batch.split |= (split_lanes & read) << at;
}

HWY_ATTR void sample_batch_impl(const SamplingTables& tables, const RayPiece& piece, int first,
                                int stride, int count, SampleBatch& batch) {
  batch.read = batch.inside = batch.visible = batch.bent = batch.pointwise = batch.split = 0;
  const int lanes = int(hn::Lanes(kFloats));
  for (int at = 0; at < count; at += lanes) {
    const VI number = hn::Iota(kInts, at);
    const VF n = hn::ConvertTo(kFloats, hn::Add(hn::Mul(number, ints(stride)), ints(first)));
    const FloatVector p = {hn::MulAdd(n, floats(piece.per_sample.x), floats(piece.first.x)),
                           hn::MulAdd(n, floats(piece.per_sample.y), floats(piece.first.y)),
                           hn::MulAdd(n, floats(piece.per_sample.z), floats(piece.first.z))};
    sample_lanes(tables, piece, p, hn::Lt(number, ints(count)), at, batch);
  }
}

HWY_ATTR void sample_places_impl(const SamplingTables& tables, const SamplePlaces& places,
                                 int count, SampleBatch& batch) {
  batch.read = batch.inside = batch.visible = batch.bent = batch.pointwise = batch.split = 0;
  RayPiece piece;
  piece.base = places.base;
  const int lanes = int(hn::Lanes(kFloats));
  for (int at = 0; at < count; at += lanes) {
    const MI wanted = hn::Lt(hn::Iota(kInts, at), ints(count));
    const MF known = hn::RebindMask(kFloats, wanted);
    const FloatVector p = {hn::IfThenElseZero(known, hn::Load(kFloats, places.x + at)),
                           hn::IfThenElseZero(known, hn::Load(kFloats, places.y + at)),
                           hn::IfThenElseZero(known, hn::Load(kFloats, places.z + at))};
    sample_lanes(tables, piece, p, wanted, at, batch);
  }
}

HWY_ATTR void sample_gradients_impl(const SamplingTables& tables, SampleBatch& batch,
                                    std::uint32_t wanted) {
  const int lanes = int(hn::Lanes(kFloats));
  for (int at = 0; at < SampleBatch::kLanes; at += lanes) {
    const std::uint32_t all = lanes < 32 ? (1u << lanes) - 1 : ~0u;
    std::uint32_t rest = wanted >> at & all;
    const VI brick = hn::Load(kInts, batch.brick + at), node = hn::Load(kInts, batch.node + at);
    const FloatVector f = {hn::Load(kFloats, batch.x + at), hn::Load(kFloats, batch.y + at),
                           hn::Load(kFloats, batch.z + at)};
    while (rest != 0) {
      const NodeReader nodes(tables, batch.brick[at + __builtin_ctz(rest)], brick, node,
                             mask_of(rest));
      const FloatVector g =
          tables.is_cubic ? read_cubic_gradient(nodes, f) : read_gradient(nodes, f);
      const MF near = hn::RebindMask(kFloats, nodes.near());
      hn::BlendedStore(g.x, near, kFloats, batch.gx + at);
      hn::BlendedStore(g.y, near, kFloats, batch.gy + at);
      hn::BlendedStore(g.z, near, kFloats, batch.gz + at);
      rest &= ~bits_of(nodes.near());
    }
  }
}

const char* instruction_set_impl() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace supple {

HWY_EXPORT(sample_batch_impl);
HWY_EXPORT(sample_places_impl);
HWY_EXPORT(sample_gradients_impl);
HWY_EXPORT(instruction_set_impl);

void sample_batch(const SamplingTables& tables, const RayPiece& piece, int first, int stride,
                  int count, SampleBatch& batch) {
  HWY_DYNAMIC_DISPATCH(sample_batch_impl)(tables, piece, first, stride, count, batch);
}

void sample_places(const SamplingTables& tables, const SamplePlaces& places, int count,
                   SampleBatch& batch) {
  HWY_DYNAMIC_DISPATCH(sample_places_impl)(tables, places, count, batch);
}

void sample_gradients(const SamplingTables& tables, SampleBatch& batch, std::uint32_t wanted) {
  HWY_DYNAMIC_DISPATCH(sample_gradients_impl)(tables, batch, wanted);
}

const char* sampling_instruction_set() {
  return HWY_DYNAMIC_DISPATCH(instruction_set_impl)();
}

std::vector<std::string> sampling_instruction_sets() {
  std::vector<std::string> names;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    names.push_back(hwy::TargetName(target));
  }
  return names;
}

void choose_sampling_instruction_set(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (name == hwy::TargetName(target)) hwy::SetSupportedTargetsForTest(target);
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace supple
#endif

#include "raycast/microscope/haze_lanes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raycast/microscope/haze_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// These includes are not above: foreach_target.h comes first.
#include <hwy/contrib/math/math-inl.h>

#include "raycast/sample/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

/// Cells that lanes lie in: the number of their low node, and the place in them.
struct HazeCells {
  VI node;
  IntVector voxel;
  FloatVector f;
};

HWY_INLINE HWY_ATTR VF clamped(VF x, float most) {
  return hn::Min(hn::Max(x, floats(0)), floats(most));
}

HWY_INLINE HWY_ATTR HazeCells cells_at(const HazeTables& tables, const FloatVector& p) {
  HazeCells cells;
  const Vec3i& dims = tables.dims;
  const VF x = hn::Floor(clamped(p.x, float(dims.x) - 1.5f));
  const VF y = hn::Floor(clamped(p.y, float(dims.y) - 1.5f));
  const VF z = hn::Floor(clamped(p.z, float(dims.z) - 1.5f));
  cells.f = {clamped(hn::Sub(p.x, x), 1), clamped(hn::Sub(p.y, y), 1), clamped(hn::Sub(p.z, z), 1)};
  cells.voxel = {hn::ConvertTo(kInts, x), hn::ConvertTo(kInts, y), hn::ConvertTo(kInts, z)};
  cells.node =
      hn::Add(hn::Mul(hn::Add(hn::Mul(cells.voxel.x, ints(dims.y)), cells.voxel.y), ints(dims.z)),
              cells.voxel.z);
  return cells;
}

HWY_INLINE HWY_ATTR const std::int32_t* as_ints(const std::vector<std::uint32_t>& values) {
  return reinterpret_cast<const std::int32_t*>(values.data());
}

template <int kShift>
HWY_INLINE HWY_ATTR VF byte_of(VI quad) {
  return hn::ConvertTo(kFloats, hn::And(hn::ShiftRight<kShift>(quad), ints(255)));
}

/// Densities in the source, 0 … 255.
HWY_INLINE HWY_ATTR VF density_at(const HazeTables& tables, const HazeCells& cells) {
  const std::int32_t* quads = as_ints(tables.quads);
  const VI next = ints(tables.dims.y * tables.dims.z);
  const VI a = hn::GatherIndex(kInts, quads, cells.node);
  const VI b = hn::GatherIndex(kInts, quads, hn::Add(cells.node, next));
  const VF a0 = mix(byte_of<0>(a), byte_of<8>(a), cells.f.z);
  const VF a1 = mix(byte_of<16>(a), byte_of<24>(a), cells.f.z);
  const VF b0 = mix(byte_of<0>(b), byte_of<8>(b), cells.f.z);
  const VF b1 = mix(byte_of<16>(b), byte_of<24>(b), cells.f.z);
  return mix(mix(a0, a1, cells.f.y), mix(b0, b1, cells.f.y), cells.f.x);
}

/// Vectors interpolated between the nodes that know one, and these nodes' part.
struct CellOffsets {
  FloatVector along;
  VF known;
};

HWY_INLINE HWY_ATTR CellOffsets offsets_at(const std::int32_t* packed, const HazeTables& tables,
                                           const HazeCells& cells) {
  const VF one = floats(1), nothing = floats(0);
  const VI low = ints(2 * packed_offset::kMiddle - 1);
  CellOffsets sum{{nothing, nothing, nothing}, nothing};
  for (int n = 0; n < 8; ++n) {
    const int dx = n >> 2, dy = (n >> 1) & 1, dz = n & 1;
    const VI step = ints((dx * tables.dims.y + dy) * tables.dims.z + dz);
    const VI node = hn::GatherIndex(kInts, packed, hn::Add(cells.node, step));
    const VF wx = dx ? cells.f.x : hn::Sub(one, cells.f.x);
    const VF wy = dy ? cells.f.y : hn::Sub(one, cells.f.y);
    const VF wz = dz ? cells.f.z : hn::Sub(one, cells.f.z);
    const MI knows = hn::Ne(hn::And(node, ints(3)), ints(0));
    const VF w = hn::IfThenElseZero(hn::RebindMask(kFloats, knows), hn::Mul(hn::Mul(wx, wy), wz));
    const auto component = [&](VI shifted) {
      return hn::ConvertTo(kFloats, hn::Sub(hn::And(shifted, low), ints(packed_offset::kMiddle)));
    };
    sum.along.x = hn::MulAdd(w, component(hn::ShiftRight<2>(node)), sum.along.x);
    sum.along.y = hn::MulAdd(w, component(hn::ShiftRight<12>(node)), sum.along.y);
    sum.along.z = hn::MulAdd(w, component(hn::ShiftRight<22>(node)), sum.along.z);
    sum.known = hn::Add(sum.known, w);
  }
  const VF scale = hn::Div(floats(packed_offset::kUnit), hn::Max(sum.known, floats(1e-6f)));
  sum.along = {hn::Mul(sum.along.x, scale), hn::Mul(sum.along.y, scale),
               hn::Mul(sum.along.z, scale)};
  return sum;
}

/// Light that reaches a place.
HWY_INLINE HWY_ATTR VF light_at(const HazeLight& light, const FloatVector& p) {
  // The source has a size: a cone's tip would be smaller than steps.
  constexpr float kSource = 0.25f;
  if (!(light.power > 0)) return floats(light.ambient);
  const VF x = hn::Sub(p.x, floats(light.place.x)), y = hn::Sub(p.y, floats(light.place.y)),
           z = hn::Sub(p.z, floats(light.place.z));
  const VF square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::MulAdd(z, z, floats(kSource))));
  const VF along =
      hn::MulAdd(x, floats(light.direction.x),
                 hn::MulAdd(y, floats(light.direction.y), hn::Mul(z, floats(light.direction.z))));
  const VF cosine = hn::Div(along, hn::Sqrt(square));
  const float width = std::max(light.inner_cosine - light.outer_cosine, 1e-4f);
  const VF t = clamped(hn::Mul(hn::Sub(cosine, floats(light.outer_cosine)), floats(1 / width)), 1);
  const VF fade = hn::Mul(hn::Mul(t, t), hn::Sub(floats(3), hn::Add(t, t)));
  const VF falls = hn::Div(floats(light.half_square), hn::Add(square, floats(light.half_square)));
  return hn::MulAdd(hn::Mul(fade, falls), floats(light.power), floats(light.ambient));
}

HWY_INLINE HWY_ATTR VI bricks_of(const HazeTables& tables, const IntVector& voxel) {
  const VI row = hn::Add(hn::Mul(hn::ShiftRight<3>(voxel.x), ints(tables.brick_dims.y)),
                         hn::ShiftRight<3>(voxel.y));
  const VI brick = hn::Add(hn::Mul(row, ints(tables.brick_dims.z)), hn::ShiftRight<3>(voxel.z));
  return hn::GatherIndex(kInts, tables.bricks.data(), brick);
}

/// Densities at places of the present space; `wanted`: of these lanes.
HWY_INLINE HWY_ATTR VF haze_at(const HazeTables& tables, const FloatVector& p, MF wanted) {
  HazeCells cells = cells_at(tables, p);
  const VI brick =
      hn::IfThenElseZero(hn::RebindMask(kInts, wanted), bricks_of(tables, cells.voxel));
  const MI visible = hn::Gt(brick, ints(std::int32_t(HazeBrick::empty)));
  if (hn::AllFalse(kInts, visible)) return floats(0);
  MF reads = hn::RebindMask(kFloats, visible);
  const MF moved = hn::RebindMask(kFloats, hn::Gt(brick, ints(std::int32_t(HazeBrick::resting))));
  if (!hn::AllFalse(kFloats, moved)) {
    const CellOffsets o = offsets_at(as_ints(tables.offsets), tables, cells);
    const FloatVector source = {hn::Add(p.x, hn::IfThenElseZero(moved, o.along.x)),
                                hn::Add(p.y, hn::IfThenElseZero(moved, o.along.y)),
                                hn::Add(p.z, hn::IfThenElseZero(moved, o.along.z))};
    reads = hn::And(reads, hn::Or(hn::Not(moved), hn::Gt(o.known, floats(0))));
    const auto inside = [&](VF x, int dim) {
      return hn::And(hn::Ge(x, floats(-0.01f)), hn::Le(x, floats(float(dim) - 0.99f)));
    };
    reads = hn::And(hn::And(reads, inside(source.x, tables.dims.x)),
                    hn::And(inside(source.y, tables.dims.y), inside(source.z, tables.dims.z)));
    cells = cells_at(tables, source);
  }
  return hn::IfThenElseZero(reads, density_at(tables, cells));
}

/// Exponential of numbers up to 0; of small ones by its series.
HWY_INLINE HWY_ATTR VF passed(VF x) {
  if (!hn::AllTrue(kFloats, hn::Gt(x, floats(-0.2f)))) return hn::Exp(kFloats, x);
  VF sum = hn::MulAdd(x, floats(1 / 24.0f), floats(1 / 6.0f));
  sum = hn::MulAdd(x, sum, floats(0.5f));
  sum = hn::MulAdd(x, sum, floats(1));
  return hn::MulAdd(x, sum, floats(1));
}

HWY_INLINE HWY_ATTR void march_lanes(const HazeTables& tables, const HazeLight& light,
                                     HazeRays& rays, int at) {
  const FloatVector origin = {hn::Load(kFloats, rays.origin[0] + at),
                              hn::Load(kFloats, rays.origin[1] + at),
                              hn::Load(kFloats, rays.origin[2] + at)};
  const FloatVector step = {hn::Load(kFloats, rays.step[0] + at),
                            hn::Load(kFloats, rays.step[1] + at),
                            hn::Load(kFloats, rays.step[2] + at)};
  const VF count = hn::Load(kFloats, rays.count + at);
  const VF thickness =
      hn::Mul(hn::Load(kFloats, rays.length + at), floats(-light.extinction / 255));
  VF passes = floats(1), sum = floats(0);
  for (float n = 0.5f;; n += 1) {
    const MF wanted = hn::Lt(floats(n), count);
    if (hn::AllFalse(kFloats, wanted)) break;
    const FloatVector p = {hn::MulAdd(floats(n), step.x, origin.x),
                           hn::MulAdd(floats(n), step.y, origin.y),
                           hn::MulAdd(floats(n), step.z, origin.z)};
    const VF density = haze_at(tables, p, wanted);
    if (hn::AllFalse(kFloats, hn::Gt(density, floats(0)))) continue;
    const VF left = hn::Mul(passes, passed(hn::Mul(density, thickness)));
    sum = hn::MulAdd(hn::Sub(passes, left), light_at(light, p), sum);
    passes = left;
  }
  hn::Store(sum, kFloats, rays.light + at);
  hn::Store(passes, kFloats, rays.passes + at);
}

HWY_ATTR void march_haze_impl(const HazeTables& tables, const HazeLight& light, HazeRays& rays) {
  for (int at = 0; at < HazeRays::kMost; at += int(hn::Lanes(kFloats))) {
    march_lanes(tables, light, rays, at);
  }
}

HWY_INLINE HWY_ATTR VF component_of(VI shifted) {
  const VI field = hn::And(shifted, ints(2 * packed_offset::kMiddle - 1));
  return hn::Mul(hn::ConvertTo(kFloats, hn::Sub(field, ints(packed_offset::kMiddle))),
                 floats(packed_offset::kUnit));
}

HWY_INLINE HWY_ATTR VI packed_component(VF component) {
  const VF limited = hn::Min(hn::Max(component, floats(-packed_offset::kLargest)),
                             floats(packed_offset::kLargest));
  return hn::Add(hn::NearestInt(hn::Mul(limited, floats(1 / packed_offset::kUnit))),
                 ints(packed_offset::kMiddle));
}

HWY_INLINE HWY_ATTR VF largest_of(const FloatVector& v) {
  return hn::Max(hn::Abs(v.x), hn::Max(hn::Abs(v.y), hn::Abs(v.z)));
}

/// CellOffsets of lanes of nodes, packed.
HWY_INLINE HWY_ATTR VI solved_offsets(const HazeTables& tables, VI node, const FloatVector& p) {
  constexpr int kRounds = 12;
  constexpr float kSame = 1 / 64.0f, kNear = 0.25f;  // voxels
  const VI start = hn::GatherIndex(kInts, as_ints(tables.offsets), node);
  FloatVector o = {component_of(hn::ShiftRight<2>(start)), component_of(hn::ShiftRight<12>(start)),
                   component_of(hn::ShiftRight<22>(start))};
  VF change = floats(0), known = floats(0);
  for (int round = 0; round < kRounds; ++round) {
    const FloatVector source = {hn::Add(p.x, o.x), hn::Add(p.y, o.y), hn::Add(p.z, o.z)};
    const CellOffsets u = offsets_at(as_ints(tables.ways), tables, cells_at(tables, source));
    known = u.known;
    // Lanes in the void stay where they are.
    const MF finds = hn::Gt(known, floats(0));
    const FloatVector by = {hn::IfThenElseZero(finds, hn::Add(o.x, u.along.x)),
                            hn::IfThenElseZero(finds, hn::Add(o.y, u.along.y)),
                            hn::IfThenElseZero(finds, hn::Add(o.z, u.along.z))};
    o = {hn::Sub(o.x, by.x), hn::Sub(o.y, by.y), hn::Sub(o.z, by.z)};
    change = largest_of(by);
    if (hn::AllTrue(kFloats, hn::Le(change, floats(kSame)))) break;
  }
  const MF fits = hn::And(hn::Lt(change, floats(kNear)),
                          hn::Lt(largest_of(o), floats(packed_offset::kLargest)));
  const MF is_known = hn::And(fits, hn::Gt(known, floats(0)));
  const VI packed = hn::Or(
      hn::Or(hn::ShiftLeft<2>(packed_component(o.x)), hn::ShiftLeft<12>(packed_component(o.y))),
      hn::Or(hn::ShiftLeft<22>(packed_component(o.z)), ints(std::int32_t(packed_offset::kKnown))));
  return hn::IfThenElse(hn::RebindMask(kInts, is_known), packed,
                        ints(std::int32_t(packed_offset::kRest)));
}

HWY_ATTR void solve_offsets_impl(HazeTables& tables, const std::uint32_t* nodes, int count) {
  const int lanes = int(hn::Lanes(kFloats));
  alignas(64) std::int32_t of_lanes[kMostLanes], solved[kMostLanes];
  alignas(64) float place[3][kMostLanes];
  for (int at = 0; at < count; at += lanes) {
    for (int lane = 0; lane < lanes; ++lane) {
      const int node = int(nodes[std::min(at + lane, count - 1)]);
      const int row = node / tables.dims.z;
      of_lanes[lane] = node;
      place[0][lane] = float(row / tables.dims.y);
      place[1][lane] = float(row % tables.dims.y);
      place[2][lane] = float(node % tables.dims.z);
    }
    const FloatVector p = {hn::Load(kFloats, place[0]), hn::Load(kFloats, place[1]),
                           hn::Load(kFloats, place[2])};
    hn::Store(solved_offsets(tables, hn::Load(kInts, of_lanes), p), kInts, solved);
    for (int lane = 0; lane < std::min(lanes, count - at); ++lane) {
      tables.offsets[nodes[at + lane]] = std::uint32_t(solved[lane]);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace supple {

HWY_EXPORT(march_haze_impl);
HWY_EXPORT(solve_offsets_impl);

void solve_offsets(HazeTables& tables, const std::uint32_t* nodes, int count) {
  HWY_DYNAMIC_DISPATCH(solve_offsets_impl)(tables, nodes, count);
}

void march_haze(const HazeTables& tables, const HazeLight& light, HazeRays& rays) {
  HWY_DYNAMIC_DISPATCH(march_haze_impl)(tables, light, rays);
}

}  // namespace supple
#endif

#include "raycast/microscope/layer_lanes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raycast/microscope/layer_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// These includes are not above: foreach_target.h comes first.
#include "raycast/microscope/packet_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

constexpr float kNextLayerMm = 2e-3f;  // behind a surface the ray goes on
constexpr float kLeastSeen = 0.004f;   // of what comes behind
constexpr float kSkinLiftMm = 0.004f;  // of shadow rays of the globe

/// Numbers of a table with `stride` of them for each entry.
HWY_INLINE HWY_ATTR FloatVector gather_vector(const float* table, VI first) {
  return {hn::GatherIndex(kFloats, table, first),
          hn::GatherIndex(kFloats, table, hn::Add(first, ints(1))),
          hn::GatherIndex(kFloats, table, hn::Add(first, ints(2)))};
}

HWY_INLINE HWY_ATTR void put(MF mask, VF value, int at, LaneFloats& to) {
  store(hn::IfThenElse(mask, value, load(to, at)), at, to);
}
HWY_INLINE HWY_ATTR void put(MF mask, const FloatVector& value, int at, LaneVectors& to) {
  put(mask, value.x, at, to.x);
  put(mask, value.y, at, to.y);
  put(mask, value.z, at, to.z);
}

HWY_INLINE HWY_ATTR FloatVector normal_of(const CornerNormals* normals, const PacketHits& hits,
                                          int at, MF met) {
  const VI triangle =
      hn::IfThenElseZero(hn::RebindMask(kInts, met), hn::Load(kInts, hits.triangle + at));
  const VF u = load(hits.u, at), v = load(hits.v, at);
  const VF rest = hn::Sub(hn::Sub(floats(1), u), v);
  constexpr int kStride = sizeof(CornerNormals) / sizeof(float);
  const VI first = hn::Mul(triangle, ints(kStride));
  const float* table = &normals->of[0].x;
  const FloatVector a = scaled(gather_vector(table, first), rest);
  const FloatVector b = along(a, gather_vector(table, hn::Add(first, ints(3))), u);
  const FloatVector mixed = along(b, gather_vector(table, hn::Add(first, ints(6))), v);
  const VF length = hn::Sqrt(hn::Max(dot(mixed, mixed), floats(1e-30f)));
  return scaled(mixed, hn::Div(floats(1), length));
}

HWY_ATTR void put_hits_impl(const CornerNormals* normals, const SurfaceFloats* surfaces,
                            const PacketHits& hits, const PacketRays& rays, PacketPlaces& places) {
  const int lanes = int(hn::Lanes(kFloats));
  for (int at = 0; at < kPacketRays; at += lanes) {
    store(floats(kSkinLiftMm), at, places.lift_mm);
    if ((hits.met >> at & ((1u << lanes) - 1)) == 0) continue;
    const MF met = hn::RebindMask(kFloats, mask_of(hits.met >> at));
    const FloatVector direction = load(rays.direction, at);
    const FloatVector normal = normal_of(normals, hits, at, met);
    const MF is_behind = hn::Gt(dot(normal, direction), floats(0));
    const VF turn = hn::IfThenElse(is_behind, floats(-1), floats(1));
    put(met, along(load(rays.origin, at), direction, load(hits.distance, at)), at, places.at);
    put(met, scaled(normal, turn), at, places.normal);
    put(met, direction, at, places.from_eye);
    const VI shape =
        hn::IfThenElseZero(hn::RebindMask(kInts, met), hn::Load(kInts, hits.shape + at));
    constexpr int kStride = sizeof(SurfaceFloats) / sizeof(float);
    const VI first = hn::Mul(shape, ints(kStride));
    const auto of_surface = [&](const float& member)
                                HWY_ATTR { return hn::GatherIndex(kFloats, &member, first); };
    put(met, of_surface(surfaces->colour.x), at, places.red);
    put(met, of_surface(surfaces->colour.y), at, places.green);
    put(met, of_surface(surfaces->colour.z), at, places.blue);
    put(met, of_surface(surfaces->opacity), at, places.opacity);
    put(met, of_surface(surfaces->specular), at, places.specular);
    put(met, of_surface(surfaces->shininess), at, places.shininess);
    put(met, of_surface(surfaces->lift_mm), at, places.lift_mm);
  }
}

HWY_ATTR void add_layer_impl(const PacketLight& light, const LaneFloats& passing,
                             const PacketHits& hits, const LaneFloats& distance, float levels,
                             Layers& layers, PacketPicture& picture) {
  const int lanes = int(hn::Lanes(kFloats));
  std::uint32_t open = 0;
  for (int at = 0; at < kPacketRays; at += lanes) {
    const MF active = hn::RebindMask(kFloats, mask_of(layers.rays.active >> at));
    const VF clear = load(layers.clear, at), part = load(passing, at);
    const VF seen = hn::IfThenElseZero(active, clear);
    const auto add = [&](LaneFloats& sum, const LaneFloats& lit, const LaneFloats& around)
                         HWY_ATTR {
                           const VF colour = hn::MulAdd(load(lit, at), part, load(around, at));
                           store(hn::MulAdd(seen, colour, load(sum, at)), at, sum);
                         };
    add(picture.colour.red, light.lit.red, light.ambient.red);
    add(picture.colour.green, light.lit.green, light.ambient.green);
    add(picture.colour.blue, light.lit.blue, light.ambient.blue);
    const VF behind = hn::Mul(clear, hn::Sub(floats(1), load(light.opacity, at)));
    put(active, behind, at, layers.clear);
    const VF reached = load(distance, at);
    put(active, reached, at, layers.reached_mm);
    store(hn::Add(reached, floats(kNextLayerMm)), at, layers.rays.near);

    const MI met = mask_of(hits.met >> at);
    const VI shape =
        hn::IfThenElse(met, hn::Add(hn::Load(kInts, hits.shape + at), ints(2)), ints(1));
    const VI level = hn::ConvertTo(kInts, hn::MulAdd(part, floats(levels), floats(0.5f)));
    auto* key = reinterpret_cast<std::int32_t*>(picture.key + at);
    const VI before = hn::Load(kInts, key);
    const VI mixed = hn::Add(hn::ShiftLeft<3>(hn::Add(hn::Mul(before, ints(257)), shape)), level);
    hn::Store(hn::IfThenElse(hn::RebindMask(kInts, active), mixed, before), kInts, key);
    const MF goes_on =
        hn::And(hn::And(active, hn::RebindMask(kFloats, met)), hn::Gt(behind, floats(kLeastSeen)));
    open |= bits_of(hn::RebindMask(kInts, goes_on)) << at;
  }
  layers.rays.active = open;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace supple {

HWY_EXPORT(put_hits_impl);
HWY_EXPORT(add_layer_impl);

void put_hits(const CornerNormals* normals, const SurfaceFloats* surfaces, const PacketHits& hits,
              const PacketRays& rays, PacketPlaces& places) {
  HWY_DYNAMIC_DISPATCH(put_hits_impl)(normals, surfaces, hits, rays, places);
}

void add_layer(const PacketLight& light, const LaneFloats& passing, const PacketHits& hits,
               const LaneFloats& distance, float levels, Layers& layers, PacketPicture& picture) {
  HWY_DYNAMIC_DISPATCH(add_layer_impl)(light, passing, hits, distance, levels, layers, picture);
}

}  // namespace supple
#endif

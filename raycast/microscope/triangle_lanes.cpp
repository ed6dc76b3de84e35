#include "raycast/microscope/triangle_lanes.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raycast/microscope/triangle_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// These includes are not above: foreach_target.h comes first.
#include "raycast/microscope/packet_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

/// Rays that meet a triangle somewhere along their lines, and where.
struct LaneHits {
  MF met;
  VF distance, u, v;
};

/// T. Möller and B. Trumbore, Fast, minimum storage ray-triangle intersection, 1997; with the
/// triangle's normal at hand, so that a miss takes no division.
HWY_INLINE HWY_ATTR LaneHits meet(const TriangleFloats& triangle, const FloatVector& origin,
                                  const FloatVector& direction) {
  const FloatVector across = all(triangle.across);
  const VF steep = dot(across, direction);
  const VF sign = hn::And(steep, floats(-0.0f));
  const FloatVector to_corner = difference(all(triangle.corner), origin);
  const FloatVector turned = cross(to_corner, direction);
  const VF u = hn::Xor(dot(turned, all(triangle.to_third)), sign);
  const VF v = hn::Xor(hn::Neg(dot(turned, all(triangle.to_second))), sign);
  const VF whole = hn::Abs(steep);
  const MF inside = hn::And(hn::And(hn::Ge(u, floats(0)), hn::Ge(v, floats(0))),
                            hn::And(hn::Le(hn::Add(u, v), whole), hn::Gt(whole, floats(0))));
  LaneHits hits{inside, floats(0), u, v};
  if (hn::AllFalse(kFloats, inside)) return hits;
  const VF inverse = hn::Div(floats(1), hn::IfThenElse(inside, whole, floats(1)));
  hits.distance = hn::Mul(hn::Xor(dot(across, to_corner), sign), inverse);
  hits.u = hn::Mul(u, inverse);
  hits.v = hn::Mul(v, inverse);
  return hits;
}

HWY_ATTR void first_hits_impl(const TriangleFloats* triangles, const TriangleList& list,
                              const PacketRays& rays, PacketHits& hits) {
  const int lanes = int(hn::Lanes(kFloats));
  hits.met = 0;
  for (int at = 0; at < kPacketRays; at += lanes) {
    const FloatVector direction = load(rays.direction, at);
    // Places near the triangles have more digits than the eye, which may be far away.
    const VF near = load(rays.near, at);
    const FloatVector origin = along(load(rays.origin, at), direction, near);
    const MF active = hn::RebindMask(kFloats, mask_of(rays.active >> at));
    VF nearest = hn::IfThenElse(active, hn::Sub(load(rays.far, at), near), floats(-1));
    VF u = floats(0), v = floats(0);
    VI found = ints(-1);
    for (int n = 0; n < list.count; ++n) {
      const LaneHits next = meet(triangles[list.begin[n]], origin, direction);
      const MF is_nearer = hn::And(
          next.met, hn::And(hn::Ge(next.distance, floats(0)), hn::Lt(next.distance, nearest)));
      if (hn::AllFalse(kFloats, is_nearer)) continue;
      nearest = hn::IfThenElse(is_nearer, next.distance, nearest);
      u = hn::IfThenElse(is_nearer, next.u, u);
      v = hn::IfThenElse(is_nearer, next.v, v);
      found = hn::IfThenElse(hn::RebindMask(kInts, is_nearer), ints(std::int32_t(list.begin[n])),
                             found);
    }
    const std::uint32_t met = bits_of(hn::Gt(found, ints(-1)));
    hits.met |= met << at;
    if (met == 0) continue;
    store(hn::Add(nearest, near), at, hits.distance);
    store(u, at, hits.u);
    store(v, at, hits.v);
    hn::Store(found, kInts, hits.triangle + at);
    constexpr int kStride = sizeof(TriangleFloats) / sizeof(int);
    const VI entry = hn::Mul(hn::Max(found, ints(0)), ints(kStride));
    hn::Store(hn::GatherIndex(kInts, &triangles->shape, entry), kInts, hits.shape + at);
  }
}

HWY_ATTR void dim_rays_impl(const TriangleFloats* triangles, const TriangleList& list,
                            const PacketRays& rays, PacketDimming& dimming) {
  const int lanes = int(hn::Lanes(kFloats));
  dimming.blocked = 0;
  for (int at = 0; at < kPacketRays; at += lanes) {
    const FloatVector origin = load(rays.origin, at), direction = load(rays.direction, at);
    const VF near = load(rays.near, at), far = load(rays.far, at);
    const std::uint32_t active = rays.active >> at & ((1u << lanes) - 1);
    std::uint32_t blocked = 0;
    VI steps = ints(0);
    for (int n = 0; n < list.count && blocked != active; ++n) {
      const TriangleFloats& triangle = triangles[list.begin[n]];
      const LaneHits next = meet(triangle, origin, direction);
      const MF within =
          hn::And(next.met, hn::And(hn::Ge(next.distance, near), hn::Le(next.distance, far)));
      if (hn::AllFalse(kFloats, within)) continue;
      if (triangle.dim_steps == TriangleFloats::kBlocks)
        blocked |= bits_of(hn::RebindMask(kInts, within)) & active;
      else
        steps = hn::Add(
            steps, hn::IfThenElseZero(hn::RebindMask(kInts, within), ints(triangle.dim_steps)));
    }
    dimming.blocked |= blocked << at;
    hn::Store(steps, kInts, dimming.steps + at);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace supple {

HWY_EXPORT(first_hits_impl);
HWY_EXPORT(dim_rays_impl);

TriangleFloats triangle_floats(const std::array<Vec3f, 3>& corners) {
  TriangleFloats triangle{};
  triangle.corner = corners[0];
  triangle.to_second = corners[1] - corners[0];
  triangle.to_third = corners[2] - corners[0];
  triangle.across = triangle.to_second.cross(triangle.to_third);
  return triangle;
}

void first_hits(const TriangleFloats* triangles, const TriangleList& list, const PacketRays& rays,
                PacketHits& hits) {
  HWY_DYNAMIC_DISPATCH(first_hits_impl)(triangles, list, rays, hits);
}

void dim_rays(const TriangleFloats* triangles, const TriangleList& list, const PacketRays& rays,
              PacketDimming& dimming) {
  HWY_DYNAMIC_DISPATCH(dim_rays_impl)(triangles, list, rays, dimming);
}

}  // namespace supple
#endif

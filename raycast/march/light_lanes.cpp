#include "raycast/march/light_lanes.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raycast/march/light_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// This include is not above: foreach_target.h comes first.
#include <hwy/contrib/math/math-inl.h>

#include "raycast/sample/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

HWY_INLINE HWY_ATTR MF float_mask_of(std::uint32_t bits) {
  return hn::RebindMask(kFloats, mask_of(bits));
}
HWY_INLINE HWY_ATTR VF positive(VF value) {
  return hn::Max(value, floats(0));
}

HWY_INLINE HWY_ATTR FloatVector all(const Vec3f& v) {
  return {floats(v.x), floats(v.y), floats(v.z)};
}
HWY_INLINE HWY_ATTR VF dot(const FloatVector& a, const FloatVector& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE HWY_ATTR FloatVector scaled(const FloatVector& v, VF factor) {
  return {hn::Mul(v.x, factor), hn::Mul(v.y, factor), hn::Mul(v.z, factor)};
}
HWY_INLINE HWY_ATTR FloatVector choose(MF mask, const FloatVector& yes, const FloatVector& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}
HWY_INLINE HWY_ATTR FloatVector load(const LitLanes::Vectors& from, int at) {
  return {hn::Load(kFloats, from.x + at), hn::Load(kFloats, from.y + at),
          hn::Load(kFloats, from.z + at)};
}
HWY_INLINE HWY_ATTR void store(const FloatVector& v, int at, LitLanes::Vectors& to) {
  hn::Store(v.x, kFloats, to.x + at);
  hn::Store(v.y, kFloats, to.y + at);
  hn::Store(v.z, kFloats, to.z + at);
}

/// World gradients, density per mm, LPS; 0 in lanes that are not wanted.
HWY_INLINE HWY_ATTR FloatVector world_gradient(const std::array<Vec3f, 3>& columns,
                                               const SampleBatch& batch, MF wanted, int at) {
  const FloatVector g = {hn::IfThenElseZero(wanted, hn::Load(kFloats, batch.gx + at)),
                         hn::IfThenElseZero(wanted, hn::Load(kFloats, batch.gy + at)),
                         hn::IfThenElseZero(wanted, hn::Load(kFloats, batch.gz + at))};
  const FloatVector row[3] = {all({columns[0].x, columns[1].x, columns[2].x}),
                              all({columns[0].y, columns[1].y, columns[2].y}),
                              all({columns[0].z, columns[1].z, columns[2].z})};
  return {dot(row[0], g), dot(row[1], g), dot(row[2], g)};
}

/// Raises x of 0 … 1 to a power.
HWY_INLINE HWY_ATTR VF to_power(VF x, float power) {
  constexpr float kMostMultiplied = 64;
  if (power >= 1 && power <= kMostMultiplied && power == std::floor(power)) {
    VF result = floats(1);
    for (int rest = int(power); rest != 0; rest >>= 1) {
      if (rest & 1) result = hn::Mul(result, x);
      x = hn::Mul(x, x);
    }
    return result;
  }
  constexpr float kSmallest = 1e-30f;  // has a logarithm, and no power of use
  const VF log = hn::Log(kFloats, hn::Max(x, floats(kSmallest)));
  return hn::Exp(kFloats, hn::Mul(log, floats(power)));
}

struct FacingLanes {
  FloatVector normal;
  VF trust;
};

/// Lanes near a face turn to it.
HWY_INLINE HWY_ATTR FacingLanes turn_to_faces(const FacingLanes& inside, MF has_gradient,
                                              const LitLanes& lit, MF near, int at) {
  const FloatVector face = load(lit.face, at);
  const VF share = hn::Load(kFloats, lit.face_share + at);
  const FloatVector from = choose(has_gradient, inside.normal, face);
  const FloatVector between = {mix(from.x, face.x, share), mix(from.y, face.y, share),
                               mix(from.z, face.z, share)};
  const VF length = hn::Sqrt(dot(between, between));
  const VF scale = hn::IfThenElse(hn::Gt(length, floats(0)), hn::Div(floats(1), length), floats(0));
  return {choose(near, scaled(between, scale), inside.normal),
          hn::IfThenElse(near, mix(inside.trust, floats(1), share), inside.trust)};
}

HWY_ATTR void light_lanes_impl(const Shading& shading, const Shading::View& view,
                               const std::array<Vec3f, 3>& columns, const SampleBatch& batch,
                               std::uint32_t wanted, LitLanes& lit) {
  const int lanes = int(hn::Lanes(kFloats));
  for (int at = 0; wanted >> at != 0; at += lanes) {
    const FloatVector gradient = world_gradient(columns, batch, float_mask_of(wanted >> at), at);
    const VF magnitude = hn::Sqrt(dot(gradient, gradient));
    hn::Store(magnitude, kFloats, lit.magnitude + at);

    // The normal on the viewer's side; towards the viewer where there is none.
    const FloatVector eye = all(view.towards_eye);
    const MF has_gradient = hn::Gt(magnitude, floats(0));
    const VF inverse = hn::Div(floats(1), magnitude);
    const VF away =
        hn::IfThenElse(hn::Lt(dot(gradient, eye), floats(0)), hn::Neg(inverse), inverse);
    FacingLanes facing;
    facing.normal = choose(has_gradient, scaled(gradient, away), eye);
    facing.trust = hn::Min(hn::Mul(magnitude, floats(shading.trust_per_gradient())), floats(1));
    if (lit.faces != 0) {
      facing = turn_to_faces(facing, has_gradient, lit, float_mask_of(lit.faces >> at), at);
    }
    store(facing.normal, at, lit.normal);
    hn::Store(facing.trust, kFloats, lit.trust + at);

    for (int n = 0; n < shading.light_count(); ++n) {
      const FloatVector towards = all(shading.towards_light(n));
      const VF cosine = dot(facing.normal, towards);
      VF highlight = dot(facing.normal, all(view.half[n]));
      if (shading.model() == ShadingModel::phong) {
        const VF twice = hn::Add(cosine, cosine);
        const FloatVector reflected = {hn::MulSub(facing.normal.x, twice, towards.x),
                                       hn::MulSub(facing.normal.y, twice, towards.y),
                                       hn::MulSub(facing.normal.z, twice, towards.z)};
        highlight = hn::IfThenElseZero(hn::Gt(cosine, floats(0)), dot(reflected, eye));
      }
      const VF lobe = hn::Mul(facing.trust, positive(highlight));
      const VF faced = hn::Mul(facing.trust, positive(cosine));
      hn::Store(hn::Add(hn::Sub(floats(1), facing.trust), faced), kFloats, lit.diffuse[n] + at);
      hn::Store(to_power(lobe, shading.specular_power()), kFloats, lit.specular[n] + at);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace supple {

HWY_EXPORT(light_lanes_impl);

void light_lanes(const Shading& shading, const Shading::View& view,
                 const std::array<Vec3f, 3>& columns, const SampleBatch& batch,
                 std::uint32_t wanted, LitLanes& lit) {
  HWY_DYNAMIC_DISPATCH(light_lanes_impl)(shading, view, columns, batch, wanted, lit);
}

}  // namespace supple
#endif

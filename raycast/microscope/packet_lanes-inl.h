// Packets in vector registers, and vectors of space; included after foreach_target.h, once for each
// instruction set.
#if defined(SUPPLE_PACKET_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUPPLE_PACKET_LANES_INL_H
#undef SUPPLE_PACKET_LANES_INL_H
#else
#define SUPPLE_PACKET_LANES_INL_H
#endif

#include "raycast/microscope/packet.h"
#include "raycast/sample/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

HWY_INLINE HWY_ATTR VF load(const LaneFloats& from, int at) {
  return hn::Load(kFloats, from.of + at);
}
HWY_INLINE HWY_ATTR void store(VF value, int at, LaneFloats& to) {
  hn::Store(value, kFloats, to.of + at);
}
HWY_INLINE HWY_ATTR FloatVector load(const LaneVectors& from, int at) {
  return {load(from.x, at), load(from.y, at), load(from.z, at)};
}
HWY_INLINE HWY_ATTR void store(const FloatVector& v, int at, LaneVectors& to) {
  store(v.x, at, to.x);
  store(v.y, at, to.y);
  store(v.z, at, to.z);
}
HWY_INLINE HWY_ATTR FloatVector all(const Vec3f& v) {
  return {floats(v.x), floats(v.y), floats(v.z)};
}
HWY_INLINE HWY_ATTR VF dot(const FloatVector& a, const FloatVector& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE HWY_ATTR FloatVector cross(const FloatVector& a, const FloatVector& b) {
  return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
          hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}
HWY_INLINE HWY_ATTR FloatVector scaled(const FloatVector& v, VF factor) {
  return {hn::Mul(v.x, factor), hn::Mul(v.y, factor), hn::Mul(v.z, factor)};
}
HWY_INLINE HWY_ATTR FloatVector difference(const FloatVector& a, const FloatVector& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
/// a + b * factor.
HWY_INLINE HWY_ATTR FloatVector along(const FloatVector& a, const FloatVector& b, VF factor) {
  return {hn::MulAdd(b.x, factor, a.x), hn::MulAdd(b.y, factor, a.y), hn::MulAdd(b.z, factor, a.z)};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();
#endif

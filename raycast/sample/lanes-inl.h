// Vectors of up to sixteen lanes, as the files that Highway compiles once for every instruction set
// share them; included after foreach_target.h, once for each.
#if defined(SUPPLE_RAYCAST_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUPPLE_RAYCAST_LANES_INL_H
#undef SUPPLE_RAYCAST_LANES_INL_H
#else
#define SUPPLE_RAYCAST_LANES_INL_H
#endif

#include <cstdint>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

constexpr int kMostLanes = 16;

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kMostLanes>;
using Ints = hn::RebindToSigned<Floats>;
using VF = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;
using MI = hn::Mask<Ints>;
using MF = hn::Mask<Floats>;

constexpr Floats kFloats;
constexpr Ints kInts;

struct IntVector {
  VI x, y, z;
};
struct FloatVector {
  VF x, y, z;
};

HWY_INLINE HWY_ATTR VI ints(std::int32_t value) {
  return hn::Set(kInts, value);
}
HWY_INLINE HWY_ATTR VF floats(float value) {
  return hn::Set(kFloats, value);
}
HWY_INLINE HWY_ATTR VF mix(VF a, VF b, VF t) {
  return hn::MulAdd(t, hn::Sub(b, a), a);
}
HWY_INLINE HWY_ATTR std::uint32_t bits_of(MI mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kInts, mask, bytes);
  return bytes[0] | std::uint32_t(bytes[1]) << 8;
}
HWY_INLINE HWY_ATTR MI mask_of(std::uint32_t bits) {
  const VI lane_bit = hn::Shl(ints(1), hn::Iota(kInts, 0));
  return hn::TestBit(ints(std::int32_t(bits)), lane_bit);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();
#endif

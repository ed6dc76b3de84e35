// Sixteen floats that are worked on together, in whatever vectors the machine has: the inner loops
// of the inversion. Comparisons give lanes of all ones or zeros. Include it in one .cpp at a time:
// such vectors must not cross the border of a translation unit.
#pragma once

#include <cstdint>
#include <cstring>

#ifdef __SSE2__
#include <immintrin.h>
#endif

#include "volumes/base/simd.h"

namespace supple {

constexpr int kLanes = 16;
using Lanes = Pack<float, 16>;
using LaneInts = Pack<std::int32_t, 16>;

inline Lanes load_lanes(const float* from) {
  return load_pack<Lanes>(from);
}
inline Lanes broadcast(float value) {
  return Lanes{} + value;
}
inline Lanes select(const LaneInts& condition, const Lanes& yes, const Lanes& no) {
  return condition ? yes : no;
}
inline Lanes smaller(const Lanes& a, const Lanes& b) {
  return a < b ? a : b;
}
inline Lanes larger(const Lanes& a, const Lanes& b) {
  return a > b ? a : b;
}
inline Lanes magnitude(const Lanes& v) {
  return Lanes(LaneInts(v) & 0x7fffffff);
}
inline Lanes clamp(const Lanes& v, float half) {
  return smaller(larger(v, broadcast(-half)), broadcast(half));
}

/// Largest whole numbers that are not above v, for |v| < 2^31.
inline Lanes floor_lanes(const Lanes& v) {
  const Lanes cut = __builtin_convertvector(__builtin_convertvector(v, LaneInts), Lanes);
  return cut - select(cut > v, broadcast(1), Lanes{});
}
inline Lanes ceil_lanes(const Lanes& v) {
  return -floor_lanes(-v);
}

/// Lanes whose bit is set.
inline LaneInts lanes_of_bits(unsigned bits) {
  constexpr LaneInts kBit = {1,      1 << 1, 1 << 2,  1 << 3,  1 << 4,  1 << 5,  1 << 6,  1 << 7,
                             1 << 8, 1 << 9, 1 << 10, 1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15};
  return ((LaneInts{} + int(bits)) & kBit) != 0;
}
/// Lanes as bits: bit n is the sign of lane n.
inline unsigned bits_of_lanes(const LaneInts& condition) {
#if defined(__AVX512DQ__)
  return unsigned(_mm512_movepi32_mask(__m512i(condition)));
#elif defined(__SSE2__)
  unsigned bits = 0;
  for (int n = 0; n < 4; ++n) {
    __m128 part;
    std::memcpy(&part, reinterpret_cast<const char*>(&condition) + 16 * n, sizeof part);
    bits |= unsigned(_mm_movemask_ps(part)) << (4 * n);
  }
  return bits;
#else
  unsigned bits = 0;
  for (int n = 0; n < kLanes; ++n) bits |= unsigned(condition[n] < 0) << n;
  return bits;
#endif
}

/// Sixteen vectors of space.
struct LaneVec {
  Lanes x, y, z;

  Lanes& operator[](int a) { return a == 0 ? x : a == 1 ? y : z; }
  const Lanes& operator[](int a) const { return a == 0 ? x : a == 1 ? y : z; }
};
inline LaneVec operator+(const LaneVec& a, const LaneVec& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline LaneVec operator-(const LaneVec& a, const LaneVec& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline LaneVec operator*(const LaneVec& a, const Lanes& s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline Lanes dot(const LaneVec& a, const LaneVec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline LaneVec cross(const LaneVec& a, const LaneVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline LaneVec magnitude(const LaneVec& v) {
  return {magnitude(v.x), magnitude(v.y), magnitude(v.z)};
}
inline Lanes max_component(const LaneVec& v) {
  return larger(larger(v.x, v.y), v.z);
}

}  // namespace supple

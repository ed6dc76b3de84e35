#include "raycast/microscope/tone_lanes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raycast/microscope/tone_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// This include is not above: foreach_target.h comes first.
#include <hwy/contrib/math/math-inl.h>

#include "raycast/sample/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

struct HazeLanes {
  VF red, green, blue, opacity;
};

/// Four neighbours of each pixel in a small picture and their weights: the left and right ones of
/// two rows.
struct HazeTaps {
  int first = 0;                // least column
  bool is_narrow = true;        // no column is a vector's length or more from it
  VI aside[2];                  // columns from `first` on
  std::size_t row[2] = {0, 0};  // begins of rows
  VF weight[4];
};

constexpr float kEndlessMm = 1e6f;    // stands for no end where depths are compared
constexpr float kSameDepthMm = 0.8f;  // neighbours that are further off are of another surface

HWY_INLINE HWY_ATTR VF finite_depth(VF depth) {
  return hn::Min(depth, floats(kEndlessMm));
}

HWY_INLINE HWY_ATTR HazeTaps taps_at(const HazeGrid& grid, const PicturePlanes& planes, int left,
                                     int y) {
  const int lanes = int(hn::Lanes(kFloats));
  const float scale = float(grid.height) / float(planes.height);
  const VF centre =
      hn::Add(hn::Iota(kFloats, float(left)), floats(0.5f - 0.5f * float(planes.width)));
  const VF u = hn::MulAdd(centre, floats(scale), floats(0.5f * float(grid.width) - 0.5f));
  const float v = (float(y) + 0.5f) * scale - 0.5f;
  const float row = std::floor(v), t = v - row;
  const VF column = hn::Floor(u), s = hn::Sub(u, column);
  const VI x = hn::ConvertTo(kInts, column);
  HazeTaps taps;
  taps.first = std::clamp(hn::GetLane(x), 0, grid.width - 1);
  taps.is_narrow = scale * float(lanes) + 2 < float(lanes);
  for (int n = 0; n < 2; ++n) {
    const VI within = hn::Min(hn::Max(hn::Add(x, ints(n)), ints(0)), ints(grid.width - 1));
    taps.aside[n] = hn::Sub(within, ints(taps.first));
    taps.row[n] = std::size_t(std::clamp(int(row) + n, 0, grid.height - 1)) * grid.width;
  }
  for (int n = 0; n < 4; ++n) {
    taps.weight[n] =
        hn::Mul((n & 1) != 0 ? s : hn::Sub(floats(1), s), floats((n >> 1) != 0 ? t : 1 - t));
  }
  return taps;
}

/// The value of a plane at tap n.
HWY_INLINE HWY_ATTR VF tap(const HazeTaps& taps, const std::vector<float>& plane, int n) {
  const float* from = plane.data() + taps.row[n >> 1] + taps.first;
  const VI aside = taps.aside[n & 1];
  if (!taps.is_narrow) return hn::GatherIndex(kFloats, from, aside);
  return hn::TableLookupLanes(hn::LoadU(kFloats, from), hn::IndicesFromVec(kFloats, aside));
}

HWY_INLINE HWY_ATTR HazeLanes haze_of(const HazeGrid& grid, const HazeTaps& taps, int n) {
  return {tap(taps, grid.red, n), tap(taps, grid.green, n), tap(taps, grid.blue, n),
          tap(taps, grid.opacity, n)};
}

HWY_INLINE HWY_ATTR HazeLanes choose_haze(MF mask, const HazeLanes& yes, const HazeLanes& no) {
  return {hn::IfThenElse(mask, yes.red, no.red), hn::IfThenElse(mask, yes.green, no.green),
          hn::IfThenElse(mask, yes.blue, no.blue), hn::IfThenElse(mask, yes.opacity, no.opacity)};
}
HWY_INLINE HWY_ATTR HazeLanes scaled(const HazeLanes& haze, VF factor) {
  return {hn::Mul(haze.red, factor), hn::Mul(haze.green, factor), hn::Mul(haze.blue, factor),
          hn::Mul(haze.opacity, factor)};
}
HWY_INLINE HWY_ATTR HazeLanes added(const HazeLanes& a, const HazeLanes& b, VF factor) {
  return {hn::MulAdd(b.red, factor, a.red), hn::MulAdd(b.green, factor, a.green),
          hn::MulAdd(b.blue, factor, a.blue), hn::MulAdd(b.opacity, factor, a.opacity)};
}

/// Haze of the neighbour that is next in depth, as if it were the same all along the way: for what
/// no ray of the small picture has met.
HWY_INLINE HWY_ATTR HazeLanes haze_by_depth(const HazeGrid& grid, const HazeTaps& taps, VF depth,
                                            float start_mm) {
  HazeLanes haze = haze_of(grid, taps, 0);
  VF nearest = finite_depth(tap(taps, grid.depth_mm, 0));
  for (int n = 1; n < 4; ++n) {
    const VF other = finite_depth(tap(taps, grid.depth_mm, n));
    const MF is_nearer = hn::Lt(hn::Abs(hn::Sub(other, depth)), hn::Abs(hn::Sub(nearest, depth)));
    nearest = hn::IfThenElse(is_nearer, other, nearest);
    haze = choose_haze(is_nearer, haze_of(grid, taps, n), haze);
  }
  const VF way = hn::Max(hn::Sub(depth, floats(start_mm)), floats(0));
  const VF known = hn::Max(hn::Sub(nearest, floats(start_mm)), floats(1e-3f));
  const VF ratio = hn::Min(hn::Div(way, known), floats(4));
  const VF clear = hn::Max(hn::Sub(floats(1), haze.opacity), floats(1e-6f));
  const VF opacity = hn::Sub(floats(1), hn::Exp(kFloats, hn::Mul(hn::Log(kFloats, clear), ratio)));
  const VF thin = hn::Max(haze.opacity, floats(1e-6f));
  return scaled(haze, hn::Div(opacity, thin));
}

/// Haze up to depths of pixels: of neighbours at like depths.
HWY_INLINE HWY_ATTR HazeLanes haze_at(const HazeGrid& grid, const PicturePlanes& planes, int left,
                                      int y, VF depth_or_none, float start_mm) {
  const VF depth = finite_depth(depth_or_none);
  const HazeTaps taps = taps_at(grid, planes, left, y);
  const VF none = floats(0);
  HazeLanes sum = {none, none, none, none};
  VF weights = none;
  for (int n = 0; n < 4; ++n) {
    const VF end = finite_depth(tap(taps, grid.depth_mm, n));
    const VF off = hn::Mul(hn::Sub(end, depth), floats(1 / kSameDepthMm));
    const VF alike = hn::Max(hn::NegMulAdd(off, off, floats(1)), none);
    const VF weight = hn::Mul(taps.weight[n], alike);
    sum = added(sum, haze_of(grid, taps, n), weight);
    weights = hn::Add(weights, weight);
  }
  const MF is_known = hn::Gt(weights, floats(1e-3f));
  const HazeLanes mean = scaled(sum, hn::Div(floats(1), hn::Max(weights, floats(1e-3f))));
  if (hn::AllTrue(kFloats, is_known)) return mean;
  return choose_haze(is_known, mean, haze_by_depth(grid, taps, depth, start_mm));
}

/// What lies in front over what lies behind.
HWY_INLINE HWY_ATTR HazeLanes over(const HazeLanes& front, const HazeLanes& behind) {
  return added(front, behind, hn::Sub(floats(1), front.opacity));
}

/// The haze behind a part of it.
HWY_INLINE HWY_ATTR HazeLanes rest_behind(const HazeLanes& whole, const HazeLanes& front) {
  const VF clear = hn::Sub(floats(1), front.opacity);
  const VF inverse =
      hn::IfThenElse(hn::Gt(clear, floats(1e-4f)), hn::Div(floats(1), clear), floats(0));
  const HazeLanes rest = scaled(added(whole, front, floats(-1)), inverse);
  const VF none = floats(0);
  return {hn::Max(rest.red, none), hn::Max(rest.green, none), hn::Max(rest.blue, none),
          hn::Min(hn::Max(rest.opacity, none), floats(1))};
}

HWY_INLINE HWY_ATTR VF load(const std::vector<float>& plane, std::size_t at) {
  return hn::LoadU(kFloats, plane.data() + at);
}

/// Surfaces, balls and haze of pixels in their order.
HWY_INLINE HWY_ATTR HazeLanes light_of(const PicturePlanes& planes, const HazeGrids& haze, int left,
                                       int y, std::size_t at) {
  const HazeLanes surface = {load(planes.red, at), load(planes.green, at), load(planes.blue, at),
                             floats(1)};
  if (haze.to_surface.width == 0) return surface;
  const HazeLanes whole =
      haze_at(haze.to_surface, planes, left, y, load(planes.depth_mm, at), haze.start_mm);
  if (!planes.has_front) return over(whole, surface);
  const HazeLanes ball = {load(planes.front_red, at), load(planes.front_green, at),
                          load(planes.front_blue, at), load(planes.front_opacity, at)};
  const MF has_ball = hn::Gt(ball.opacity, floats(0));
  const HazeLanes plain = over(whole, surface);
  if (hn::AllFalse(kFloats, has_ball)) return plain;
  const VF depth = hn::Min(load(planes.front_mm, at), load(planes.depth_mm, at));
  const HazeLanes front = haze_at(haze.to_ball, planes, left, y, depth, haze.start_mm);
  const HazeLanes mixed = over(front, over(ball, over(rest_behind(whole, front), surface)));
  return choose_haze(has_ball, mixed, plain);
}

/// Light, linear, to sRGB of 0 … 255.
HWY_INLINE HWY_ATTR VI byte_of(VF light, VF seen) {
  const VF exposed = hn::Sub(floats(1), hn::Exp(kFloats, hn::Neg(hn::Max(light, floats(0)))));
  const VF value = hn::Mul(exposed, seen);
  const VF log = hn::Log(kFloats, hn::Max(value, floats(1e-6f)));
  const VF curve =
      hn::MulSub(floats(1.055f), hn::Exp(kFloats, hn::Mul(log, floats(1 / 2.4f))), floats(0.055f));
  const VF straight = hn::Mul(value, floats(12.92f));
  const VF encoded = hn::IfThenElse(hn::Gt(value, floats(0.0031308f)), curve, straight);
  return hn::NearestInt(hn::Mul(hn::Min(encoded, floats(1)), floats(255)));
}

/// Part of pixels within the circle of the eyepiece.
HWY_INLINE HWY_ATTR VF eyepiece_at(const PicturePlanes& planes, int left, int y) {
  const float radius = 0.5f * float(std::min(planes.width, planes.height));
  const VF x = hn::Add(hn::Iota(kFloats, float(left)), floats(0.5f - 0.5f * float(planes.width)));
  const float down = float(y) + 0.5f - 0.5f * float(planes.height);
  const VF away = hn::Sqrt(hn::MulAdd(x, x, floats(down * down)));
  return hn::Min(hn::Max(hn::Sub(floats(radius), away), floats(0)), floats(1));
}

HWY_ATTR void tone_row_impl(const PicturePlanes& planes, const HazeGrids& haze, bool eyepiece,
                            int y, std::uint8_t* rgba) {
  const int lanes = int(hn::Lanes(kFloats));
  alignas(64) std::int32_t packed[kMostLanes];
  for (int wanted = 0; wanted < planes.width; wanted += lanes) {
    // The last vector of a row goes back to end with the row.
    const int left = std::max(std::min(wanted, planes.stride - lanes), 0);
    const std::size_t at = std::size_t(y) * planes.stride + left;
    const HazeLanes light = light_of(planes, haze, left, y, at);
    const VF seen = eyepiece ? eyepiece_at(planes, left, y) : floats(1);
    const VI red = byte_of(light.red, seen), green = byte_of(light.green, seen),
             blue = byte_of(light.blue, seen);
    const VI low = hn::Or(red, hn::ShiftLeft<8>(green));
    const VI high = hn::Or(hn::ShiftLeft<16>(blue), hn::ShiftLeft<24>(ints(255)));
    hn::Store(hn::Or(low, high), kInts, packed);
    const int count = std::min(lanes, planes.width - left);
    std::memcpy(rgba + 4 * std::size_t(left), packed, 4 * std::size_t(count));
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace supple {

HWY_EXPORT(tone_row_impl);

void HazeGrid::assign(const RayDepths& depths, const FloatImage& picture) {
  width = depths.width, height = depths.height;
  const std::size_t count = depths.mm.size();
  depth_mm = depths.mm;
  for (auto* plane : {&depth_mm, &red, &green, &blue, &opacity}) {
    plane->resize(count + kPacketRays);
  }
  for (std::size_t n = 0; n < count; ++n) {
    red[n] = picture.rgba[4 * n], green[n] = picture.rgba[4 * n + 1];
    blue[n] = picture.rgba[4 * n + 2], opacity[n] = picture.rgba[4 * n + 3];
  }
}

void tone_row(const PicturePlanes& planes, const HazeGrids& haze, bool eyepiece, int y,
              std::uint8_t* rgba) {
  HWY_DYNAMIC_DISPATCH(tone_row_impl)(planes, haze, eyepiece, y, rgba);
}

}  // namespace supple
#endif

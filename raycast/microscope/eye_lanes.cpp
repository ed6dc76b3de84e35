#include "raycast/microscope/eye_lanes.h"

#include <cmath>

#include "volumes/base/units.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raycast/microscope/eye_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// This include is not above: foreach_target.h comes first.
#include <hwy/contrib/math/math-inl.h>

#include "raycast/microscope/packet_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

HWY_INLINE HWY_ATTR VF inverse_length(const FloatVector& v) {
  constexpr float kShort = 1e-30f;
  return hn::Div(floats(1), hn::Sqrt(hn::Max(dot(v, v), floats(kShort))));
}
HWY_INLINE HWY_ATTR VF positive(VF value) {
  return hn::Max(value, floats(0));
}
/// The smooth step of x from 0 to 1.
HWY_INLINE HWY_ATTR VF smooth(VF x) {
  const VF t = hn::Min(positive(x), floats(1));
  return hn::Mul(hn::Mul(t, t), hn::NegMulAdd(floats(2), t, floats(3)));
}
/// Positive numbers to a power.
HWY_INLINE HWY_ATTR VF power_of(VF x, VF power) {
  constexpr float kSmallest = 1e-30f;
  return hn::Exp(kFloats, hn::Mul(hn::Log(kFloats, hn::Max(x, floats(kSmallest))), power));
}

HWY_ATTR void aim_rays_impl(const LensFloats& lens, const GlobeFloats& globe, const LaneFloats& x,
                            const LaneFloats& y, PacketRays& rays) {
  const int lanes = int(hn::Lanes(kFloats));
  rays.active = 0;
  for (int at = 0; at < kPacketRays; at += lanes) {
    const VF across = hn::Sub(load(x, at), floats(lens.middle_x));
    const VF up = hn::Sub(floats(lens.middle_y), load(y, at));
    const FloatVector towards =
        along(along(all(lens.forward), all(lens.right), across), all(lens.up), up);
    const FloatVector direction = scaled(towards, inverse_length(towards));
    store(direction, at, rays.direction);
    store(all(lens.origin), at, rays.origin);
    if (globe.radius <= 0) {
      store(floats(0), at, rays.near);
      store(floats(INFINITY), at, rays.far);
      rays.active = kWholePacket;
      continue;
    }
    // The nearest point to the centre first: differences of large squares would cost digits.
    const FloatVector from_centre = all(lens.origin - globe.centre);
    const VF to_nearest = hn::Neg(dot(from_centre, direction));
    const FloatVector nearest = along(from_centre, direction, to_nearest);
    const VF rest = hn::Sub(floats(globe.radius * globe.radius), dot(nearest, nearest));
    const VF half = hn::Sqrt(positive(rest));
    const VF far = hn::Add(to_nearest, half);
    store(positive(hn::Sub(to_nearest, half)), at, rays.near);
    store(far, at, rays.far);
    const MF met = hn::And(hn::Gt(rest, floats(0)), hn::Gt(far, floats(0)));
    rays.active |= bits_of(hn::RebindMask(kInts, met)) << at;
  }
}

struct ColourLanes {
  VF red, green, blue;
};

/// Square roots of colours of texels.
HWY_INLINE HWY_ATTR ColourLanes texels_at(const GlobeFloats& globe, VI x, VI y) {
  const VI column = hn::Min(hn::Max(x, ints(0)), ints(globe.width - 1));
  const VI row = hn::Min(hn::Max(y, ints(0)), ints(globe.height - 1));
  const VI index = hn::Add(hn::Mul(row, ints(globe.width)), column);
  const VI packed =
      hn::GatherIndex(kInts, reinterpret_cast<const std::int32_t*>(globe.texels.data()), index);
  const VI mask = ints(1023);
  return {hn::ConvertTo(kFloats, hn::And(packed, mask)),
          hn::ConvertTo(kFloats, hn::And(hn::ShiftRight<10>(packed), mask)),
          hn::ConvertTo(kFloats, hn::And(hn::ShiftRight<20>(packed), mask))};
}
HWY_INLINE HWY_ATTR ColourLanes mix_colours(const ColourLanes& a, const ColourLanes& b, VF t) {
  return {mix(a.red, b.red, t), mix(a.green, b.green, t), mix(a.blue, b.blue, t)};
}

/// Linear colours in unit directions from the globe's centre, between texels.
HWY_INLINE HWY_ATTR ColourLanes texture_at(const GlobeFloats& globe, const FloatVector& direction) {
  // Half the chord to the pole has the angle precisely where the retina is.
  const FloatVector from_pole = {direction.x, direction.y, hn::Add(direction.z, floats(1))};
  const VF half_chord = hn::Mul(hn::Sqrt(dot(from_pole, from_pole)), floats(0.5f));
  const VF angle = hn::Mul(hn::Asin(kFloats, hn::Min(half_chord, floats(1))), floats(2));
  const VF across =
      hn::Sqrt(hn::MulAdd(direction.x, direction.x, hn::Mul(direction.y, direction.y)));
  const VF scale =
      hn::Div(hn::Mul(angle, floats(float(0.5 / kPi))), hn::Max(across, floats(1e-12f)));
  const VF u = hn::MulAdd(hn::MulAdd(direction.x, scale, floats(0.5f)), floats(float(globe.width)),
                          floats(-0.5f));
  const VF v = hn::MulAdd(hn::NegMulAdd(direction.y, scale, floats(0.5f)),
                          floats(float(globe.height)), floats(-0.5f));
  const VF column = hn::Floor(u), row = hn::Floor(v);
  const VI x = hn::ConvertTo(kInts, column), y = hn::ConvertTo(kInts, row);
  const VI right = hn::Add(x, ints(1)), below = hn::Add(y, ints(1));
  const VF s = hn::Sub(u, column), t = hn::Sub(v, row);
  const ColourLanes upper = mix_colours(texels_at(globe, x, y), texels_at(globe, right, y), s);
  const ColourLanes lower =
      mix_colours(texels_at(globe, x, below), texels_at(globe, right, below), s);
  const ColourLanes root = mix_colours(upper, lower, t);
  const VF unit = floats(1.0f / (1023 * 1023));
  return {hn::Mul(hn::Mul(root.red, root.red), unit),
          hn::Mul(hn::Mul(root.green, root.green), unit),
          hn::Mul(hn::Mul(root.blue, root.blue), unit)};
}

/// Blood over the colours: dense in the middle, thinner in the outer third of a spot.
HWY_INLINE HWY_ATTR void paint_spots(const GlobeFloats& globe, const FloatVector& direction,
                                     ColourLanes& colour) {
  constexpr float kSoft = 0.35f, kDensest = 0.94f;
  for (const GlobeFloats::Spot& spot : globe.spots) {
    const FloatVector apart = difference(direction, all(spot.direction));
    const VF square = dot(apart, apart);
    const float reach = spot.radius_mm / globe.radius;
    if (hn::AllTrue(kFloats, hn::Ge(square, floats(reach * reach)))) continue;
    const VF inwards =
        hn::NegMulAdd(hn::Sqrt(square), floats(1 / (reach * kSoft)), floats(1 / kSoft));
    const VF cover = hn::Mul(smooth(inwards), floats(kDensest));
    colour = mix_colours(colour, {floats(0.17f), floats(0.006f), floats(0.007f)}, cover);
  }
}

HWY_ATTR void globe_places_impl(const GlobeFloats& globe, const PacketRays& rays,
                                PacketPlaces& places) {
  const int lanes = int(hn::Lanes(kFloats));
  for (int at = 0; at < kPacketRays; at += lanes) {
    const FloatVector direction = load(rays.direction, at);
    // Lanes that miss the globe have their nearest place, of which nothing is used.
    const FloatVector place = along(load(rays.origin, at), direction, load(rays.far, at));
    const FloatVector from_centre = difference(place, all(globe.centre));
    const FloatVector outwards = scaled(from_centre, inverse_length(from_centre));
    ColourLanes colour = {floats(0.5f), floats(0.5f), floats(0.5f)};
    if (globe.width > 0) colour = texture_at(globe, outwards);
    paint_spots(globe, outwards, colour);
    store(place, at, places.at);
    store(direction, at, places.from_eye);
    store(scaled(outwards, floats(-1)), at, places.normal);
    store(colour.red, at, places.red);
    store(colour.green, at, places.green);
    store(colour.blue, at, places.blue);
    store(floats(1), at, places.opacity);
    store(floats(0), at, places.specular);
    store(floats(1), at, places.shininess);
  }
}

/// The lamp's light on places facing it, where its distance and cone are all that count.
HWY_INLINE HWY_ATTR VF irradiance(const LampFloats& lamp, const FloatVector& to_lamp, VF inverse,
                                  VF square) {
  constexpr float kUnitDistanceMm = 8, kSofteningMm2 = 1;  // of a tip that is no point
  const VF cosine = hn::Neg(hn::Mul(dot(to_lamp, all(lamp.direction)), inverse));
  const float width = lamp.cosine_full - lamp.cosine_none;
  const VF within =
      hn::Mul(hn::Sub(cosine, floats(lamp.cosine_none)), floats(1 / std::max(width, 1e-6f)));
  const float scale = lamp.power * (kUnitDistanceMm * kUnitDistanceMm + kSofteningMm2);
  return hn::Mul(smooth(within), hn::Div(floats(scale), hn::Add(square, floats(kSofteningMm2))));
}

HWY_ATTR void lamp_light_impl(const LampFloats& lamp, const PacketPlaces& places,
                              PacketLight& light) {
  const int lanes = int(hn::Lanes(kFloats));
  light.reached = 0;
  for (int at = 0; at < kPacketRays; at += lanes) {
    const FloatVector normal = load(places.normal, at), from_eye = load(places.from_eye, at);
    const FloatVector to_lamp = difference(all(lamp.place), load(places.at, at));
    const VF square = dot(to_lamp, to_lamp);
    const VF inverse = hn::Div(floats(1), hn::Sqrt(hn::Max(square, floats(1e-20f))));
    const FloatVector towards = scaled(to_lamp, inverse);
    const VF opacity = load(places.opacity, at);
    const VF facing_eye = hn::Abs(dot(normal, from_eye));

    // A thin sheet that is seen aslant hides more: its way through is longer.
    const VF way = hn::Div(floats(1), hn::Max(facing_eye, floats(0.12f)));
    const VF clear = hn::Max(hn::Sub(floats(1), opacity), floats(0));
    VF dense = floats(1);
    const MF is_translucent = hn::Gt(clear, floats(1e-4f));
    if (!hn::AllFalse(kFloats, is_translucent)) {
      dense = hn::IfThenElse(is_translucent, hn::Sub(floats(1), power_of(clear, way)), floats(1));
    }
    store(dense, at, light.opacity);

    // Light that falls on the back of a translucent sheet shines through it.
    const VF cosine = dot(normal, towards);
    const VF faced =
        hn::IfThenElse(hn::Gt(cosine, floats(0)), cosine, hn::Neg(hn::Mul(cosine, clear)));
    VF lamp_part = floats(0), mirrored = floats(0);
    if (lamp.is_on) {
      const VF shine = irradiance(lamp, to_lamp, inverse, square);
      lamp_part = hn::Mul(shine, faced);
      const VF specular = load(places.specular, at);
      if (!hn::AllTrue(kFloats, hn::Eq(specular, floats(0)))) {
        const FloatVector half = difference(towards, from_eye);
        const VF lobe = positive(hn::Mul(dot(normal, half), inverse_length(half)));
        const VF exponent = load(places.shininess, at);
        const VF norm = hn::MulAdd(exponent, floats(0.125f), floats(1));
        const VF strength = hn::Mul(hn::Mul(specular, norm), hn::Mul(dense, positive(cosine)));
        mirrored = hn::Mul(hn::Mul(shine, strength), power_of(lobe, exponent));
      }
      light.reached |=
          bits_of(hn::RebindMask(kInts, hn::Gt(hn::Add(lamp_part, mirrored), floats(1e-5f)))) << at;
    }
    const VF ambient = hn::Mul(dense, floats(lamp.ambient));
    const VF diffuse = hn::Mul(dense, lamp_part);
    const auto put = [&](const LaneFloats& albedo, LaneFloats& lit, LaneFloats& around) HWY_ATTR {
      const VF colour = load(albedo, at);
      store(hn::MulAdd(colour, diffuse, mirrored), at, lit);
      store(hn::Mul(colour, ambient), at, around);
    };
    put(places.red, light.lit.red, light.ambient.red);
    put(places.green, light.lit.green, light.ambient.green);
    put(places.blue, light.lit.blue, light.ambient.blue);
  }
}

HWY_ATTR void shadow_rays_impl(const PacketPlaces& places, const LaneVectors& lamp_points,
                               std::uint32_t wanted, PacketRays& rays) {
  const int lanes = int(hn::Lanes(kFloats));
  rays.active = wanted;
  for (int at = 0; at < kPacketRays; at += lanes) {
    const FloatVector place = load(places.at, at), normal = load(places.normal, at);
    const FloatVector lamp = load(lamp_points, at);
    const VF lift = load(places.lift_mm, at);
    const MF is_front = hn::Gt(dot(normal, difference(lamp, place)), floats(0));
    const FloatVector start = along(place, normal, hn::IfThenElse(is_front, lift, hn::Neg(lift)));
    store(start, at, rays.origin);
    store(difference(lamp, start), at, rays.direction);
    store(floats(0), at, rays.near);
    store(floats(1), at, rays.far);
  }
}

HWY_ATTR void project_packet_impl(const LensFloats& lens, const LaneVectors& places,
                                  PacketPixels& pixels) {
  const int lanes = int(hn::Lanes(kFloats));
  const FloatVector right = all(lens.right * (1 / lens.right.length2()));
  const FloatVector down = all(lens.up * (-1 / lens.up.length2()));
  for (int at = 0; at < kPacketRays; at += lanes) {
    const FloatVector from_eye = difference(load(places, at), all(lens.origin));
    const VF inverse = hn::Div(floats(1), dot(from_eye, all(lens.forward)));
    store(hn::MulAdd(dot(from_eye, right), inverse, floats(lens.middle_x)), at, pixels.x);
    store(hn::MulAdd(dot(from_eye, down), inverse, floats(lens.middle_y)), at, pixels.y);
  }
}

HWY_ATTR void cluster_around_impl(const PacketPixels& pixels, int lane, float half_width,
                                  std::uint32_t wanted, PixelCluster& cluster) {
  const int lanes = int(hn::Lanes(kFloats));
  const VF middle_x = floats(pixels.x[lane]), middle_y = floats(pixels.y[lane]);
  VF left = middle_x, right = middle_x, top = middle_y, bottom = middle_y;
  cluster.lanes = 0;
  for (int at = 0; at < kPacketRays; at += lanes) {
    const VF x = load(pixels.x, at), y = load(pixels.y, at);
    const VF away = hn::Max(hn::Abs(hn::Sub(x, middle_x)), hn::Abs(hn::Sub(y, middle_y)));
    const MF is_near =
        hn::And(hn::RebindMask(kFloats, mask_of(wanted >> at)), hn::Le(away, floats(half_width)));
    cluster.lanes |= bits_of(hn::RebindMask(kInts, is_near)) << at;
    left = hn::Min(left, hn::IfThenElse(is_near, x, left));
    right = hn::Max(right, hn::IfThenElse(is_near, x, right));
    top = hn::Min(top, hn::IfThenElse(is_near, y, top));
    bottom = hn::Max(bottom, hn::IfThenElse(is_near, y, bottom));
  }
  cluster.left = hn::GetLane(hn::MinOfLanes(kFloats, left));
  cluster.top = hn::GetLane(hn::MinOfLanes(kFloats, top));
  cluster.right = hn::GetLane(hn::MaxOfLanes(kFloats, right));
  cluster.bottom = hn::GetLane(hn::MaxOfLanes(kFloats, bottom));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace supple {

HWY_EXPORT(aim_rays_impl);
HWY_EXPORT(globe_places_impl);
HWY_EXPORT(lamp_light_impl);
HWY_EXPORT(shadow_rays_impl);
HWY_EXPORT(project_packet_impl);
HWY_EXPORT(cluster_around_impl);

LensFloats lens_of(const Camera& camera, int width, int height) {
  const CameraFrame frame = camera_frame(camera);
  const double pixel = 2 * half_height_at_unit_distance(camera) / height;
  LensFloats lens;
  lens.origin = Vec3f(camera.position_lps_mm);
  lens.forward = Vec3f(frame.forward);
  lens.right = Vec3f(frame.right * pixel);
  lens.up = Vec3f(frame.up * pixel);
  lens.middle_x = float(width / 2.0 - camera.window_shift * height / 2.0);
  lens.middle_y = float(height / 2.0);
  return lens;
}

void aim_rays(const LensFloats& lens, const GlobeFloats& globe, const LaneFloats& x,
              const LaneFloats& y, PacketRays& rays) {
  HWY_DYNAMIC_DISPATCH(aim_rays_impl)(lens, globe, x, y, rays);
}

void globe_places(const GlobeFloats& globe, const PacketRays& rays, PacketPlaces& places) {
  HWY_DYNAMIC_DISPATCH(globe_places_impl)(globe, rays, places);
}

void lamp_light(const LampFloats& lamp, const PacketPlaces& places, PacketLight& light) {
  HWY_DYNAMIC_DISPATCH(lamp_light_impl)(lamp, places, light);
}

void shadow_rays(const PacketPlaces& places, const LaneVectors& lamp_points, std::uint32_t wanted,
                 PacketRays& rays) {
  HWY_DYNAMIC_DISPATCH(shadow_rays_impl)(places, lamp_points, wanted, rays);
}

PacketPixels project_packet(const LensFloats& lens, const LaneVectors& places) {
  PacketPixels pixels;
  HWY_DYNAMIC_DISPATCH(project_packet_impl)(lens, places, pixels);
  return pixels;
}

PixelCluster cluster_around(const PacketPixels& pixels, int lane, float half_width,
                            std::uint32_t wanted) {
  PixelCluster cluster;
  HWY_DYNAMIC_DISPATCH(cluster_around_impl)(pixels, lane, half_width, wanted, cluster);
  return cluster;
}

}  // namespace supple
#endif

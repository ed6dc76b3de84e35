// Distances of round cones from surfaces. A round cone is balls along its axis; its distance is the
// least, over these, of the centre's distance less the radius.
#include <algorithm>
#include <cmath>

#include "lib/contact/mesh_surface.h"
#include "lib/instruments/tool_contact.h"

namespace supple {

namespace {

struct Ball {
  Vec3d centre_mm;
  double radius_mm;
};
Ball ball_at(const RoundCone& cone, double part) {
  return {cone.a_mm + (cone.b_mm - cone.a_mm) * part,
          cone.a_radius_mm + (cone.b_radius_mm - cone.a_radius_mm) * part};
}

Vec3d direction_or_z(const Vec3d& v) {
  const double length = v.length();
  return length > 0 ? v / length : Vec3d(0, 0, 1);
}

// The nearest points of surfaces from centres of balls.

Approach of_point(const SphereShape& s, const Vec3d& p) {
  const Vec3d normal = direction_or_z(p - s.centre_mm);
  return {(p - s.centre_mm).length() - s.radius_mm, s.centre_mm + normal * s.radius_mm, normal};
}

bool holds(const SphereShape& s, const Vec3d& p) {
  return (p - s.centre_mm).length2() <= s.radius_mm * s.radius_mm;
}

/// The circle in which the spheres of a lens meet: there nearest from outside of both caps.
Approach of_rim(const LensShape& lens, const Vec3d& p) {
  const Vec3d between = lens.back.centre_mm - lens.front.centre_mm;
  const double apart = between.length();
  const Vec3d axis = direction_or_z(between);
  const double r = lens.front.radius_mm, s = lens.back.radius_mm;
  const double along = apart > 0 ? (apart * apart + r * r - s * s) / (2 * apart) : 0;
  const Vec3d middle = lens.front.centre_mm + axis * along;
  Vec3d out = (p - middle) - axis * (p - middle).dot(axis);
  if (out.length() == 0) out = axis.cross(std::abs(axis.x) < 0.5 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0));
  const Vec3d place = middle + out.normalized() * std::sqrt(std::max(0.0, r * r - along * along));
  return {(p - place).length(), place, direction_or_z(p - place)};
}

Approach of_point(const LensShape& lens, const Vec3d& p) {
  const Approach front = of_point(lens.front, p), back = of_point(lens.back, p);
  if (front.distance_mm <= 0 && back.distance_mm <= 0) {
    return front.distance_mm > back.distance_mm ? front : back;
  }
  if (front.distance_mm > 0 && holds(lens.back, front.place_mm)) return front;
  if (back.distance_mm > 0 && holds(lens.front, back.place_mm)) return back;
  return of_rim(lens, p);
}

Approach of_point(const MeshShape& mesh, const Vec3d& p) {
  const SurfaceDistance found = mesh.surface->distance_to(p - mesh.offset_mm);
  return {found.distance_mm, p - found.normal * found.distance_mm, found.normal};
}

Approach of_point(const VoxelSolid& solid, const Vec3d& p) {
  return solid.distance_to(p);
}

template <class Surface>
Approach of_ball(const Surface& surface, const Ball& ball) {
  Approach found = of_point(surface, ball.centre_mm);
  found.distance_mm -= ball.radius_mm;
  return found;
}

// The nearest balls of round cones.

Approach of_cone(const SphereShape& s, const RoundCone& cone) {
  return of_ball(s, ball_at(cone, nearest_part(s.centre_mm, cone)));
}

Approach of_cone(const PlaneShape& s, const RoundCone& cone) {
  const double a = s.normal.dot(cone.a_mm - s.point_mm) - cone.a_radius_mm;
  const double b = s.normal.dot(cone.b_mm - s.point_mm) - cone.b_radius_mm;
  const Ball ball = ball_at(cone, a <= b ? 0 : 1);
  const double above = s.normal.dot(ball.centre_mm - s.point_mm);
  return {std::min(a, b), ball.centre_mm - s.normal * above, s.normal};
}

/// A lens is convex, and so is the distance along the axis: where it is least on one cap, that is
/// all; else it is where the slope changes sign.
Approach of_cone(const LensShape& lens, const RoundCone& cone) {
  for (const SphereShape& cap : {lens.front, lens.back}) {
    const Ball ball = ball_at(cone, nearest_part(cap.centre_mm, cone));
    const Approach found = of_ball(lens, ball);
    if ((found.place_mm - of_point(cap, ball.centre_mm).place_mm).length2() < 1e-24) return found;
  }
  const Vec3d axis = cone.b_mm - cone.a_mm;
  const auto slope_of = [&](const Approach& found) {
    return found.normal.dot(axis) - (cone.b_radius_mm - cone.a_radius_mm);
  };
  double low = 0, high = 1;
  Approach best = of_ball(lens, ball_at(cone, 0));
  const Approach end = of_ball(lens, ball_at(cone, 1));
  double falls = slope_of(best), rises = slope_of(end);
  if (falls >= 0) return best;
  if (rises <= 0) return end;
  for (int n = 0; n < 100 && (high - low) * axis.length() > 1e-7; ++n) {
    const double by_slopes = falls / (falls - rises);
    const double share = n % 3 == 2 ? 0.5 : std::clamp(by_slopes, 0.01, 0.99);
    const double part = low + (high - low) * share;
    const Approach found = of_ball(lens, ball_at(cone, part));
    if (found.distance_mm < best.distance_mm) best = found;
    const double slope = slope_of(found);
    if (std::abs(slope) < 1e-7) break;  // times what is left of the axis is below 1e-7 mm
    (slope > 0 ? high : low) = part;
    (slope > 0 ? rises : falls) = slope;
  }
  return best.distance_mm < end.distance_mm ? best : end;
}

/// A gate lets a shaft pass whose axis goes by it within gate_mm: what of it is beyond the gate is
/// free, and its inner end keeps off the wall except at the gate.
double gate_room(const HollowSphere& eye, const Vec3d& gate, const RoundCone& cone) {
  const Vec3d axis = direction_or_z(cone.b_mm - cone.a_mm);
  if (axis.dot(gate - eye.centre_mm) <= 0) return -HUGE_VAL;
  const Vec3d from = cone.a_mm - gate;
  const double along = from.dot(axis);
  const double aside = (from - axis * along).length();
  const double off_wall = eye.radius_mm - (cone.a_mm - eye.centre_mm).length() - cone.a_radius_mm;
  return std::min(eye.gate_mm - aside, std::max(off_wall, along + 2 * cone.a_radius_mm));
}

Approach of_cone(const HollowSphere& eye, const RoundCone& cone) {
  Approach nearest{HUGE_VAL, {}, {}};
  for (const double part : {0.0, 1.0}) {
    const Ball ball = ball_at(cone, part);
    const Vec3d out = ball.centre_mm - eye.centre_mm;
    const double room = eye.radius_mm - out.length() - ball.radius_mm;
    if (room >= nearest.distance_mm) continue;
    const Vec3d normal = -direction_or_z(out);
    nearest = {room, eye.centre_mm - normal * eye.radius_mm, normal};
  }
  if (nearest.distance_mm >= 0) return nearest;
  for (const Vec3d& gate : eye.gates_mm) {
    const double room = gate_room(eye, gate, cone);
    if (room <= nearest.distance_mm) continue;
    const Vec3d normal = -direction_or_z(cone.a_mm - eye.centre_mm);
    nearest = {room, eye.centre_mm - normal * eye.radius_mm, normal};
  }
  return nearest;
}

/// Piece of an axis between two balls whose distances are known.
struct AxisPiece {
  double from, to;                  // parts
  double from_room_mm, to_room_mm;  // distances of the balls
};

/// The least that a ball between may have. Distance changes no faster than a centre goes; and it is
/// the least of distances from points, whose second derivative along a line is at most 1 /
/// distance.
double least_between(const AxisPiece& piece, double length_mm, double change_mm, double radius_mm) {
  const double a = piece.from_room_mm, b = piece.to_room_mm;
  const double even = (a + b - length_mm - change_mm) / 2;
  const double farness = std::max((a + b - length_mm) / 2 + radius_mm, radius_mm / 2);
  const double bend = length_mm * length_mm / (2 * farness);
  if (!(bend > std::abs(b - a))) return std::max(even, std::min(a, b));
  const double x = (bend - (b - a)) / (2 * bend);
  return std::max(even, a + (b - a) * x - x * (1 - x) * bend);
}

/// Branch and bound along the axis: of meshes and solids of voxels.
template <class Surface>
Approach of_cone(const Surface& surface, const RoundCone& cone) {
  constexpr double kExactMm = 1e-3;
  constexpr int kMaxQueries = 2000;
  const double length = (cone.b_mm - cone.a_mm).length();
  const double change = std::abs(cone.b_radius_mm - cone.a_radius_mm);
  const double thin = std::max(1e-3, std::min(cone.a_radius_mm, cone.b_radius_mm));
  Approach best = of_ball(surface, ball_at(cone, 0));
  const Approach end = of_ball(surface, ball_at(cone, 1));
  std::vector<AxisPiece> open = {{0, 1, best.distance_mm, end.distance_mm}};
  if (end.distance_mm < best.distance_mm) best = end;
  for (int queries = 0; !open.empty() && queries < kMaxQueries; ++queries) {
    const AxisPiece piece = open.back();
    open.pop_back();
    const double part = piece.to - piece.from;
    const double exact = std::max(kExactMm, 0.02 * (std::abs(best.distance_mm) - thin));
    if (least_between(piece, part * length, part * change, thin) > best.distance_mm - exact) {
      continue;
    }
    const double middle = (piece.from + piece.to) / 2;
    const Approach found = of_ball(surface, ball_at(cone, middle));
    if (found.distance_mm < best.distance_mm) best = found;
    AxisPiece nearer{piece.from, middle, piece.from_room_mm, found.distance_mm};
    AxisPiece farther{middle, piece.to, found.distance_mm, piece.to_room_mm};
    if (piece.to_room_mm < piece.from_room_mm) std::swap(nearer, farther);
    open.push_back(farther);
    open.push_back(nearer);
  }
  return best;
}

}  // namespace

Approach approach(const RoundCone& part, const RigidSurface& surface) {
  return std::visit([&](const auto& s) { return of_cone(s, part); }, surface);
}

}  // namespace supple

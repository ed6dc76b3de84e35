// Instruments, poses and surfaces of tests.
#pragma once

#include <memory>
#include <random>
#include <vector>

#include "lib/contact/mesh_surface.h"
#include "lib/instruments/tool_contact.h"

namespace supple::test {

constexpr InstrumentKind kInstrumentKinds[] = {InstrumentKind::needle,  InstrumentKind::pick,
                                               InstrumentKind::forceps, InstrumentKind::vitrector,
                                               InstrumentKind::lamp,    InstrumentKind::spatula};

inline Instrument instrument_of(InstrumentKind kind) {
  InstrumentSetup setup;
  setup.name = "tool";
  setup.kind = kind;
  return make_instrument(setup);
}

inline double random_number(std::mt19937& random, double lo, double hi) {
  return lo + (hi - lo) * double(random()) / 4294967296.0;
}
inline Vec3d random_point(std::mt19937& random, double reach) {
  const double x = random_number(random, -reach, reach), y = random_number(random, -reach, reach);
  return {x, y, random_number(random, -reach, reach)};
}
inline Vec3d random_direction(std::mt19937& random) {
  for (;;) {
    const Vec3d v = random_point(random, 1);
    if (v.length() > 0.1 && v.length() < 1) return v.normalized();
  }
}

/// A globe of 11 mm with a gate and a lens before it, about the origin; its hand is at +z.
inline Vec3d eye_gate() {
  return Vec3d(0.6, 0.2, 0.77).normalized() * 11.0;
}
inline Obstacle globe() {
  return {"globe", HollowSphere{{0, 0, 0}, 11, {eye_gate()}, 0.5}};
}
inline LensShape eye_lens() {
  return {{{0, 0, 2.2}, 6}, {{0, 0, 13.8}, 8}};
}

/// A box of triangles that face outwards.
inline TriangleMesh plate(const Vec3d& centre, const Vec3d& half) {
  TriangleMesh mesh;
  for (int n = 0; n < 8; ++n) {
    mesh.vertices_lps_mm.push_back(centre +
                                   half * Vec3d(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1));
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}
inline MeshShape mesh_of(const TriangleMesh& mesh) {
  return {std::make_shared<const MeshSurface>(mesh), {0, 0, 0}};
}

/// A tip inside of a globe and a shaft through its gate.
inline InstrumentPose random_eye_pose(std::mt19937& random, double reach_mm) {
  InstrumentPose pose;
  pose.tip_mm = random_direction(random) * random_number(random, 0, reach_mm);
  pose.axis = (eye_gate() - pose.tip_mm).normalized();
  pose.roll_degrees = random_number(random, -180, 180);
  pose.opening_degrees = random_number(random, 0, 40);
  return pose;
}

/// Distance of the nearest of dense balls along all parts, by the distance of points alone.
template <class OfPoint>
double brute_distance(const std::vector<RoundCone>& parts, int samples, OfPoint&& of_point) {
  double least = HUGE_VAL;
  for (const RoundCone& part : parts) {
    for (int n = 0; n <= samples; ++n) {
      const double t = double(n) / samples;
      const Vec3d centre = part.a_mm + (part.b_mm - part.a_mm) * t;
      const double radius = part.a_radius_mm + (part.b_radius_mm - part.a_radius_mm) * t;
      least = std::min(least, of_point(centre) - radius);
    }
  }
  return least;
}

}  // namespace supple::test

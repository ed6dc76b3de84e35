#include "lib/session/handles/handle_motion.h"

#include <cmath>

#include "volumes/base/error.h"
#include "volumes/geometry/geometry.h"

namespace supple {

namespace {

Vec3d scaled(const Vec3d& v, const HandleMotion& motion, const Geometry& geometry) {
  if (!motion.scales_along_grid) return v * motion.scale;
  return geometry.world_vector_from_index(geometry.index_vector_from_world(v) * motion.scale);
}

}  // namespace

Vec3d place_now(const Body& body, Slot slot) {
  Vec3d place(voxel_of(body.elements, slot));
  for (int c = 0; c < 3; ++c) place[c] += body.q[std::size_t(c)].at(slot) / kFixedOne;
  return place;
}

Vec3d centre_lps_mm(const Body& body, const SlotSet& slots) {
  Vec3d sum(0.0);
  slots.for_each([&](Slot slot) { sum += place_now(body, slot); });
  return body.geometry.world_from_index(sum / double(slots.size()));
}

Displacements displacements_of(const Body& body, const SlotSet& slots, const HandleMotion& motion,
                               const Vec3d& by_mm, const std::vector<double>& parts) {
  const Geometry& geometry = body.geometry;
  const Vec3d about = motion.about_lps_mm ? *motion.about_lps_mm : centre_lps_mm(body, slots);
  const Turn turn = turn_about(motion.axis_lps, motion.angle_deg);
  const Vec3d shift = by_mm / geometry.spacing_mm();
  Displacements displacements;
  displacements.reserve(slots.size());
  slots.for_each([&](Slot slot) {
    const Vec3d from = geometry.world_from_index(place_now(body, slot)) - about;
    const Vec3d to = turn(scaled(from, motion, geometry));
    Vec3d way = shift;
    if (!motion.is_shift()) way += geometry.index_vector_from_world(to - from);
    if (!parts.empty()) way *= parts[displacements.size()];
    auto& by = displacements.emplace_back();
    for (int c = 0; c < 3; ++c) {
      if (!(std::abs(way[c]) <= 16383)) {
        throw InputError({"", "voxel " + voxel_text(voxel_of(body.elements, slot)),
                          "a move by " + number_text(way[c]) + " voxels along axis " + "ijk"[c],
                          "moves within +-16383 voxels"});
      }
      by[std::size_t(c)] = std::int32_t(std::lround(way[c] * kFixedOne));
    }
  });
  return displacements;
}

GridSteps steps_of(const HandleMotion& motion, const Geometry& geometry) {
  const Turn turn = turn_about(motion.axis_lps, motion.angle_deg);
  GridSteps steps;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3d image = turn(scaled(geometry.axes_mm()[axis], motion, geometry));
    steps[axis] = geometry.index_vector_from_world(image);
  }
  return steps;
}

}  // namespace supple

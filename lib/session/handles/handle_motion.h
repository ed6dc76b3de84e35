// Motion of a handle: scaled, turned and shifted as one body, with an edge that follows in part.
#pragma once

#include <optional>
#include <vector>

#include "lib/chainmail/ecm.h"
#include "lib/session/handles/selection.h"

namespace supple {

/// Scale, then turn, both about one point and in mm, so that unequal spacings keep shapes; the
/// shift comes after.
struct HandleMotion {
  std::optional<Vec3d> about_lps_mm;  // absent: the middle of the grabbed elements
  Vec3d axis_lps{0, 0, 1};            // of any length but 0
  double angle_deg = 0;               // right-handed about the axis
  Vec3d scale{1, 1, 1};
  bool scales_along_grid = false;  // scale is along i, j, k, not x, y, z

  bool is_shift() const { return angle_deg == 0 && scale == Vec3d(1); }
};

using Displacements = std::vector<std::array<std::int32_t, 3>>;

/// Present place of an element, in voxels.
Vec3d place_now(const Body& body, Slot slot);

/// The middle of the present places of elements.
Vec3d centre_lps_mm(const Body& body, const SlotSet& slots);

/// Ways of elements in 2^-16 voxel: parts[n] (1 where `parts` is empty) of the way from where it is
/// now to A (x - p) + p + t, with p = about_lps_mm and t = by_mm along the grid axes, rounded once.
/// Throws InputError beyond +-16383 voxels.
Displacements displacements_of(const Body& body, const SlotSet& slots, const HandleMotion& motion,
                               const Vec3d& by_mm, const std::vector<double>& parts = {});

/// Returns the steps of the motion between the places where it starts.
GridSteps steps_of(const HandleMotion& motion, const Geometry& geometry);

}  // namespace supple

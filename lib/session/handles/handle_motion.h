// Motion of a handle: scaled, turned and shifted as one body, with an edge that follows in part.
#pragma once

#include <optional>
#include <vector>

#include "lib/chainmail/drag.h"
#include "lib/session/handles/drag.h"
#include "lib/session/handles/selection.h"

namespace supple {

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

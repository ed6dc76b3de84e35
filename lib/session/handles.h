// Handles, anchors and parts of a step on the grid of a volume.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "lib/session/step.h"

namespace supple {

/// Handles follow their paths from the first key to the last.
constexpr double kWholePaths = std::numeric_limits<double>::infinity();

/// The step with everything that is placed (handles, anchors, points, parts) on the grid. Handles
/// that have a path are at their poses at `time`, where a film takes them at once. Throws
/// InputError for places outside the volume and for displacements beyond the range.
Step on_grid(const Step& step, const Geometry& geometry, double time = kWholePaths);

Vec3d index_of(const Vec3d& place, PlaceFrame frame, const Geometry& geometry);
/// Turns a vector in mm from the frame into LPS.
Vec3d lps_of(const Vec3d& vector_mm, PlaceFrame frame, const Geometry& geometry);

/// The voxels of a voxel or box. In mm, those between the voxels nearest to the corners.
std::optional<IndexBox> box_of(const PlacedSelection& given, const Geometry& geometry);

/// The elements that an anchor holds. Throws InputError for a place outside the volume.
Selection to_selection(const PlacedSelection& given, const Geometry& geometry);

/// The path on a grid; empty where the handle follows none.
PosePath path_of(const PlacedHandle& given, const Geometry& geometry);

/// The handle on a grid: one drag, or one per point with a displacement of its own. A handle that
/// follows a path is taken at its pose at `time`. Throws InputError for places outside the volume
/// and for displacements beyond the range.
std::vector<Drag> to_drags(const PlacedHandle& given, const Geometry& geometry, double time);

/// Throws InputError with the line of the first point that lies outside the body, and how far.
void require_in_body(const PointFile& points, const Body& body);

}  // namespace supple

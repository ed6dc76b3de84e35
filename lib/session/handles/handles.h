// Places of handles, anchors and parts on the grid of a volume.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "lib/session/handles/drag.h"

namespace supple {

class PosePath;

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
/// follows a path is taken at its pose at `time`. Throws InputError for places outside the volume.
std::vector<Drag> to_drags(const Drag& handle, const Geometry& geometry, double time = kWholePaths);
/// The part on a grid. Throws InputError for places outside the volume.
ChosenPart on_grid(ChosenPart part, const Geometry& geometry);
/// The voxels of points. Throws InputError for one outside the volume.
std::vector<Vec3i> voxels_of(const PointFile& points, const Geometry& geometry);

/// Throws InputError with the line of the first point that lies outside the body, and how far.
void require_in_body(const PointFile& points, const Body& body);

}  // namespace supple

// Handles and anchors as users write them, on the command line and in scenes: voxels, boxes,
// positions in LPS millimetres, files of points and labels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/session/step.h"
#include "volumes/io/point_file.h"

namespace supple {

/// Exactly one of box, at_lps_mm, points and label, and one of by_mm and by_lps_mm unless the
/// points have displacements of their own.
struct GivenHandle {
  std::string place;            // "file:line" of a scene, for errors
  std::optional<IndexBox> box;  // a voxel is a box of one
  std::optional<Vec3d> at_lps_mm;
  std::optional<PointFile> points;
  std::optional<std::int32_t> label;
  std::optional<Vec3d> by_mm;  // along the grid axes i, j, k
  std::optional<Vec3d> by_lps_mm;
  bool push = false;
};

/// What it means on a grid: one drag, or one per point with a displacement of its own. Throws
/// InputError for what cannot move there: outside the volume, or beyond the range.
std::vector<Drag> to_drags(const GivenHandle& given, const Geometry& geometry);

/// Throws InputError with the line of the first point that lies outside the body, and how far.
void require_in_body(const PointFile& points, const Body& body);

/// The voxels of the points as boxes of one each, without duplicates. Throws InputError for one
/// outside the volume.
std::vector<IndexBox> boxes_of(const PointFile& points, const Geometry& geometry);

}  // namespace supple

#include "lib/session/handles.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

/// The voxel of a position; throws InputError unless the volume holds it.
Vec3i voxel_at(const Vec3d& at_lps_mm, const Geometry& geometry, const std::string& place,
               const std::string& field) {
  const Vec3d index = geometry.index_from_world(at_lps_mm);
  Vec3i voxel;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(index[axis] >= -0.5 && index[axis] < geometry.dims()[axis] - 0.5)) {
      throw InputError({place, field, to_text(at_lps_mm) + ", voxel " + to_text(index),
                        "a position inside the volume"});
    }
    voxel[axis] = std::clamp(int(std::lround(index[axis])), 0, geometry.dims()[axis] - 1);
  }
  return voxel;
}

Vec3i voxel_of(const PointFile& points, const PointFile::Row& row, const Geometry& geometry) {
  return voxel_at(row.at_lps_mm, geometry, points.place(row), "x,y,z");
}

Vec3d along_grid(const Vec3d& by_lps_mm, const Geometry& geometry) {
  return geometry.index_vector_from_world(by_lps_mm) * geometry.spacing_mm();
}

std::string file_name(const PointFile& points) {
  return std::filesystem::path(points.path).filename().string();
}

/// Every point its own handle, named by its line.
std::vector<Drag> drags_of_points(const PointFile& points, HandleKind kind,
                                  const Geometry& geometry) {
  std::vector<Drag> drags;
  for (const PointFile::Row& row : points.rows) {
    const std::string name = file_name(points) + ":" + std::to_string(row.line);
    drags.push_back({Region::of_points({voxel_of(points, row, geometry)}, name),
                     along_grid(row.by_lps_mm, geometry), kind});
  }
  return drags;
}

Region region_of(const GivenHandle& given, const Geometry& geometry) {
  if (given.points) {
    std::vector<Vec3i> voxels;
    for (const PointFile::Row& row : given.points->rows) {
      voxels.push_back(voxel_of(*given.points, row, geometry));
    }
    return Region::of_points(std::move(voxels), file_name(*given.points));
  }
  if (given.label) return Vec3i(0);  // the session finds the elements
  if (given.at_lps_mm) return voxel_at(*given.at_lps_mm, geometry, given.place, "at_mm");
  return *given.box;
}

}  // namespace

std::vector<Drag> to_drags(const GivenHandle& given, const Geometry& geometry) {
  const HandleKind kind = given.push ? HandleKind::push : HandleKind::two_sided;
  if (given.points && given.points->has_displacements) {
    return drags_of_points(*given.points, kind, geometry);
  }
  Drag drag{region_of(given, geometry),
            given.by_mm ? *given.by_mm : along_grid(*given.by_lps_mm, geometry), kind,
            given.label.value_or(0)};
  return {std::move(drag)};
}

void require_in_body(const PointFile& points, const Body& body) {
  for (const PointFile::Row& row : points.rows) {
    const Vec3i voxel = voxel_of(points, row, body.geometry);
    if (body.elements.is_active(voxel)) continue;
    throw InputError({points.place(row), "x,y,z",
                      to_text(row.at_lps_mm) + ", voxel " + to_text(voxel) + ", which is void",
                      "a point in the body; " + nearest_text(body, voxel)});
  }
}

std::vector<IndexBox> boxes_of(const PointFile& points, const Geometry& geometry) {
  std::vector<IndexBox> boxes;
  for (const PointFile::Row& row : points.rows) {
    const Vec3i voxel = voxel_of(points, row, geometry);
    boxes.push_back({voxel, voxel});
  }
  return boxes;
}

}  // namespace supple

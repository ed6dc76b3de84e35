#include "lib/session/handles/handles.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lib/session/handles/handle_path.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/geometry/pose_path.h"

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

/// Makes every point a handle of its own, named by its line: a voxel, or a ball around it.
std::vector<Drag> drags_of_points(const Drag& handle, const Geometry& geometry) {
  const PointFile& points = *handle.placed->points;
  std::vector<Drag> drags;
  for (const PointFile::Row& row : points.rows) {
    const std::string name = file_name(points) + ":" + std::to_string(row.line);
    const Vec3i voxel = voxel_of(points, row, geometry);
    Drag& drag = drags.emplace_back(handle);
    drag.placed.reset();
    drag.region = Region::of_points({voxel}, name);
    drag.by_mm = along_grid(row.by_lps_mm, geometry);
    if (const std::optional<double> radius_mm = handle.placed->radius_mm) {
      drag.selection.emplace();
      drag.selection->ball_index = geometry.index_from_world(row.at_lps_mm);
      drag.selection->radius_mm = *radius_mm;
    } else if (handle.soft_mm > 0) {
      drag.selection.emplace();
      drag.selection->box = IndexBox{voxel, voxel};
    }
  }
  return drags;
}

Region region_of(const PlacedHandle& given, const Geometry& geometry) {
  if (given.points) {
    return Region::of_points(voxels_of(*given.points, geometry), file_name(*given.points));
  }
  if (given.at_lps_mm) return voxel_at(*given.at_lps_mm, geometry, given.place, "at_mm");
  if (given.corners) return *box_of(given, geometry);
  return Vec3i(0);  // the session finds the elements
}

/// True if the elements are found by more than a region of voxels.
bool needs_selection(const PlacedHandle& given, double soft_mm) {
  return given.ball || given.density || given.piece_at || given.rigid_at || soft_mm > 0;
}

HandleMotion motion_of(const PlacedHandle& given, const Geometry& geometry) {
  HandleMotion motion;
  if (given.about) {
    motion.about_lps_mm = geometry.world_from_index(index_of(*given.about, given.frame, geometry));
  }
  if (given.rotate_deg) {
    motion.angle_deg = *given.rotate_deg;
    motion.axis_lps = lps_of(*given.axis, given.frame, geometry);
  }
  motion.scale = given.scale_axes.value_or(Vec3d(given.scale.value_or(1)));
  motion.scales_along_grid = given.frame == PlaceFrame::voxel;
  return motion;
}

/// Along the grid axes; of a handle, or of a pose in its frame.
template <class Given>
Vec3d shift_mm(const Given& given, PlaceFrame frame, const Geometry& geometry) {
  if (given.by_lps_mm) return along_grid(*given.by_lps_mm, geometry);
  const Vec3d by = given.by.value_or(Vec3d(0));
  if (frame == PlaceFrame::voxel) return by;
  return along_grid(lps_of(by, frame, geometry), geometry);
}

}  // namespace

Vec3d index_of(const Vec3d& place, PlaceFrame frame, const Geometry& geometry) {
  if (frame == PlaceFrame::voxel) return place;
  return geometry.index_from_world(lps_of(place, frame, geometry));
}

Vec3d lps_of(const Vec3d& vector_mm, PlaceFrame frame, const Geometry& geometry) {
  if (frame == PlaceFrame::lps) return vector_mm;
  if (frame == PlaceFrame::ras) return {-vector_mm.x, -vector_mm.y, vector_mm.z};
  return geometry.world_vector_from_index(vector_mm / geometry.spacing_mm());
}

Fields fields(PlacedSelection& given) {
  return {
      Field("frame", given.frame, {"voxel", "lps", "ras"},
            "Places are voxels, and directions mm along the grid axes; or both are mm in LPS or "
            "RAS"),
      Field("grab_ball", given.ball, "Centre of a ball, whose elements are grabbed"),
      Field("radius", given.radius_mm,
            "Of the ball, or of one around each point that goes its own way")
          .unit("mm")
          .at_least(0),
      Field("grab_density", given.density,
            "Elements of these densities, of the box or ball if there is one"),
      Field("piece_at", given.piece_at,
            "The face-connected piece that holds this place, of what else is grabbed or of all"),
      Field("rigid_at", given.rigid_at, "The rigid piece that holds this place"),
  };
}

Fields fields(Drag& handle) {
  PlacedHandle& given = *handle.placed;
  return {
      Field("by", given.by, "How far, in mm along the directions of the frame"),
      Field("by_mm_lps", given.by_lps_mm, "The same in LPS, whatever the frame"),
      Field("scale", given.scale, "Factor about a point, before it is turned").positive(),
      Field("scale_axes", given.scale_axes, "The same, one factor per axis of the frame")
          .positive(),
      Field("rotate", given.rotate_deg, "Right-handed turn about the axis, before it is shifted")
          .unit("degrees")
          .range(-180, 180),
      Field("axis", given.axis, "Direction of the turn's axis"),
      Field("about", given.about, "The point that turn and scale leave where it is")
          .otherwise("the middle of what is grabbed"),
      Field("soft", handle.soft_mm,
            "Width of an edge around a voxel, box or ball that follows in part")
          .unit("mm")
          .at_least(0),
      Field("push", handle.pushes, "Moves tissue ahead of it along each axis, and never back"),
      Field("spare_fixed", handle.spares_fixed,
            "Leaves out elements that are fixed, and rigid pieces that anchors hold"),
      Field("slide", handle.slides,
            "A shift that is stopped goes on along each grid axis as far as that is free"),
  };
}

Fields key_fields(double& time, Easing& easing) {
  return {
      Field("time", time, "When the key is reached, in seconds or frames as [film] says")
          .required(),
      Field("easing", easing, {"smooth", "linear", "spline", "hold"},
            "On the way to the next key: starts and stops gently, evenly, passes through without a "
            "stop, or jumps at its end"),
  };
}

Fields fields(PlacedPose& given) {
  Fields all = key_fields(given.time, given.easing);
  const Fields own = {
      Field("by", given.by, "Shift, in mm along the directions of the frame"),
      Field("by_mm_lps", given.by_lps_mm, "The same in LPS, whatever the frame"),
      Field("rotate", given.rotate_deg, "Right-handed turn about the axis; 720: twice round")
          .unit("degrees")
          .range(-36000, 36000),
      Field("axis", given.axis, "Direction of the turn's axis")
          .otherwise("that of the handle, or of the first pose"),
      Field("scale", given.scale, "Factor about a point, before it is turned").positive(),
      Field("scale_axes", given.scale_axes, "The same, one factor per axis of the frame")
          .positive(),
  };
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

std::optional<IndexBox> box_of(const PlacedSelection& given, const Geometry& geometry) {
  if (!given.corners) return std::nullopt;
  IndexBox box;
  const auto& [a, b] = *given.corners;
  const Vec3i first = nearest_voxel(index_of(a, given.frame, geometry));
  const Vec3i second = nearest_voxel(index_of(b, given.frame, geometry));
  for (int c = 0; c < 3; ++c) {
    box.lo[c] = std::min(first[c], second[c]);
    box.hi[c] = std::max(first[c], second[c]);
  }
  return box;
}

Selection to_selection(const PlacedSelection& given, const Geometry& geometry) {
  Selection selection;
  selection.box = box_of(given, geometry);
  if (given.at_lps_mm) {
    const Vec3i voxel = voxel_at(*given.at_lps_mm, geometry, given.place, "at_mm");
    selection.box = IndexBox{voxel, voxel};
  }
  if (given.ball) {
    selection.ball_index = index_of(*given.ball, given.frame, geometry);
    selection.radius_mm = given.radius_mm.value_or(0);
  }
  selection.density = given.density;
  const auto voxel_of_place = [&](const Vec3d& place, const char* field) {
    const Vec3d index = index_of(place, given.frame, geometry);
    return voxel_at(geometry.world_from_index(index), geometry, given.place, field);
  };
  if (given.piece_at) selection.piece_at = voxel_of_place(*given.piece_at, "piece_at");
  if (given.rigid_at) selection.rigid_at = voxel_of_place(*given.rigid_at, "rigid_at");
  return selection;
}

PosePath path_of(const PlacedHandle& given, const Geometry& geometry) {
  const auto with_axis = std::find_if(given.path.begin(), given.path.end(),
                                      [](const PlacedPose& pose) { return pose.axis.has_value(); });
  const Vec3d first = with_axis != given.path.end() ? *with_axis->axis : Vec3d(0, 0, 1);
  const Vec3d axis = given.axis.value_or(first);
  PosePath path;
  for (const PlacedPose& pose : given.path) {
    if (pose.by || pose.by_lps_mm) {
      path.add_shift(pose.time, shift_mm(pose, given.frame, geometry), pose.easing);
    }
    if (pose.rotate_deg) {
      path.add_turn(pose.time, lps_of(pose.axis.value_or(axis), given.frame, geometry),
                    *pose.rotate_deg, pose.easing);
    }
    if (pose.scale || pose.scale_axes) {
      path.add_scale(pose.time, pose.scale_axes.value_or(Vec3d(pose.scale.value_or(1))),
                     pose.easing);
    }
  }
  return path;
}

std::vector<Drag> to_drags(const Drag& handle, const Geometry& geometry, double time) {
  if (!handle.placed) return {handle};
  const PlacedHandle& given = *handle.placed;
  if (given.points && given.points->has_displacements) {
    return drags_of_points(handle, geometry);
  }
  Drag drag = handle;
  drag.placed.reset();
  drag.region = region_of(given, geometry);
  drag.by_mm = shift_mm(given, given.frame, geometry);
  drag.label = given.label.value_or(0);
  if (needs_selection(given, handle.soft_mm)) drag.selection = to_selection(given, geometry);
  drag.motion = motion_of(given, geometry);
  if (handle.is_animated()) {
    const DragPose pose = pose_of(path_of(given, geometry).at(time), drag.motion);
    drag.by_mm = pose.by_mm;
    drag.motion = pose.motion;
  }
  return {std::move(drag)};
}

ChosenPart on_grid(ChosenPart part, const Geometry& geometry) {
  if (!part.placed) return part;
  part.label = part.placed->label.value_or(0);
  if (!part.placed->label) part.selection = to_selection(*part.placed, geometry);
  part.placed.reset();
  return part;
}

std::vector<Vec3i> voxels_of(const PointFile& points, const Geometry& geometry) {
  std::vector<Vec3i> voxels;
  for (const PointFile::Row& row : points.rows) voxels.push_back(voxel_of(points, row, geometry));
  return voxels;
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

}  // namespace supple

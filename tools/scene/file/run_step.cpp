#include "tools/scene/file/run_step.h"

#include <cmath>

#include "lib/session/handle_path.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

std::vector<Drag> drags_of(const std::vector<GivenHandle>& handles, const Geometry& geometry,
                           double time) {
  if (time == kWholePaths) return drags_along_paths(handles, geometry);
  std::vector<Drag> drags;
  for (const GivenHandle& handle : handles) {
    for (Drag& drag : to_drags(handle, geometry, time)) drags.push_back(std::move(drag));
  }
  return drags;
}

}  // namespace

StepRequest request_of(const SceneStep& step, const Geometry& geometry, double time) {
  StepRequest request;
  request.drags = drags_of(step.handles, geometry, time);
  request.fix = step.fix;
  for (const PointFile& file : step.fix_points) {
    const std::vector<IndexBox> points = boxes_of(file, geometry);
    request.fix.insert(request.fix.end(), points.begin(), points.end());
  }
  request.fix_labels = step.fix_labels;
  for (const GivenSelection& given : step.anchors) {
    Selection selection = to_selection(given, geometry);
    Selection without_box = selection;
    without_box.box.reset();
    if (without_box == Selection()) {
      request.fix.push_back(*selection.box);
    } else {
      request.fix_selections.push_back(std::move(selection));
    }
  }
  for (const GivenPart& part : step.remove) request.remove.push_back(to_part(part, geometry));
  request.retract = step.retract;
  request.rigid.density = step.rigid_density;
  request.rigid.joint_mm = step.joint_mm;
  request.rigid.seeds = step.rigid_seeds;
  for (const GivenPart& part : step.rigid) request.rigid.parts.push_back(to_part(part, geometry));
  request.release = step.release;
  request.cuts = step.cuts;
  request.limits = step.limits;
  request.relax = step.relax;
  request.no_relax = step.no_relax;
  request.shift_pieces = step.shift_pieces;
  request.springs = step.springs;
  request.material = step.material;
  if (step.fem) request.fem = fem_step(*step.fem, geometry);
  return request;
}

namespace {

/// A hint where the voxel would lie inside, were it a place in LPS mm.
std::string as_millimetres(const Vec3i& voxel, const Geometry& geometry) {
  const Vec3d index = geometry.index_from_world(Vec3d(voxel));
  Vec3i nearest;
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] >= -0.5 && index[a] < geometry.dims()[a] - 0.5)) return "";
    nearest[a] = int(std::lround(index[a]));
  }
  return "; as LPS mm it is voxel " + to_text(nearest);
}

void require_meets_volume(const IndexBox& box, const std::string& place, const std::string& field,
                          const Geometry& geometry) {
  const Vec3i& dims = geometry.dims();
  bool outside = false;
  for (int a = 0; a < 3; ++a) outside = outside || box.hi[a] < 0 || box.lo[a] >= dims[a];
  if (!outside) return;
  const bool single = box.lo == box.hi;
  throw InputError(
      {place, field, to_text(box.lo) + (single ? "" : ":" + to_text(box.hi)),
       std::string(single ? "a voxel of the volume, " : "a box that meets the volume, ") +
           to_text(dims) + as_millimetres(box.lo, geometry)});
}

}  // namespace

void check_step(const SceneStep& step, const Geometry& geometry) {
  for (const GivenHandle& handle : step.handles) {
    const auto box = box_of(handle, geometry);
    if (box) require_meets_volume(*box, step.place, "grab", geometry);
    if ((step.springs || step.fem) && handle.push) {
      throw InputError({step.place, "push",
                        std::string("a push handle beside ") + (step.fem ? "fem" : "springs"),
                        "handles that hold what they grab"});
    }
  }
  for (const IndexBox& box : step.fix) {
    require_meets_volume(box, step.place, "fix", geometry);
  }
  for (const Drag& drag : request_of(step, geometry).drags) {
    fixed_from_mm(drag.by_mm, geometry.spacing_mm());
  }
}

namespace {

/// Errors of the session, which names no place, get that of the step.
template <class Work>
decltype(auto) placed_at(const SceneStep& step, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    const Problem& problem = error.problem();
    if (!problem.file.empty()) throw;
    throw InputError({step.place, problem.field, problem.found, problem.expected});
  }
}

void require_points(const SceneStep& step, const Body& body) {
  for (const GivenHandle& handle : step.handles) {
    if (handle.points) require_in_body(*handle.points, body);
  }
  for (const PointFile& file : step.fix_points) require_in_body(file, body);
}

}  // namespace

void check_step(const Session& session, const SceneStep& step) {
  placed_at(step, [&] {
    require_points(step, session.body());
    session.check(request_of(step, session.geometry()));
  });
}

const StepRecord& run_step(Session& session, const SceneStep& step, bool tells_reactions,
                           Progress* progress, double time) {
  return placed_at(step, [&]() -> const StepRecord& {
    require_points(step, session.body());
    StepRequest request = request_of(step, session.geometry(), time);
    request.tells_reactions = tells_reactions;
    return session.step(request, progress);
  });
}

}  // namespace supple::tools

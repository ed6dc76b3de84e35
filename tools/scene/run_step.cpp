#include "tools/scene/run_step.h"

#include "volumes/base/text.h"

namespace supple::tools {

namespace {

/// What a step asks of the solver, on the grid of the volume.
StepRequest on_grid(const SceneStep& step, const Geometry& geometry) {
  StepRequest request;
  for (const GivenHandle& handle : step.handles) {
    for (Drag& drag : to_drags(handle, geometry)) request.drags.push_back(std::move(drag));
  }
  request.fix = step.fix;
  for (const PointFile& file : step.fix_points) {
    const std::vector<IndexBox> points = boxes_of(file, geometry);
    request.fix.insert(request.fix.end(), points.begin(), points.end());
  }
  request.fix_labels = step.fix_labels;
  request.release = step.release;
  request.cuts = step.cuts;
  request.limits = step.limits;
  request.relax = step.relax;
  request.springs = step.springs;
  return request;
}

void require_meets_volume(const IndexBox& box, const std::string& place, const std::string& field,
                          const Vec3i& dims) {
  bool outside = false;
  for (int a = 0; a < 3; ++a) outside = outside || box.hi[a] < 0 || box.lo[a] >= dims[a];
  if (!outside) return;
  const bool single = box.lo == box.hi;
  throw InputError(
      {place, field, to_text(box.lo) + (single ? "" : ":" + to_text(box.hi)),
       std::string(single ? "a voxel of the volume, " : "a box that meets the volume, ") +
           to_text(dims)});
}

}  // namespace

void check_step(const SceneStep& step, const Geometry& geometry) {
  for (const GivenHandle& handle : step.handles) {
    if (handle.box) require_meets_volume(*handle.box, step.place, "grab", geometry.dims());
    if (step.springs && handle.push) {
      throw InputError(
          {step.place, "push", "a push handle beside springs", "handles that hold what they grab"});
    }
  }
  for (const IndexBox& box : step.fix) {
    require_meets_volume(box, step.place, "fix", geometry.dims());
  }
  for (const Drag& drag : on_grid(step, geometry).drags) {
    fixed_from_mm(drag.by_mm, geometry.spacing_mm());
  }
}

const StepRecord& run_step(Session& session, const SceneStep& step, bool tells_reactions,
                           Progress* progress) {
  try {
    for (const GivenHandle& handle : step.handles) {
      if (handle.points) require_in_body(*handle.points, session.body());
    }
    for (const PointFile& file : step.fix_points) require_in_body(file, session.body());
    StepRequest request = on_grid(step, session.geometry());
    request.tells_reactions = tells_reactions;
    return session.step(request, progress);
  } catch (const InputError& error) {
    const Problem& problem = error.problem();
    if (!problem.file.empty()) throw;
    throw InputError({step.place, problem.field, problem.found, problem.expected});
  }
}

}  // namespace supple::tools

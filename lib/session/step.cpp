#include "lib/session/step.h"

#include <algorithm>
#include <cmath>

#include "lib/session/handles/handle_path.h"
#include "lib/session/step_model.h"
#include "lib/session/tet_step.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

std::vector<Drag> drags_of(const Step& step, const Geometry& geometry, double time) {
  if (time == kWholePaths) return drags_along_paths(step.drags, geometry);
  std::vector<Drag> drags;
  for (const Drag& handle : step.drags) {
    for (Drag& drag : to_drags(handle, geometry, time)) drags.push_back(std::move(drag));
  }
  return drags;
}

/// Anchors of a file of points are a voxel each.
std::vector<ChosenPart> anchors_of(const Step& step, const Geometry& geometry) {
  std::vector<ChosenPart> anchors;
  for (const ChosenPart& part : step.fix) {
    if (part.placed && part.placed->points) {
      for (const Vec3i& voxel : voxels_of(*part.placed->points, geometry)) {
        anchors.push_back({voxel, voxel});
      }
    } else {
      anchors.push_back(on_grid(part, geometry));
    }
  }
  return anchors;
}

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

void check_places(const Step& step, const Geometry& geometry) {
  if (!step.body.empty()) return;  // its nodes may lie anywhere
  for (const Drag& handle : step.drags) {
    const auto box = handle.placed ? box_of(*handle.placed, geometry) : std::nullopt;
    if (box) require_meets_volume(*box, step.place, "grab", geometry);
    if (handle.pushes && !model_of(step).knows_pushes) {
      throw InputError({step.place, "push", "a push handle beside " + model_of(step).name,
                        "handles that hold what they grab"});
    }
  }
  for (const ChosenPart& part : step.fix) {
    const IndexBox* box = part.box();
    if (box != nullptr) require_meets_volume(*box, step.place, "fix", geometry);
  }
  for (const Drag& drag : on_grid(step, geometry).drags) {
    fixed_from_mm(drag.by_mm, geometry.spacing_mm());
  }
}

Step on_grid(const Step& step, const Geometry& geometry, double time) {
  Step found = step;
  found.drags = drags_of(step, geometry, time);
  found.fix = anchors_of(step, geometry);
  for (ChosenPart& part : found.remove) part = on_grid(std::move(part), geometry);
  for (ChosenPart& part : found.rigid.parts) part = on_grid(std::move(part), geometry);
  if (!found.fem) return found;
  for (FemLoad& load : found.fem->loads) load.part = on_grid(std::move(load.part), geometry);
  if (!found.fem->tets) return found;
  found.fem->tets = std::make_shared<TetStep>(*found.fem->tets);
  for (TetOpening& opening : found.fem->tets->openings) {
    if (opening.part) opening.part = on_grid(std::move(*opening.part), geometry);
  }
  return found;
}

bool Step::does_nothing() const {
  return drags.empty() && fix.empty() && !release && cuts.empty() && remove.empty() &&
         rigid.empty() && retract.empty() && !relax && !springs && !fem && !own.has_value() &&
         !material && !turn_pieces && limits != Limits::tighten;
}

bool Step::is_animated() const {
  return std::any_of(drags.begin(), drags.end(),
                     [](const Drag& handle) { return handle.is_animated(); });
}

}  // namespace supple

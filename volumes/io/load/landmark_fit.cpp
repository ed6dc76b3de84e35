#include "volumes/io/load/landmark_fit.h"

#include "volumes/base/error.h"
#include "volumes/io/load/stored_labels.h"

namespace supple {

namespace {

std::shared_ptr<const RigidRegions> read_regions(const LandmarkFit& settings,
                                                 const Landmarks& landmarks, Progress* progress) {
  if (settings.rigid.empty()) return nullptr;
  const StoredLabels labels(*open_volume(settings.labels, {}, progress), progress);
  const RegionLabels regions{labels.geometry(), [&](const Vec3i& voxel) {
                               const Vec3d place = labels.geometry().world_from_index(Vec3d(voxel));
                               return std::int32_t(labels.label_at(place));
                             }};
  try {
    return std::make_shared<RigidRegions>(
        regions, std::vector<std::int32_t>(settings.rigid.begin(), settings.rigid.end()),
        landmarks.points, landmarks.vectors, settings.width_mm);
  } catch (const InputError& error) {
    Problem problem = error.problem();
    problem.file = settings.labels;
    throw InputError(problem);
  }
}

}  // namespace

Fields fields(LandmarkFit& settings) {
  return {
      Field("direction", settings.direction, {"resample", "material"},
            "The spline leads from TO to FROM, as volumes are read through it, or from FROM to TO"),
      Field("stiffness", settings.stiffness_mm,
            "0 meets the points; more bends less and misses them")
          .unit("mm")
          .at_least(0),
      Field("no_folds", settings.has_no_folds, "Raise stiffness until no cell of the grid folds"),
      Field("labels", settings.labels,
            "Label volume of rigid labels, where the vectors begin: at TO, or for material at FROM")
          .shown_as("FILE"),
      Field("rigid_width", settings.width_mm,
            "Distance from rigid labels at which half of the rest of the motion acts")
          .unit("mm")
          .positive(),
  };
}

UnfoldedMap fit_landmarks(const LandmarkFit& settings, const std::vector<Vec3d>& from,
                          const std::vector<Vec3d>& to, const Geometry& grid, Progress* progress) {
  if (settings.rigid.empty() != settings.labels.empty()) {
    throw UsageError("rigid and labels: found one of them, expected both or none");
  }
  if (from.empty() || from.size() != to.size()) {
    const std::string sizes = std::to_string(from.size()) + " and " + std::to_string(to.size());
    throw InputError({"", "points", sizes, "pairs, one or more"});
  }
  const bool is_forward = settings.direction == WarpDirection::material;
  Landmarks landmarks{is_forward ? from : to, {}};
  for (std::size_t n = 0; n < from.size(); ++n) {
    if (!is_finite(from[n]) || !is_finite(to[n])) {
      throw InputError({"", "points", "one that is not finite", "places in LPS mm"});
    }
    landmarks.vectors.push_back(is_forward ? to[n] - from[n] : from[n] - to[n]);
  }
  const auto regions = read_regions(settings, landmarks, progress);
  if (!settings.has_no_folds) {
    return {LandmarkMap(landmarks, regions, settings.stiffness_mm), settings.stiffness_mm};
  }
  stage(progress, "looking for the least stiffness without folds");
  return without_folds(landmarks, regions, settings.stiffness_mm, grid, progress);
}

Value to_value(const UnfoldedMap& found, const GridFolds& folds) {
  const LandmarkMisfit misfit = found.map.misfit();
  return {{"stiffness_mm", found.stiffness_mm},
          {"misfit_rms_mm", misfit.rms_mm},
          {"misfit_max_mm", misfit.largest_mm},
          {"folded_cells", folds.folded_cells()},
          {"smallest_det_f", folds.smallest_det()}};
}

}  // namespace supple

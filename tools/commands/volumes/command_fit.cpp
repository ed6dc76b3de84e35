// supple fit: a warp through pairs of landmarks.
#include <cstdio>
#include <optional>

#include "lib/state/state_outputs.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/json.h"
#include "volumes/base/text.h"
#include "volumes/field/landmarks/grid_folds.h"
#include "volumes/field/landmarks/unfolded_map.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/stored_labels.h"
#include "volumes/io/point_file.h"
#include "volumes/io/volume_writer.h"

namespace supple::tools {

namespace {

struct FitOptions {
  std::vector<std::string> points;
  std::string output, labels;
  std::vector<int> rigid;
  double stiffness_mm = 0, width_mm = 10;
  bool has_no_folds = false;
  WarpDirection direction = WarpDirection::resample;
  GridChoice grid;
  WriteOptions write;
};

Fields fields(FitOptions& options) {
  return {
      Field("direction", options.direction, {"resample", "material"},
            "The spline leads from TO to FROM, as volumes are read through it, or from FROM to TO"),
      Field("stiffness", options.stiffness_mm,
            "0 meets the points; more bends less and misses them")
          .unit("mm")
          .at_least(0),
      Field("no_folds", options.has_no_folds, "Raise stiffness until no cell of the grid folds"),
      Field("labels", options.labels,
            "Label volume for --rigid, where the vectors begin: at TO, or for material at FROM")
          .shown_as("FILE"),
      Field("rigid_width", options.width_mm,
            "Distance from rigid labels at which half of the rest of the motion acts")
          .unit("mm")
          .positive(),
  };
}

/// A pair per row, in the order of the files.
Landmarks read_landmarks(const FitOptions& options) {
  const PointFile first = read_point_file(options.points.front());
  std::optional<PointFile> second;
  if (options.points.size() == 2) second = read_point_file(options.points[1]);
  if (!second && !first.has_displacements) {
    throw InputError({first.path, "columns", "no dx, dy, dz",
                      "a displacement of each point, or a second file of points"});
  }
  if (second && second->rows.size() != first.rows.size()) {
    throw InputError({second->path, "points", std::to_string(second->rows.size()),
                      std::to_string(first.rows.size()) + " as in " + first.path});
  }
  Landmarks landmarks;
  for (std::size_t n = 0; n < first.rows.size(); ++n) {
    const Vec3d from = first.rows[n].at_lps_mm;
    const Vec3d to = second ? second->rows[n].at_lps_mm : from + first.rows[n].by_lps_mm;
    const bool is_forward = options.direction == WarpDirection::material;
    landmarks.points.push_back(is_forward ? from : to);
    landmarks.vectors.push_back(is_forward ? to - from : from - to);
  }
  return landmarks;
}

std::shared_ptr<const RigidRegions> read_regions(const FitOptions& options,
                                                 const Landmarks& landmarks, Console& console) {
  if (options.rigid.empty()) return nullptr;
  const StoredLabels labels(*open_volume(options.labels, {}, &console), &console);
  const RegionLabels regions{labels.geometry(), [&](const Vec3i& voxel) {
                               const Vec3d place = labels.geometry().world_from_index(Vec3d(voxel));
                               return std::int32_t(labels.label_at(place));
                             }};
  try {
    return std::make_shared<RigidRegions>(
        regions, std::vector<std::int32_t>(options.rigid.begin(), options.rigid.end()),
        landmarks.points, landmarks.vectors, options.width_mm);
  } catch (const InputError& error) {
    rethrow_at(options.labels, error);
  }
}

UnfoldedMap fit(const FitOptions& options, const Geometry& grid, Console& console) {
  const Landmarks landmarks = read_landmarks(options);
  const auto regions = read_regions(options, landmarks, console);
  try {
    if (!options.has_no_folds) {
      return {LandmarkMap(landmarks, regions, options.stiffness_mm), options.stiffness_mm};
    }
    console.stage("looking for the least stiffness without folds");
    return without_folds(landmarks, regions, options.stiffness_mm, grid, &console);
  } catch (const InputError& error) {
    rethrow_at(options.points.front(), error);
  }
}

void check_options(const FitOptions& options) {
  if (options.grid.file.empty()) {
    throw UsageError("--grid: found none, expected a volume whose grid to take");
  }
  if (options.rigid.empty() != options.labels.empty()) {
    throw UsageError("--rigid and --labels: found one of them, expected both or none");
  }
}

int run_fit(const FitOptions& options, const GlobalOptions& global, Console& console) {
  check_options(options);
  OutputPlan plan(global.force);
  for (const std::string& points : options.points) plan.protect(points);
  plan.protect(options.grid.file);
  if (!options.labels.empty()) plan.protect(options.labels);
  plan.add_dense(options.output);
  console.claim(plan.files());
  const Geometry grid = choose_grid(*grid_of_file(options.grid), options.grid);
  const UnfoldedMap found = fit(options, grid, console);
  GridFolds folds(grid);
  const VectorSliceSource slices = counted(found.map.slices(grid), folds);
  warn_of_all(
      options.output,
      write_warp(options.output, {grid, options.direction}, slices, &console, options.write),
      &console);
  if (folds.folded_cells() > 0) {
    console.warn(options.output + ": " + with_count(folds.folded_cells(), "cell") +
                 " folded, smallest det F " + number_text(folds.smallest_det()) +
                 "; --no-folds or --stiffness avoid that");
  }
  const LandmarkMisfit misfit = found.map.misfit();
  if (global.json) {
    const Value report = {{"output", options.output},
                          {"stiffness_mm", found.stiffness_mm},
                          {"misfit_rms_mm", misfit.rms_mm},
                          {"misfit_max_mm", misfit.largest_mm},
                          {"folded_cells", folds.folded_cells()},
                          {"smallest_det_f", folds.smallest_det()}};
    std::printf("%s\n", json_text(report, 2).c_str());
  } else if (!global.quiet) {
    std::printf(
        "stiffness %.4g mm, points missed by %.3g mm (RMS), %.3g mm at most, %lld folded cells, "
        "smallest det F %.4g\n",
        found.stiffness_mm, misfit.rms_mm, misfit.largest_mm,
        static_cast<long long>(folds.folded_cells()), folds.smallest_det());
  }
  return kOk;
}

}  // namespace

Command add_fit(CLI::App& program) {
  auto options = std::make_shared<FitOptions>();
  CLI::App* app = add_subcommand(
      program, "fit", "Warp through pairs of landmarks: a thin-plate spline, with rigid labels",
      "  supple fit --points before.csv after.csv --grid head.nhdr -o warp.nrrd\n"
      "  supple fit --points F.mrk.json T.mrk.json --no-folds --grid ct.nii.gz -o warp.h5\n"
      "  supple fit --points a.fcsv b.fcsv --labels bones.nrrd --rigid 1,2 --grid ct.nhdr "
      "-o warp.nrrd");
  app->add_option("--points", options->points,
                  "Landmarks before and after, pair by pair: CSV, .fcsv or .mrk.json, LPS mm; or "
                  "one CSV with columns dx, dy, dz")
      ->required()
      ->expected(1, 2)
      ->option_text("FROM [TO]");
  app->add_option("-o,--output", options->output, "Warp to write; its extension chooses the format")
      ->required()
      ->option_text("FIELD");
  add_field_options(*app, fields(*options));
  app->add_option("--rigid", options->rigid,
                  "Labels that move as rigid bodies, each by three landmarks in it or more")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->option_text("N,N,…");
  add_field_options(*app, fields(options->grid));
  add_field_options(*app, fields(options->write));
  add_field_options(*app, vector_fields(options->write));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_fit(*options, global, console);
          }};
}

}  // namespace supple::tools

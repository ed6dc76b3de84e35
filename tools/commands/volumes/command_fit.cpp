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
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/landmark_fit.h"
#include "volumes/io/point_file.h"
#include "volumes/io/volume_writer.h"

namespace supple::tools {

namespace {

struct FitOptions {
  std::vector<std::string> points;
  std::string output;
  LandmarkFit fit;
  GridChoice grid;
  WriteOptions write;
};

/// A map through the pairs, one per row, in the order of the files.
UnfoldedMap fit(const FitOptions& options, const Geometry& grid, Console& console) {
  PointFile pairs = read_point_file(options.points.front());
  if (options.points.size() == 2) {
    pairs = led_to(std::move(pairs), read_point_file(options.points[1]));
  }
  if (!pairs.has_displacements) {
    throw InputError({pairs.path, "columns", "no dx, dy, dz",
                      "a displacement of each point, or a second file of points"});
  }
  std::vector<Vec3d> from, to;
  for (const PointFile::Row& row : pairs.rows) {
    from.push_back(row.at_lps_mm);
    to.push_back(row.at_lps_mm + row.by_lps_mm);
  }
  try {
    return fit_landmarks(options.fit, from, to, grid, &console);
  } catch (const InputError& error) {
    rethrow_at(pairs.path, error);
  }
}

int run_fit(const FitOptions& options, const GlobalOptions& global, Console& console) {
  if (options.grid.file.empty()) {
    throw UsageError("--grid: found none, expected a volume whose grid to take");
  }
  OutputPlan plan(global.force);
  for (const std::string& points : options.points) plan.protect(points);
  plan.protect(options.grid.file);
  if (!options.fit.labels.empty()) plan.protect(options.fit.labels);
  plan.add_dense(options.output);
  console.claim(plan.files());
  const Geometry grid = choose_grid(*grid_of_file(options.grid), options.grid);
  const UnfoldedMap found = fit(options, grid, console);
  GridFolds folds(grid);
  const VectorSliceSource slices = counted(found.map.slices(grid), folds);
  warn_of_all(
      options.output,
      write_warp(options.output, {grid, options.fit.direction}, slices, &console, options.write),
      &console);
  if (folds.folded_cells() > 0) {
    console.warn(options.output + ": " + with_count(folds.folded_cells(), "cell") +
                 " folded, smallest det F " + number_text(folds.smallest_det()) +
                 "; --no-folds or --stiffness avoid that");
  }
  if (global.json) {
    Value report = to_value(found, folds);
    report["output"] = options.output;
    std::printf("%s\n", json_text(report, 2).c_str());
  } else if (!global.quiet) {
    const LandmarkMisfit misfit = found.map.misfit();
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
  add_field_options(*app, fields(options->fit));
  app->add_option("--rigid", options->fit.rigid,
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

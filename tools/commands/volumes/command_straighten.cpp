// supple straighten: the tube around a curve as a straight box, and the warp that does it.
#include <cstdio>

#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/run/converted.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/json.h"
#include "volumes/field/centreline/straight_grid.h"
#include "volumes/io/filter/on_grid.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/point_file.h"
#include "volumes/io/volume_writer.h"

namespace supple::tools {

namespace {

struct StraightenOptions {
  std::string input, along, output, warp;
  Straightening box;
  ResampleKernel interpolation = ResampleKernel::linear;
  ReadOptions read;
  WriteOptions write;
};

StraightGrid straight_grid(const StraightenOptions& options) {
  const PointFile points = read_point_file(options.along);
  std::vector<Vec3d> places;
  for (const PointFile::Row& row : points.rows) places.push_back(row.at_lps_mm);
  const Vec3d mm = open_volume(options.input, options.read)->header().geometry.spacing_mm();
  try {
    return StraightGrid(places, options.box, std::min({mm.x, mm.y, mm.z}));
  } catch (const InputError& error) {
    rethrow_at(options.along, error);
  }
}

int run_straighten(const StraightenOptions& options, const GlobalOptions& global,
                   Console& console) {
  OutputPlan plan(global.force);
  plan.protect(options.input, options.read);
  plan.protect(options.along);
  plan.add_dense(options.output);
  if (!options.warp.empty()) plan.add_dense(options.warp);
  console.claim(plan.files());
  const StraightGrid straight = straight_grid(options);
  const VectorSliceSource slices = straight.slices();
  const GridFolds folds = folds_of(straight.grid(), slices, &console);
  if (folds.folded_cells() > 0) {
    console.warn(options.along + ": " + folds_text(straight, folds) + " (--radius, --no-folds)");
  }
  const auto open = [&] {
    return on_grid(open_volume(options.input, options.read), straight.grid(), slices,
                   options.interpolation, &console);
  };
  write_converted(open, options.output, options.write, console);
  if (!options.warp.empty()) {
    warn_of_all(options.warp,
                write_warp(options.warp, {straight.grid()}, slices, &console, options.write),
                &console);
  }
  if (global.json) {
    Value report = to_value(straight, folds);
    report["output"] = options.output;
    std::printf("%s\n", json_text(report, 2).c_str());
  } else if (!global.quiet) {
    std::printf(
        "%.4g mm along the curve, %.4g mm to each side, %lld folded cells, smallest det F "
        "%.4g\n",
        straight.curve().length_mm(), straight.radius_mm(),
        static_cast<long long>(folds.folded_cells()), folds.smallest_det());
  }
  return kOk;
}

}  // namespace

Command add_straighten(CLI::App& program) {
  auto options = std::make_shared<StraightenOptions>();
  CLI::App* app = add_subcommand(
      program, "straighten", "Straighten a volume along a curve: curved planar reformat",
      "  supple straighten ct.nhdr --along arch.mrk.json --radius 10 --height 30 -o teeth.nrrd\n"
      "  supple straighten ct.nii.gz --along vessel.csv --warp warp.h5 -o vessel.nii.gz\n"
      "  supple straighten labels.nrrd --along vessel.csv --interpolation nearest -o "
      "straight.nrrd");
  app->add_option("input", options->input, "A volume")->required()->option_text("VOLUME");
  app->add_option("--along", options->along,
                  "Points along the curve, in order: CSV, .fcsv or .mrk.json, LPS mm")
      ->required()
      ->option_text("POINTS");
  app->add_option("-o,--output", options->output,
                  "Straight volume to write: i along the curve, k up")
      ->required()
      ->option_text("VOLUME");
  app->add_option("--warp", options->warp,
                  "Warp to write, from the straight box to the curve (resample direction)")
      ->option_text("FIELD");
  add_field_options(*app, fields(options->box));
  add_field_options(*app, {Field("interpolation", options->interpolation, {"linear", "nearest"},
                                 "Densities between voxels; nearest is for labels")});
  for (const Field& field : fields(options->read)) {
    // --spacing is that of the result here.
    if (field.name() != "spacing") add_field_options(*app, {field});
  }
  add_field_options(*app, fields(options->write));
  add_field_options(*app, vector_fields(options->write));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_straighten(*options, global, console);
          }};
}

}  // namespace supple::tools

// supple resample: the deformed volume on a grid, for those who do want it resampled; or a volume
// with other voxel sizes or on another grid.
#include "lib/state/state_outputs.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/result_lines.h"
#include "tools/scene/file/offset_functions.h"
#include "tools/scene/plan/memory_need.h"
#include "tools/scene/run/converted.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/io/filter/on_grid.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

namespace {

struct ResampleOptions {
  std::string input, output, path;
  GridChoice grid;
  std::optional<Vec3d> spacing_mm;
  std::optional<double> velocity_s;
  ResampleKernel interpolation = ResampleKernel::linear;
  ReadOptions read;
  WriteOptions write;
};

Fields voxel_fields(ResampleOptions& options) {
  return {
      Field("spacing", options.spacing_mm, "Of a volume: voxel size of the result").unit("mm"),
      Field("interpolation", options.interpolation, {"linear", "nearest", "cubic"},
            "Densities between voxels; nearest (of a volume) is for labels, cubic an interpolating "
            "B-spline"),
      Field("velocity", options.velocity_s,
            "Of a state, OpenVDB: a grid v for motion blur, as if it had moved within this time")
          .unit("s")
          .positive(),
  };
}

int resample_volume(const ResampleOptions& options, const GlobalOptions& global, Console& console) {
  const bool has_grid = !options.grid.file.empty() || options.grid.margin_mm > 0;
  if (has_grid == options.spacing_mm.has_value()) {
    open_volume(options.input, options.read);  // what cannot be read is named first
    throw UsageError(has_grid ? "resample: found --spacing beside --grid or --margin, expected one"
                              : "resample: found a volume alone, expected --spacing or --grid, or "
                                "a state");
  }
  if (!options.path.empty() || options.velocity_s) {
    throw UsageError(std::string("resample: found ") +
                     (options.path.empty() ? "--velocity" : "--path") +
                     " for a volume, expected a state");
  }
  OutputPlan plan(global.force);
  plan.protect(options.input, options.read);
  if (!options.grid.file.empty()) plan.protect(options.grid.file);
  plan.add_dense(options.output);
  console.claim(plan.files());
  const auto open = [&] {
    auto file = open_volume(options.input, options.read);
    if (!has_grid) return with_spacing(std::move(file), *options.spacing_mm, options.interpolation);
    const Geometry& own = file->header().geometry;
    const Geometry grid = choose_grid(own, options.grid);
    require_memory(options.input, on_grid_bytes(own), "another grid",
                   "a box of the volume (supple crop) or larger voxels before (supple resample "
                   "--spacing, which reads slice by slice) need less");
    return on_grid(std::move(file), grid, options.interpolation, &console);
  };
  write_converted(open, options.output, options.write, console);
  return kOk;
}

int run_resample(const ResampleOptions& options, const GlobalOptions& global, Console& console) {
  if (!is_state_file(options.input)) return resample_volume(options, global, console);
  if (options.spacing_mm) {
    throw UsageError("resample: found --spacing for a state, expected --grid or --margin");
  }
  if (options.interpolation == ResampleKernel::nearest) {
    throw UsageError(
        "resample: found --interpolation nearest for a state, expected linear or cubic");
  }
  require_unused(options.read, options.input);
  OutputPlan plan(global.force);
  plan.protect(options.input);
  if (!options.grid.file.empty()) plan.protect(options.grid.file);
  plan.add_dense(options.output);
  console.claim(plan.files());
  const auto functions = read_path_file(options.path, console);
  const State state = read_state(options.input, &console);
  const Pose deformed = invert_and_send_along(state, functions, console);
  const Geometry grid = choose_grid(state.geometry, options.grid);
  const std::int64_t lost = write_resampled(
      options.output, state, deformed, grid, options.write, &console,
      options.interpolation == ResampleKernel::cubic, options.velocity_s.value_or(0));
  if (global.json) {
    print_dense_report(options.output, grid, lost, deformed.offsets.certificate);
  }
  return kOk;
}

}  // namespace

Command add_resample(CLI::App& program) {
  auto options = std::make_shared<ResampleOptions>();
  CLI::App* app =
      add_subcommand(program, "resample",
                     "Write the deformed volume on a regular grid, or any volume on another grid",
                     "  supple resample drag.vdb --grid atlas.nii.gz -o on_atlas.nrrd\n"
                     "  supple resample head.nii.gz --spacing 1,1,1 -o cubes.nrrd\n"
                     "  supple resample mr.nii.gz --grid ct.nhdr -o mr_on_ct.nrrd");
  app->add_option("input", options->input, "A state file or a volume")
      ->required()
      ->option_text("IN");
  app->add_option("-o,--output", options->output,
                  "Volume to write; its extension chooses the format")
      ->required()
      ->option_text("VOLUME");
  add_field_options(*app, {path_file_field(options->path)});
  for (const Field& field : fields(options->read)) {
    // --spacing is that of the result here.
    if (field.name() != "spacing") add_field_options(*app, {field});
  }
  add_field_options(*app, fields(options->write));
  add_field_options(*app, fog_fields(options->write));
  add_field_options(*app, fields(options->grid));
  add_field_options(*app, voxel_fields(*options));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_resample(*options, global, console);
          }};
}

}  // namespace supple::tools

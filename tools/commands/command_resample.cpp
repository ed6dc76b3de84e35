// supple resample: the deformed volume on a grid, for those who do want it resampled.
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/outputs/output_plan.h"
#include "tools/outputs/reports.h"
#include "tools/scene/offset_functions.h"
#include "volumes/state/state_outputs.h"

namespace supple::tools {

namespace {

struct ResampleOptions {
  std::string input, output, path;
  GridChoice grid;
  WriteOptions write;
};

int run_resample(const ResampleOptions& options, const GlobalOptions& global, Console& console) {
  OutputPlan plan(global);
  plan.protect(options.input);
  if (!options.grid.file.empty()) plan.protect(options.grid.file);
  plan.add_dense(options.output);
  console.claim(plan.files());
  const auto functions = read_path_file(options.path, console);
  const State state = read_state(options.input, &console);
  const Pose deformed = invert_and_send_along(state, functions, console);
  const Geometry grid = choose_grid(state.geometry, options.grid);
  const std::int64_t lost =
      write_resampled(options.output, state, deformed, grid, options.write, &console);
  if (global.json) {
    print_dense_report(options.output, grid, lost, deformed.offsets.certificate);
  }
  return kOk;
}

}  // namespace

Command add_resample(CLI::App& program) {
  auto options = std::make_shared<ResampleOptions>();
  CLI::App* app = add_subcommand(program, "resample", "Write the deformed volume on a regular grid",
                                 "  supple resample drag.vdb -o deformed.nrrd\n"
                                 "  supple resample drag.vdb --grid atlas.nii.gz -o on_atlas.nrrd\n"
                                 "  supple resample drag.vdb --margin 20 -o whole.mha");
  app->add_option("state", options->input, "A state file")->required()->option_text("STATE.vdb");
  app->add_option("-o,--output", options->output,
                  "Volume to write; its extension chooses the format")
      ->required()
      ->option_text("VOLUME");
  add_field_options(*app, {path_file_field(options->path)});
  add_field_options(*app, fields(options->write));
  add_field_options(*app, fields(options->grid));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_resample(*options, global, console);
          }};
}

}  // namespace supple::tools

// supple compose: several transforms as one warp.
#include "lib/state/state_outputs.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/run/converted.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/io/transform/transform_volume.h"
#include "volumes/io/warp_file.h"

namespace supple::tools {

namespace {

struct ComposeOptions {
  std::vector<std::string> inputs;
  std::string output;
  GridChoice grid;
  WriteOptions write;
};

TransformChain read_all(const ComposeOptions& options, Console& console) {
  std::vector<TransformChain> chains;
  const auto grid = grid_of_file(options.grid);
  for (const std::string& input : options.inputs) {
    chains.push_back(read_transform(input, &console, grid ? &*grid : nullptr));
  }
  return compose(std::move(chains));
}

Geometry grid_of(const ComposeOptions& options, const TransformChain& chain) {
  if (const auto of_file = grid_of_file(options.grid)) return choose_grid(*of_file, options.grid);
  if (chain.grid) return choose_grid(*chain.grid, options.grid);
  throw UsageError("--grid: found transforms of all space, expected a volume whose grid to take");
}

int run_compose(const ComposeOptions& options, const GlobalOptions& global, Console& console) {
  OutputPlan plan(global.force);
  for (const std::string& input : options.inputs) plan.protect(input);
  if (!options.grid.file.empty()) plan.protect(options.grid.file);
  plan.add_dense(options.output);
  console.claim(plan.files());
  const VolumeOpener open = [&] {
    TransformChain chain = read_all(options, console);
    const Geometry grid = grid_of(options, chain);
    return transform_volume(options.inputs.front(), grid, std::move(chain));
  };
  write_converted(open, options.output, options.write, console);
  return kOk;
}

}  // namespace

Command add_compose(CLI::App& program) {
  auto options = std::make_shared<ComposeOptions>();
  CLI::App* app = add_subcommand(
      program, "compose", "Write several transforms or warps as one, the last applied first",
      "  supple compose 1Warp.nii.gz 0Affine.tfm -o all.nii.gz\n"
      "  supple compose TransformParameters.0.txt rigid.tfm --grid head.nhdr -o all.nrrd");
  app->add_option("inputs", options->inputs,
                  "Transforms of ITK, ANTs and elastix, and warps of any format, in the order of "
                  "ANTs' -t: points go through the last first")
      ->required()
      ->option_text("TRANSFORM...");
  app->add_option("-o,--output", options->output, "Warp to write; its extension chooses the format")
      ->required()
      ->option_text("FIELD");
  add_field_options(*app, fields(options->grid));
  add_field_options(*app, fields(options->write));
  add_field_options(*app, vector_fields(options->write));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_compose(*options, global, console);
          }};
}

}  // namespace supple::tools

// supple slice: axial, coronal and sagittal slices of a volume or a deformed state.
#include "tools/console/command.h"
#include "tools/console/parse.h"
#include "tools/console/read_options.h"
#include "tools/outputs/output_plan.h"
#include "tools/outputs/outputs.h"
#include "tools/scene/offset_functions.h"
#include "tools/scene/slice_view.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

namespace supple::tools {

namespace {

struct SliceOptions {
  std::string input, offset, at, window, output;
  ReadOptions read;
  std::string plane = "all";
  double scale = 2;
  bool undeformed = false;
  bool no_outline = false;
};

/// What is cut: densities on a grid, moved or not.
struct SlicedInput {
  Geometry geometry;
  DensityGrid density;
  BrickTopology rest;  // outlined; empty for a volume
  std::optional<OffsetField> offsets;
};

SlicedInput open_source(const SliceOptions& options, Console& console) {
  const auto functions = read_offset_file(options.offset);
  if (is_state_file(options.input)) {
    State state = read_state(options.input, &console);
    SlicedInput source{state.geometry, state.density, {}, {}};
    if (!options.undeformed) {
      source.offsets = invert_and_send_along(state, functions, console).offsets;
    } else if (!functions.empty()) {
      source.offsets =
          send_along(functions, state.geometry, state.density.bricks(), console).offsets;
    }
    source.rest = std::move(state.elements);
    return source;
  }
  if (options.undeformed) {
    throw UsageError("--undeformed: found a volume, expected a state file");
  }
  Volume volume = load_volume(*open_volume(options.input, options.read, &console), &console);
  SlicedInput source{volume.geometry, std::move(volume.density), {}, {}};
  if (!functions.empty()) {
    source.offsets =
        send_along(functions, source.geometry, source.density.bricks(), console).offsets;
  }
  return source;
}

SliceChoice to_choice(const SliceOptions& options) {
  SliceChoice choice;
  choice.plane = options.plane;
  choice.scale = options.scale;
  choice.outline = !options.no_outline;
  if (!options.at.empty()) choice.at = parse_vector("--at", options.at);
  if (!options.window.empty()) {
    double lo = 0, hi = 0;
    parse_range("--window", options.window, lo, hi);
    choice.window = {lo, hi};
  }
  return choice;
}

int run_slice(const SliceOptions& options, const GlobalOptions& global, Console& console) {
  require_within("--scale", options.scale, 0.01, 64);
  OutputPlan plan(global);
  plan.protect(options.input);
  plan.add_image(options.output);
  const SlicedInput source = open_source(options, console);
  const SliceSource cut{source.geometry, source.density, &source.rest,
                        source.offsets ? &*source.offsets : nullptr};
  const SliceChoice choice = effective_slice(to_choice(options), cut);
  write_png(options.output, draw_slices(cut, choice), describe_slice(choice, !options.undeformed));
  return kOk;
}

}  // namespace

Command add_slice(CLI::App& program) {
  auto options = std::make_shared<SliceOptions>();
  CLI::App* app = add_subcommand(
      program, "slice", "Axial, coronal and sagittal slices of a volume or a deformed state",
      "  supple slice drag.vdb -o slices.png\n"
      "  supple slice drag.vdb --at 128,200,12 --plane sagittal --window -1000,1000 -o bone.png\n"
      "  supple slice head.nii.gz --scale 4 -o head.png");
  app->add_option("input", options->input, "A volume or a state")
      ->required()
      ->option_text("VOLUME|STATE.vdb");
  add_read_options(*app, options->read);
  add_offset_option(*app, options->offset);
  app->add_option("--at", options->at, "Voxel that the slices pass through (default: the middle)")
      ->option_text("I,J,K");
  app->add_option("--plane", options->plane, "axial, coronal, sagittal, or all of them (default)")
      ->check(CLI::IsMember({"axial", "coronal", "sagittal", "all"}))
      ->option_text("PLANE");
  app->add_option("--window", options->window,
                  "Densities that are black and white (default: soft tissue with HU, else all)")
      ->option_text("LO,HI");
  app->add_option("--scale", options->scale, "Pixels per voxel of the smallest spacing (default 2)")
      ->option_text("N");
  app->add_flag("--undeformed", options->undeformed, "Show a state's body at rest");
  app->add_flag("--no-outline", options->no_outline, "Without the outline of the body at rest");
  app->add_option("-o,--output", options->output, "Picture to write")
      ->required()
      ->option_text("IMAGE.png");
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_slice(*options, global, console);
          }};
}

}  // namespace supple::tools

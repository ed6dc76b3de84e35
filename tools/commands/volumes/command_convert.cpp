// supple convert: a volume or warp in another format, values and geometry as they are; a state that
// refers to its volume with everything that it needs.
#include <filesystem>

#include "lib/state/pose.h"
#include "lib/state/state_source.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/run/converted.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/io/format/data_files.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

namespace {

struct ConvertOptions {
  std::string input, output;
  bool refer = false;
  ReadOptions read;
  WriteOptions write;
};

VolumeOpener opener_of(const ConvertOptions& options) {
  return [options] {
    auto file = open_scalars_or_vectors(options.input, options.read);
    if (file->header().components != 3) require_scalars(file->header());
    return file;
  };
}

/// True if a name has a place for a number, %d or %02d.
bool has_number(const std::string& name) {
  const std::size_t percent = name.find('%');
  if (percent == std::string::npos) return false;
  const std::size_t letter = name.find_first_not_of("0123456789", percent + 1);
  return letter != std::string::npos && name[letter] == 'd';
}

/// One output per frame where the name of the output has a place for its number.
std::vector<ConvertOptions> frames_of(const ConvertOptions& options) {
  std::vector<ConvertOptions> each;
  if (options.read.frame || !has_number(options.output)) return {options};
  std::int64_t frames = 1;
  ReadOptions read = options.read;
  read.frames_found = &frames;
  open_scalars_or_vectors(options.input, read);
  const NumberedFiles names({options.output, "output", options.output}, options.output, 0,
                            frames - 1, 1);
  for (int frame = 0; frame < frames; ++frame) {
    each.push_back(options);
    each.back().output = names.name(frame);
    if (frames > 1) each.back().read.frame = frame;
  }
  return each;
}

/// Writes a state anew: with everything that it needs, or referring to its source from its new
/// place.
int convert_state(const ConvertOptions& options, const GlobalOptions& global, Console& console) {
  require_unused(options.read, options.input);
  OutputPlan plan(global.force);
  plan.protect(options.input);
  plan.add_state(options.output);
  console.claim(plan.files());
  State state = read_state(options.input, &console);
  if (!options.refer) {
    state.source.reset();
  } else if (!state.source) {
    throw InputError({options.input, "--refer", "a state that holds its densities",
                      "a state that refers to a volume"});
  }
  write_state(options.output, state, invert_state(state, &console).offsets, &console);
  return kOk;
}

int run_convert(const ConvertOptions& options, const GlobalOptions& global, Console& console) {
  const bool is_vdb = std::filesystem::path(options.output).extension() == ".vdb";
  if (is_vdb && is_state_file(options.input)) return convert_state(options, global, console);
  if (options.refer) {
    throw InputError({options.input, "--refer", "no state, or another format to be written",
                      "a state that refers to a volume, and STATE.vdb"});
  }
  const std::vector<ConvertOptions> each = frames_of(options);
  OutputPlan plan(global.force);
  plan.protect(options.input, options.read);
  for (const ConvertOptions& one : each) plan.add_dense(one.output);
  console.claim(plan.files());
  for (const ConvertOptions& one : each) {
    write_converted(opener_of(one), one.output, one.write, console);
  }
  return kOk;
}

}  // namespace

Command add_convert(CLI::App& program) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* app = add_subcommand(program, "convert", "Write a volume or warp in another format",
                                 "  supple convert dicom_folder head.vdb\n"
                                 "  supple convert heart_ct phase_%02d.nrrd\n"
                                 "  supple convert referring.vdb whole.vdb");
  app->add_option("input", options->input, "A volume, a folder of slices, a warp, or a state")
      ->required()
      ->option_text("IN");
  app->add_option(
         "output", options->output,
         "File to write; its extension chooses the format; with %d or %02d one file per frame")
      ->required()
      ->option_text("OUT");
  app->add_flag(
      "--refer", options->refer,
      "Of a state that refers to its volume: go on referring, from the new place; without "
      "it the volume's densities are written, too");
  add_field_options(*app, fields(options->read));
  add_field_options(*app, fields(options->write));
  add_field_options(*app, fog_fields(options->write));
  add_field_options(*app, vector_fields(options->write));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_convert(*options, global, console);
          }};
}

}  // namespace supple::tools

// supple convert: a volume or warp in another format, values and geometry as they are.
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/outputs/converted.h"
#include "tools/outputs/output_plan.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/open_volume.h"

namespace supple::tools {

namespace {

struct ConvertOptions {
  std::string input, output;
  ReadOptions read;
  WriteOptions write;
};

int run_convert(const ConvertOptions& options, const GlobalOptions& global, Console& console) {
  OutputPlan plan(global);
  plan.protect(options.input, options.read);
  plan.add_dense(options.output);
  console.claim(plan.files());
  const VolumeOpener open = [&] {
    auto file = open_scalars_or_vectors(options.input, options.read);
    if (file->header().components != 3) require_scalars(file->header());
    return file;
  };
  write_converted(open, options.output, options.write, console);
  return kOk;
}

}  // namespace

Command add_convert(CLI::App& program) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* app = add_subcommand(program, "convert", "Write a volume or warp in another format",
                                 "  supple convert scan.nii.gz scan.nrrd\n"
                                 "  supple convert dicom_folder head.vdb\n"
                                 "  supple convert 1Warp.nii.gz warp.h5");
  app->add_option("input", options->input, "A volume, a folder of slices, or a warp")
      ->required()
      ->option_text("IN");
  app->add_option("output", options->output, "File to write; its extension chooses the format")
      ->required()
      ->option_text("OUT");
  add_field_options(*app, fields(options->read));
  add_field_options(*app, fields(options->write));
  add_field_options(*app, vector_fields(options->write));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_convert(*options, global, console);
          }};
}

}  // namespace supple::tools

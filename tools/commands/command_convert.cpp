// supple convert: a volume or warp in another format, values and geometry as they are.
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/outputs/output_plan.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/load/convert.h"
#include "volumes/io/load/load.h"
#include "volumes/io/open_volume.h"
#include "volumes/state/state_outputs.h"

namespace supple::tools {

namespace {

struct ConvertOptions {
  std::string input, output;
  ReadOptions read;
  WriteOptions write;
};

/// Scaled integers need to know how far they reach; this reads the file once more.
ConvertPlan plan_for(const ConvertOptions& options, const VolumeHeader& header, Console& console) {
  const bool is_scaled = header.slope != 1 || header.intercept != 0;
  if (header.components > 1 || !is_scaled || keeps_scaling(options.output)) {
    return plan_conversion(header, options.output, 0, 0);
  }
  const auto file = open_volume(options.input, options.read);
  const VolumeStatistics statistics = digest_volume(*file, &console).statistics;
  return plan_conversion(header, options.output, statistics.min, statistics.max);
}

int run_convert(const ConvertOptions& options, const GlobalOptions& global, Console& console) {
  OutputPlan plan(global);
  plan.protect(options.input, options.read);
  plan.add_dense(options.output);
  console.claim(plan.files());
  const auto file = open_scalars_or_vectors(options.input, options.read);
  const VolumeHeader& header = file->header();
  if (header.components != 3) require_scalars(header);
  warn_of_all(options.input, header.warnings, &console);
  const ConvertPlan conversion = plan_for(options, header, console);
  warn_of_all(options.output, convert(*file, conversion, options.output, options.write, &console),
              &console);
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

// supple invert: the inverse of any warp file, with a certificate of how well it inverts.
#include <cstdio>

#include "lib/state/state_outputs.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/result_lines.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/json.h"
#include "volumes/field/dense/invert_warp.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

namespace supple::tools {

namespace {

struct InvertOptions {
  std::string input, output, direction;
  VoidMode void_mode = VoidMode::extend;
  GridChoice grid;
  WriteOptions write;
};

Fields fields(InvertOptions& options) {
  return {
      Field("direction", options.direction,
            "How the result is recorded: the input's direction means the inverse deformation, the "
            "other one the same deformation")
          .one_of({"resample", "material"})
          .otherwise("the input's"),
      Field("void", options.void_mode, {"nearest", "outside", "extend"},
            "Where the inverse is not defined: extend, outside, or nearest (0)"),
  };
}

/// Direction of the inverse: by default that of the input, so that programs that apply the one
/// apply the other the same way.
WarpDirection direction_of(const InvertOptions& options, const Warp& warp) {
  if (options.direction == "resample") return WarpDirection::resample;
  if (options.direction == "material") return WarpDirection::material;
  return warp.direction.value_or(WarpDirection::resample);
}

void warn_of(const InversionCertificate& certificate, std::int64_t uncovered,
             const std::string& path, Console& console) {
  if (certificate.folded_cells > 0) {
    console.warn(path + ": " + with_count(certificate.folded_cells, "cell") +
                 " folded, smallest det F " + number_text(certificate.min_det) +
                 "; ties go to the shortest vector");
  }
  if (certificate.unresolved_voxels > 0) {
    console.warn(path + ": " + with_count(certificate.unresolved_voxels, "voxel") +
                 " could not be inverted");
  }
  if (uncovered > 0) {
    console.note(path + ": " + with_count(uncovered, "grid point") +
                 " of the output that no point of the warp's grid reaches (--void says what they "
                 "hold)");
  }
}

int run_invert(const InvertOptions& options, const GlobalOptions& global, Console& console) {
  OutputPlan plan(global.force);
  plan.protect(options.input);
  if (!options.grid.file.empty()) plan.protect(options.grid.file);
  plan.add_dense(options.output);
  console.claim(plan.files());
  OffsetField inverse;
  WarpDirection direction = WarpDirection::resample;
  {
    const auto of_file = grid_of_file(options.grid);
    const Warp warp = read_warp(options.input, &console, of_file ? &*of_file : nullptr);
    direction = direction_of(options, warp);
    try {
      inverse = invert(displacement_of_warp(warp), {}, &console);
    } catch (const InputError& error) {
      rethrow_at(options.input, error);
    }
  }
  const Geometry grid = choose_grid(inverse.geometry, options.grid);
  const InversionCertificate& certificate = inverse.certificate;
  warn_of(certificate, count_uncovered(inverse, grid), options.input, console);
  const BrickTopology nothing_vacated;
  const auto slices = dense_offsets(inverse, nothing_vacated, grid, options.void_mode);
  const WarpFacts facts{grid, direction, json_text(to_value(certificate))};
  warn_of_all(options.output, write_warp(options.output, facts, slices, &console, options.write),
              &console);
  if (global.json) {
    print_dense_report(options.output, grid, 0, certificate);
  } else if (!global.quiet) {
    std::printf("residual %.3g voxel at most, %lld folded cells, smallest det F %.4g\n",
                certificate.residual_max, static_cast<long long>(certificate.folded_cells),
                certificate.min_det);
  }
  return kOk;
}

}  // namespace

Command add_invert(CLI::App& program) {
  auto options = std::make_shared<InvertOptions>();
  CLI::App* app =
      add_subcommand(program, "invert", "Invert a warp of any program, with certificate",
                     "  supple invert 1Warp.nii.gz -o 1InverseWarp.nii.gz\n"
                     "  supple invert deformationField.mhd --void outside -o inverse.nrrd\n"
                     "  supple invert warp.nrrd --direction material --json -o push.nrrd");
  app->add_option("field", options->input, "A warp file")->required()->option_text("FIELD");
  app->add_option("-o,--output", options->output, "Warp to write; its extension chooses the format")
      ->required()
      ->option_text("FIELD");
  add_field_options(*app, fields(*options));
  add_field_options(*app, fields(options->write));
  add_field_options(*app, vector_fields(options->write));
  add_field_options(*app, fields(options->grid));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_invert(*options, global, console);
          }};
}

}  // namespace supple::tools

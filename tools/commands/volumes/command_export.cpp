// supple export: the deformation of a state as a warp, or its body as a solid of hexahedra, that
// other programs read.
#include <cstdio>

#include "lib/session/fem/state_solid.h"
#include "lib/state/state_outputs.h"
#include "lib/state/state_source.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/parse.h"
#include "tools/console/result_lines.h"
#include "tools/scene/file/offset_functions.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/json.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/load/values_at.h"

namespace supple::tools {

namespace {

struct ExportOptions {
  std::string input, output, path;
  WarpDirection direction = WarpDirection::resample;
  VoidMode void_mode = VoidMode::nearest;
  GridChoice grid;
  WriteOptions write;
  std::vector<std::string> elements;  // NAME=FILE
};

Fields fields(ExportOptions& options) {
  return {
      Field("direction", options.direction, {"resample", "material"},
            "resample: out(x) = in(x + o(x)); material: voxel X moves to X + u(X)"),
      Field("void", options.void_mode, {"nearest", "outside", "extend"},
            "Where no material is: nearest void, outside the source, or extend"),
      path_file_field(options.path),
  };
}

/// Values of the elements out of a volume on the grid of the state, as deform --elements writes it.
SolidArray read_elements(const NamedFile& named, const State& state, Console& console) {
  const auto file = open_volume(named.file, {}, &console);
  require_grid(file->header(), state.geometry);
  return {named.name, 1, false, values_at(*file, voxels_of(state.elements))};
}

int export_solid(const ExportOptions& options, const GlobalOptions& global, Console& console) {
  const bool has_grid = !options.grid.file.empty() || options.grid.margin_mm != 0;
  if (has_grid || options.void_mode != VoidMode::nearest || !options.path.empty()) {
    throw UsageError("--grid, --margin, --void and --path: found " + options.output +
                     ", expected a warp (a solid is at rest, with its displacement)");
  }
  OutputPlan plan(global.force);
  plan.protect(options.input);
  std::vector<NamedFile> files;
  for (const std::string& text : options.elements) {
    files.push_back(named_file("--elements", text));
    plan.protect(files.back().file);
  }
  plan.add_files({options.output});
  console.claim(plan.files());
  const State state = read_state(options.input, &console);
  std::vector<SolidArray> more;
  for (const NamedFile& named : files) more.push_back(read_elements(named, state, console));
  const HexSolid solid = solid_of(state, options.input, std::move(more), &console);
  write_solid(options.output, solid, &console);
  if (global.json) {
    const Value json = {{"output", options.output},
                        {"points", solid.points_lps_mm.size()},
                        {"hexahedra", solid.hexahedra.size()}};
    std::printf("%s\n", json_text(json, 2).c_str());
  }
  return kOk;
}

int run_export(const ExportOptions& options, const GlobalOptions& global, Console& console) {
  if (is_solid_name(options.output)) return export_solid(options, global, console);
  if (!options.elements.empty()) {
    throw UsageError("--elements: found " + options.output + ", expected a solid (.vtu or .vtk)");
  }
  OutputPlan plan(global.force);
  plan.protect(options.input);
  if (!options.grid.file.empty()) plan.protect(options.grid.file);
  plan.add_dense(options.output);
  console.claim(plan.files());
  const bool material = options.direction == WarpDirection::material;
  const bool has_grid = !options.grid.file.empty() || options.grid.margin_mm != 0;
  if (material && (has_grid || options.void_mode != VoidMode::nearest)) {
    throw UsageError(
        "--grid, --margin and --void: found with --direction material, expected "
        "--direction resample (a material field lives on the source grid)");
  }
  const auto functions = read_path_file(options.path, console);
  const State state = read_reachable_state(options.input, &console);
  if (lacks_source(state) && (!options.path.empty() || options.void_mode != VoidMode::nearest)) {
    throw InputError({options.input, options.path.empty() ? "--void" : "--path",
                      "a state without the volume that it refers to",
                      "the volume, as tissue that did not move counts here"});
  }
  const Pose deformed = invert_and_send_along(state, functions, console);
  const Geometry grid = choose_grid(state.geometry, options.grid);
  const std::int64_t lost =
      write_state_warp({options.output, options.direction, options.void_mode, grid, options.write},
                       state, deformed, &console);
  if (global.json) {
    print_dense_report(options.output, grid, lost, deformed.offsets.certificate);
  }
  return kOk;
}

}  // namespace

Command add_export(CLI::App& program) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* app =
      add_subcommand(program, "export",
                     "Write a state's deformation as a warp for ITK, elastix, Slicer, ANTs, or its "
                     "body as a solid "
                     "for ParaView, SOFA, FEBio",
                     "  supple export drag.vdb --margin 20 --void outside -o warp.mha\n"
                     "  supple export drag.vdb --elements von_mises=stress.nrrd -o body.vtu\n"
                     "  supple export drag.vdb --direction material -o push.nii.gz");
  app->add_option("state", options->input, "A state file")->required()->option_text("STATE.vdb");
  app->add_option("-o,--output", options->output,
                  "Warp or solid (.vtu, .vtk) to write; its extension chooses the format")
      ->required()
      ->option_text("FIELD|SOLID");
  app->add_option("--elements", options->elements,
                  "Solids: values of the elements out of a volume on their grid; repeatable")
      ->allow_extra_args(false)
      ->option_text("NAME=FILE");
  add_field_options(*app, fields(*options));
  add_field_options(*app, fields(options->write));
  add_field_options(*app, vector_fields(options->write));
  add_field_options(*app, fields(options->grid));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_export(*options, global, console);
          }};
}

}  // namespace supple::tools

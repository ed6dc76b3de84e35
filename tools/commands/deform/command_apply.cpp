// supple apply: points, meshes and label volumes follow a deformation, forward and back.
#include <cstdio>

#include "lib/state/state_outputs.h"
#include "tools/commands/deform/apply_labels.h"
#include "tools/commands/deform/moved_places.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/json.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/mesh/mesh_file.h"
#include "volumes/io/point_file.h"
#include "volumes/io/warp_file.h"

namespace supple::tools {

namespace {

struct ApplyOptions {
  std::string input, points, mesh, output;
  bool back = false;
  LabelOptions labels;
};

Fields fields(ApplyOptions& options) {
  return {
      Field("points", options.points,
            "Points in LPS mm: columns x,y,z, others are kept; or Slicer's .mrk.json")
          .shown_as("FILE.csv"),
      Field("mesh", options.mesh, "STL, PLY, OBJ or legacy VTK; all but places and normals is kept")
          .shown_as("FILE"),
      Field("labels", options.labels.path,
            "A label volume; takes the nearest label, 0 where no material is")
          .shown_as("FILE"),
      Field("back", options.back, "From the deformed place back to rest"),
  };
}

/// The source of a motion: a state with its displacement and, for the way back, offsets; or a warp.
struct MotionSource {
  State state;
  Pose deformed;
  Warp warp;
  bool is_warp = false;
};

/// `grid`: where a transform that names none is evaluated, unless the user says where.
MotionSource read_source(const ApplyOptions& options, bool needs_offsets, Console& console,
                         std::optional<Geometry> grid = {}) {
  const std::string& path = options.input;
  MotionSource source;
  source.is_warp = !is_state_file(path);
  if (source.is_warp) {
    if (const auto of_file = grid_of_file(options.labels.grid)) grid = of_file;
    source.warp = read_warp(path, &console, grid ? &*grid : nullptr);
    return source;
  }
  source.state = read_state(path, &console);
  if (needs_offsets) {
    source.deformed = invert_state(source.state, &console);
  } else {
    source.deformed.displacement = extended_displacement_of(source.state);
  }
  return source;
}

std::unique_ptr<PointMotion> motion_of(const MotionSource& source, bool back) {
  if (source.is_warp) return motion_through(source.warp, back);
  const CutElements body{source.state.elements, source.state.cuts};
  if (!back) return motion_along(source.deformed.displacement, body);
  return motion_to_rest(source.deformed.displacement, body, source.deformed.offsets);
}

void print(const ApplyOptions& options, const Value& report) {
  Value json = {{"output", options.output}, {"direction", options.back ? "back" : "forward"}};
  json.update(report);
  std::printf("%s\n", json_text(json, 2).c_str());
}

int apply_to_points(const ApplyOptions& options, const GlobalOptions& global, Console& console) {
  const PointFile file = read_point_file(options.points);
  const MotionSource source = read_source(options, options.back, console);
  std::vector<Vec3d> points;
  for (const PointFile::Row& row : file.rows) points.push_back(row.at_lps_mm);
  const MovedPlaces moved = move_all(*motion_of(source, options.back), points, console);
  warn_of(
      moved, source.is_warp, [&](std::size_t n) { return file.place(file.rows[n]); }, console);
  write_points_like(options.output, file, moved.positions());
  if (global.json) print(options, to_value(moved));
  return kOk;
}

int apply_to_mesh(const ApplyOptions& options, const GlobalOptions& global, Console& console) {
  const MeshFile file(options.mesh);
  const MotionSource source = read_source(options, options.back, console);
  const MovedPlaces moved =
      move_all(*motion_of(source, options.back), file.positions_lps_mm(), console);
  warn_of(
      moved, source.is_warp,
      [&](std::size_t n) { return "vertex " + std::to_string(n) + ", counted from 0"; }, console);
  const auto turned = [&](std::size_t vertex, const Vec3d& normal) {
    return product(cofactor(moved.points[vertex].gradient), normal);
  };
  file.write_moved(options.output, moved.positions(), turned);
  if (global.json) {
    Value json = to_value(moved);
    json["normals"] = file.normal_count();
    print(options, json);
  }
  return kOk;
}

int apply_to_labels(const ApplyOptions& options, const GlobalOptions& global, Console& console) {
  // A label volume takes at each of its places what is at the place that came there.
  const bool looks_back = !options.back;
  const auto file = open_volume(options.labels.path, options.labels.read, &console);
  const MotionSource source = read_source(options, looks_back, console, file->header().geometry);
  const StoredLabels labels(*file, &console);
  LabelReport report;
  if (source.is_warp) {
    report = write_labels(options.output, labels, *motion_through(source.warp, looks_back),
                          choose_grid(source.warp.geometry, options.labels.grid), console);
  } else if (looks_back) {
    report = write_labels(options.output, labels, source.deformed.offsets,
                          choose_grid(source.state.geometry, options.labels.grid), console);
  } else {
    const CutElements body{source.state.elements, source.state.cuts};
    report = write_labels(options.output, labels, *motion_along(source.deformed.displacement, body),
                          choose_grid(source.state.geometry, options.labels.grid), console);
  }
  warn_of(report, options.output, console);
  if (global.json) print(options, to_value(report));
  return kOk;
}

/// Exactly one of --points, --mesh and --labels.
void check_options(const ApplyOptions& options) {
  const bool has_labels = !options.labels.path.empty();
  const int given = !options.points.empty() + !options.mesh.empty() + has_labels;
  if (given != 1) {
    throw UsageError("apply: found " + std::to_string(given) +
                     " of --points, --mesh and --labels, expected one of them");
  }
  if (!has_labels && !options.labels.grid.file.empty() && is_state_file(options.input)) {
    throw UsageError(
        "--grid: found points or a mesh and a state, expected a label volume, or a transform that "
        "names no grid");
  }
  const ReadOptions& read = options.labels.read;
  const bool reads = !read.raw.empty() || read.frame || read.channel || read.spacing_mm;
  if (!has_labels && (options.labels.grid.margin_mm != 0 || reads)) {
    throw UsageError(
        "--margin, --raw, --frame, --channel, --spacing: found without --labels, expected a label "
        "volume");
  }
}

int run_apply(const ApplyOptions& options, const GlobalOptions& global, Console& console) {
  check_options(options);
  OutputPlan plan(global.force);
  for (const std::string* input :
       {&options.input, &options.points, &options.mesh, &options.labels.grid.file}) {
    if (!input->empty()) plan.protect(*input);
  }
  if (!options.labels.path.empty()) plan.protect(options.labels.path, options.labels.read);
  if (!options.points.empty()) {
    plan.add_like(options.output, options.points);
    console.claim(plan.files());
    return apply_to_points(options, global, console);
  }
  if (!options.mesh.empty()) {
    plan.add_like(options.output, options.mesh);
    console.claim(plan.files());
    return apply_to_mesh(options, global, console);
  }
  plan.add_dense(options.output);
  console.claim(plan.files());
  return apply_to_labels(options, global, console);
}

}  // namespace

Command add_apply(CLI::App& program) {
  auto options = std::make_shared<ApplyOptions>();
  CLI::App* app = add_subcommand(
      program, "apply", "Points, meshes and label volumes follow a deformation, forward and back",
      "  supple apply drag.vdb --points landmarks.csv -o moved.csv\n"
      "  supple apply drag.vdb --mesh tumour.ply -o moved.ply\n"
      "  supple apply warp.nrrd --back --labels drawn.nii.gz -o at_rest.nrrd");
  app->add_option("deformation", options->input,
                  "A state, or a warp; one without direction counts as resample")
      ->required()
      ->option_text("STATE.vdb|FIELD");
  app->add_option("-o,--output", options->output, "The file moved: same kind as the input")
      ->required()
      ->option_text("FILE");
  add_field_options(*app, fields(*options));
  add_field_options(*app, fields(options->labels.grid));
  add_field_options(*app, fields(options->labels.read));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_apply(*options, global, console);
          }};
}

}  // namespace supple::tools

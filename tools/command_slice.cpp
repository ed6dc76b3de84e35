// supple slice: axial, coronal and sagittal slices of a volume or a deformed state.
#include <algorithm>
#include <limits>

#include <nlohmann/json.hpp>

#include "raycast/slice.h"
#include "tools/command.h"
#include "tools/offset_functions.h"
#include "tools/output_plan.h"
#include "tools/outputs.h"
#include "tools/parse.h"
#include "tools/version.h"
#include "volumes/io/volume_file.h"

namespace supple::tools {

namespace {

/// Between the slices of a row.
constexpr int kGapPixels = 8;

/// The usual abdominal and head window: level 40, width 400.
constexpr double kSoftTissueLo = -160, kSoftTissueHi = 240;

struct Options {
  std::string input, raw_spec, offset, at, window, output;
  std::string plane = "all";
  double scale = 2;
  bool undeformed = false;
  bool no_outline = false;
};

/// What is cut: densities on a grid, moved or not.
struct Source {
  Geometry geometry;
  DensityGrid density;
  BrickTopology rest;  // outlined; empty for a volume
  std::optional<OffsetField> offsets;
};

Source open_source(const Options& options, Console& console) {
  const auto functions = read_offset_file(options.offset);
  if (is_state_file(options.input)) {
    State state = read_state(options.input, &console);
    Source source{state.geometry, state.density, {}, {}};
    if (!options.undeformed) {
      source.offsets = invert_and_send_along(state, functions, console).offsets;
    } else if (!functions.empty()) {
      source.offsets =
          send_along(functions, state.geometry, state.density.bricks(), console).offsets;
    }
    if (!options.no_outline) source.rest = std::move(state.elements);
    return source;
  }
  if (options.undeformed) {
    throw UsageError("--undeformed: found a volume, expected a state file");
  }
  Volume volume = load_volume(*open_volume(options.input, options.raw_spec), &console);
  Source source{volume.geometry, std::move(volume.density), {}, {}};
  if (!functions.empty()) {
    source.offsets =
        send_along(functions, source.geometry, source.density.bricks(), console).offsets;
  }
  return source;
}

/// The density that is seen at a place: that of where its tissue came from.
DensityAt density_of(const Source& source) {
  const float outside = source.density.background();
  if (!source.offsets) {
    return [&source, outside](const Vec3d& index) {
      return sample_trilinear(source.density, index, outside);
    };
  }
  const OffsetField& offsets = *source.offsets;
  return [&source, &offsets, outside](const Vec3d& index) {
    Vec3d offset;
    if (!offsets.sample(index, offset)) return outside;
    return sample_trilinear(source.density, index + offset, outside);
  };
}

/// Soft tissue where densities are Hounsfield units, else everything there is.
void choose_window(const Options& options, const DensityGrid& density, SliceStyle& style) {
  if (!options.window.empty()) {
    parse_range("--window", options.window, style.grey_lo, style.grey_hi);
    return;
  }
  if (density.background() < -200) {
    style.grey_lo = kSoftTissueLo;
    style.grey_hi = kSoftTissueHi;
    return;
  }
  float lo = density.background(), hi = lo;
  for (std::size_t b = 0; b < density.bricks().brick_count(); ++b) {
    const auto [least, most] =
        std::minmax_element(density.values(b), density.values(b) + kBrickVoxels);
    lo = std::min(lo, *least);
    hi = std::max(hi, *most);
  }
  style.grey_lo = lo;
  style.grey_hi = std::max(hi, lo + 1);
}

std::vector<SlicePlane> planes_of(const std::string& name) {
  if (name == "axial") return {SlicePlane::axial};
  if (name == "coronal") return {SlicePlane::coronal};
  if (name == "sagittal") return {SlicePlane::sagittal};
  return {SlicePlane::axial, SlicePlane::coronal, SlicePlane::sagittal};
}

std::string describe(const Options& options, const Vec3d& at, const SliceStyle& style) {
  const nlohmann::ordered_json json = {{"program", std::string("supple ") + kVersion},
                                       {"plane", options.plane},
                                       {"at", {at.x, at.y, at.z}},
                                       {"scale", options.scale},
                                       {"window", {style.grey_lo, style.grey_hi}},
                                       {"deformed", !options.undeformed},
                                       {"outline", style.rest != nullptr}};
  return json.dump();
}

int run(const Options& options, const GlobalOptions& global, Console& console) {
  require_within("--scale", options.scale, 0.01, 64);
  OutputPlan plan(global);
  plan.protect(options.input);
  plan.add_image(options.output);
  const Source source = open_source(options, console);
  const Vec3d at = options.at.empty() ? Vec3d((source.geometry.dims() - Vec3i(1)) / 2)
                                      : parse_vector("--at", options.at);
  SliceStyle style;
  choose_window(options, source.density, style);
  style.validate();
  if (!source.rest.empty()) style.rest = &source.rest;
  const Vec3d spacing = source.geometry.spacing_mm();
  const double pixel_mm = std::min({spacing.x, spacing.y, spacing.z}) / options.scale;
  std::vector<Image> images;
  for (const SlicePlane plane : planes_of(options.plane)) {
    const Geometry slice = slice_grid(source.geometry, plane, at, pixel_mm);
    images.push_back(draw_slice(source.geometry, slice, density_of(source), style));
  }
  write_png(options.output, side_by_side(images, kGapPixels), describe(options, at, style));
  return kOk;
}

}  // namespace

Command add_slice(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* app = add_subcommand(
      program, "slice", "Axial, coronal and sagittal slices of a volume or a deformed state",
      "  supple slice drag.vdb -o slices.png\n"
      "  supple slice drag.vdb --at 128,200,12 --plane sagittal --window -1000,1000 -o bone.png\n"
      "  supple slice head.nii.gz --scale 4 -o head.png");
  app->add_option("input", options->input, "A volume or a state")
      ->required()
      ->option_text("VOLUME|STATE.vdb");
  app->add_option("--raw", options->raw_spec,
                  "Headerless raw: dims=X,Y,Z,type=int16,spacing=A,B,C[,endian=big][,offset=N]");
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
            return run(*options, global, console);
          }};
}

}  // namespace supple::tools

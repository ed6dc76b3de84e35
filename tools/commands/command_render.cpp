// supple render: a picture of a volume, of a volume through any warp, or of a state, none of them
// resampled.
#include <algorithm>
#include <cstdio>
#include <limits>

#include <nlohmann/json.hpp>

#include "lib/material/material_file.h"
#include "tools/console/command.h"
#include "tools/console/parse.h"
#include "tools/console/read_options.h"
#include "tools/outputs/frames.h"
#include "tools/outputs/output_plan.h"
#include "tools/outputs/outputs.h"
#include "tools/scene/offset_functions.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/open_volume.h"
#include "volumes/io/warp_file.h"

namespace supple::tools {

namespace {

/// Voxels of air around the densities above the minimum that a surface needs.
constexpr int kAirRings = 2;

struct RenderOptions {
  std::string input, offsets, offset, preset, camera, size, view, output;
  ReadOptions read;
  std::vector<std::string> clip_planes, clip_boxes;
  std::vector<std::string> lights, meshes;
  std::string shading = "blinn";
  double occlusion_radius_mm = 0;
  bool shadows = false, deform_meshes = false, clip_meshes = false;
  std::string clip_keep = "inside", clip_space = "deformed";
  bool undeformed = false;
  bool no_inverse = false;
  bool half_offsets = false;
  bool lattice = false;
  bool orthographic = false;
  bool prints_camera = false;
  SceneView scene_view;
};

void add_light_and_meshes(const RenderOptions& options, SceneView& view) {
  view.lighting.model = parse_shading(options.shading);
  view.lighting.shadows = options.shadows;
  view.lighting.occlusion_radius_mm = options.occlusion_radius_mm;
  for (const std::string& text : options.lights) {
    view.lighting.lights.push_back(parse_light("--light", text));
  }
  for (const std::string& text : options.meshes) {
    view.meshes.push_back(parse_mesh("--mesh", text));
    view.meshes.back().deform = options.deform_meshes;
  }
  view.clip_meshes = options.clip_meshes;
}

/// Command-line options as one view of a scene.
SceneView to_view(const RenderOptions& options) {
  SceneView view = options.scene_view;
  view.image = options.output;
  view.deformed = !options.undeformed;
  view.inverse = !options.no_inverse;
  view.half_offsets = options.half_offsets;
  view.lattice = options.lattice;
  if (!options.preset.empty()) choose_transfer(view, options.preset);
  for (const std::string& text : options.clip_planes) {
    view.clips.push_back(parse_clip_plane("--clip-plane", text));
  }
  for (const std::string& text : options.clip_boxes) {
    view.clips.push_back(parse_clip_box("--clip-box", text));
  }
  for (ClipChoice& choice : view.clips) {
    choice.clip.keep = options.clip_keep == "outside" ? ClipKeep::outside : ClipKeep::inside;
    choice.clip.space = options.clip_space == "source" ? ClipSpace::source : ClipSpace::deformed;
  }
  add_light_and_meshes(options, view);
  view.offset = read_offset_file(options.offset);
  if (!options.size.empty()) parse_size("--size", options.size, view.width, view.height);
  if (!options.camera.empty()) view.camera = read_camera(options.camera);
  if (!options.view.empty()) view.camera.view = options.view;
  if (options.orthographic) view.camera.projection = Projection::orthographic;
  return view;
}

/// Where the tissue of the state has gone, as far as the view asks for it. Takes the offsets of its
/// elements away, which nothing else reads.
Pose displace(State& state, const SceneView& view, Console& console) {
  Pose deformed{extended_displacement_of(state), {}};
  state.q = {};
  if (view.inverse) {
    deformed.offsets = invert_displacement(state, deformed.displacement, &console);
  } else if (has_open_cuts(state, deformed.displacement)) {
    throw UsageError("--no-inverse: found cuts that have opened, expected a body without");
  }
  if (!reads_displacement(view)) deformed.displacement.u = {};
  return deformed;
}

void draw_state(const RenderOptions& options, SceneView view, PictureWriter& writer,
                RenderReport& report, Console& console) {
  if (!options.offsets.empty()) {
    throw UsageError("--offsets: found a state file, expected a volume (a state has its own)");
  }
  State state = read_state(options.input, &console);
  view = effective_view(view, state.geometry, state.density.background());
  std::optional<Pose> deformed;
  if (view.deformed) deformed = displace(state, view, console);
  if (!view.offset.empty()) {
    deformed = deformed ? send_along(view.offset, *deformed, console)
                        : send_along(view.offset, state.geometry, state.density.bricks(), console);
  }
  const MaterialTable material = parse_material(state.material_toml, options.input);
  draw_view({state.geometry, state.density, state.elements,
             deformed && view.inverse ? &deformed->offsets : nullptr,
             deformed && reads_displacement(view) ? &deformed->displacement : nullptr,
             material.domain_lo, material.domain_hi},
            view, writer, &report, console);
}

/// The warp file as offsets of the volume; warns when none of them leads into it.
OffsetField read_offsets(const std::string& path, const Geometry& source, Console& console) {
  OffsetField offsets = offsets_from_warp(read_warp(path, &console), source, &console);
  if (offsets.o.topology.empty()) {
    console.warn(path + ": no vector leads into the volume, the picture is empty");
  }
  return offsets;
}

void draw_volume(const RenderOptions& options, SceneView view, PictureWriter& writer,
                 RenderReport& report, Console& console) {
  if (options.undeformed) {
    throw UsageError("--undeformed: found a volume, expected a state file");
  }
  if (options.no_inverse) {
    throw UsageError("--no-inverse: found a volume, expected a state file");
  }
  if (options.half_offsets && options.offsets.empty() && view.offset.empty()) {
    throw UsageError(
        "--half-offsets: found a volume, expected a state file, or --offsets or --offset beside "
        "it");
  }
  const auto file = open_volume(options.input, options.read, &console);
  const Geometry& geometry = file->header().geometry;
  view.lattice = view.lattice || geometry.dims().z == 1;
  if (view.lattice && !options.offsets.empty()) {
    throw UsageError("--offsets: found a lattice to draw, expected a volume of several slices");
  }
  // Before the volume, so that the warp's vectors are gone when its voxels come.
  std::optional<OffsetField> offsets;
  if (!options.offsets.empty()) offsets = read_offsets(options.offsets, geometry, console);
  // A lattice shows every voxel; a picture leaves out the air at the file's minimum.
  const double everything = std::numeric_limits<double>::max();
  const Volume volume = view.lattice
                            ? load_elements(*file, -everything, everything, 0, 0, &console).volume
                            : load_volume(*file, &console);
  const VolumeStatistics& statistics = volume.statistics;
  if (statistics.nan_count > 0) {
    console.warn(options.input + ": " + std::to_string(statistics.nan_count) +
                 " NaN voxels treated as void");
  }
  const double grey_hi = std::max(statistics.max, statistics.min + 1);
  view = effective_view(view, geometry, statistics.min);
  std::optional<Displacement> displacement;
  if (!view.offset.empty()) {
    // With the air that pictures of the volume at rest read, too.
    const BrickTopology body = dilate_inside(volume.density.bricks(), kAirRings, geometry.dims());
    if (offsets) {
      offsets = send_along(view.offset, *offsets, console);
    } else {
      Pose seen = send_along(view.offset, geometry, body, console);
      displacement = std::move(seen.displacement);
      offsets = std::move(seen.offsets);
    }
  }
  draw_view(
      {volume.geometry, volume.density, volume.density.bricks(), offsets ? &*offsets : nullptr,
       displacement ? &*displacement : nullptr, statistics.min, grey_hi, kAirRings},
      view, writer, &report, console);
}

/// The camera file of what would be drawn.
void print_camera(const RenderOptions& options, const SceneView& view) {
  const Geometry geometry = is_state_file(options.input)
                                ? read_state(options.input).geometry
                                : open_volume(options.input, options.read)->header().geometry;
  if (view.lattice || geometry.dims().z == 1) {
    throw InputError({options.input, "--print-camera", "a lattice, which frames its body",
                      "a volume of several slices"});
  }
  const Camera camera = resolve_camera(view.camera, geometry, double(view.width) / view.height);
  std::fputs(to_toml(camera).c_str(), stdout);
}

int run_render(const RenderOptions& options, const GlobalOptions& global, Console& console) {
  const SceneView view = to_view(options);
  if (options.prints_camera) {
    print_camera(options, view);
    return kOk;
  }
  if (options.output.empty()) throw UsageError("--output is required");
  check_view(view);
  OutputPlan plan(global);
  plan.protect(options.input);
  plan.add_pictures(view.picture, view.image);
  RenderReport report;
  PendingFiles files;
  PictureWriter writer(files, view.image, view.picture);
  const bool is_state = is_state_file(options.input);
  const auto draw_input = is_state ? draw_state : draw_volume;
  draw_input(options, view, writer, report, console);
  files.commit();
  if (global.json) {
    nlohmann::ordered_json json = to_json(report);
    json["image"] = options.output;
    json["files"] = picture_files(view.picture, view.image);
    std::printf("%s\n", json.dump(2).c_str());
  }
  return kOk;
}

}  // namespace

Command add_render(CLI::App& program) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App* app = add_subcommand(
      program, "render",
      "Render a volume, also through a warp, or a deformed state, without resampling",
      "  supple render head.nhdr --preset CT-Bone -o head.png\n"
      "  supple render drag.vdb --preset CT-Muscle --view left --size 800,600 -o skin.png\n"
      "  supple render head.nhdr --offsets warp.nrrd --camera side.toml -o warped.png");
  app->add_option("input", options->input, "A volume or a state")
      ->required()
      ->option_text("VOLUME|STATE.vdb");
  add_read_options(*app, options->read);
  app->add_flag("--undeformed", options->undeformed, "Show a state's body at rest");
  app->add_option("--offsets", options->offsets, "Show a volume through a resample-direction warp")
      ->option_text("FIELD");
  add_offset_option(*app, options->offset);
  app->add_flag("--no-inverse", options->no_inverse,
                "Samples of a state solve for themselves: less memory, a slower march")
      ->excludes("--undeformed")
      ->excludes("--offsets")
      ->excludes("--offset");
  app->add_flag("--half-offsets", options->half_offsets,
                "Keep every second offset along each axis: a sixth of their memory")
      ->excludes("--no-inverse")
      ->excludes("--undeformed");
  app->add_option(
         "--preset", options->preset,
         "One that `supple presets` lists (default: CT-Bone with HU, else MR-Default), or a file "
         "as `supple presets NAME` prints")
      ->option_text("NAME|F.toml");
  app->add_option("--clip-plane", options->clip_planes,
                  "Leave out what lies behind a point and normal in LPS mm; repeatable")
      ->allow_extra_args(false)
      ->option_text("X,Y,Z:NX,NY,NZ");
  app->add_option("--clip-box", options->clip_boxes,
                  "Leave out what lies outside a box of voxels; repeatable")
      ->allow_extra_args(false)
      ->option_text("I,J,K:I,J,K");
  app->add_option("--clip-keep", options->clip_keep, "What a clip keeps: inside or outside of it")
      ->check(CLI::IsMember({"inside", "outside"}))
      ->option_text("inside|outside");
  app->add_option("--clip-space", options->clip_space,
                  "deformed: cut the picture (default); source: cut the tissue, which takes the "
                  "cut along")
      ->check(CLI::IsMember({"deformed", "source"}))
      ->option_text("SPACE");
  app->add_option("--light", options->lights,
                  "Direction to a light in LPS (or of the camera: right, up, to the viewer); "
                  "repeatable")
      ->allow_extra_args(false)
      ->option_text("[camera:]X,Y,Z[:INTENSITY[:#RRGGBB]]");
  app->add_option("--shading", options->shading, "blinn (default), phong or none")
      ->check(CLI::IsMember({"blinn", "phong", "none"}))
      ->option_text("MODEL");
  app->add_flag("--shadows", options->shadows, "Volume and meshes cast shadows");
  app->add_option("--ambient-occlusion", options->occlusion_radius_mm,
                  "Darken what is enclosed within a radius, 10 mm by default")
      ->expected(0, 1)
      ->default_str("10")
      ->option_text("[MM]");
  app->add_option("--mesh", options->meshes,
                  "Show a surface (STL, PLY, OBJ; LPS mm), too; repeatable")
      ->allow_extra_args(false)
      ->option_text("FILE[:#RRGGBB[:OPACITY]]");
  app->add_flag("--deform-meshes", options->deform_meshes,
                "Meshes were made at rest and move along with the tissue");
  app->add_flag("--clip-meshes", options->clip_meshes, "Clips of the picture cut meshes, too");
  app->add_option("--camera", options->camera, "Camera file")->option_text("C.toml");
  app->add_option("--view", options->view,
                  "From anterior, posterior, left, right, superior or inferior")
      ->excludes("--camera")
      ->option_text("SIDE");
  app->add_flag("--orthographic", options->orthographic, "Parallel instead of perspective rays")
      ->excludes("--camera");
  app->add_flag("--lattice", options->lattice,
                "Draw elements and links (always so for one-slice bodies)")
      ->excludes("--offsets");
  app->add_option("--size", options->size, "Pixels, 1024,1024 by default")->option_text("W,H");
  Sampling& sampling = options->scene_view.sampling;
  app->add_option("--quality", sampling.quality, "draft, default or accurate: speed for accuracy")
      ->option_text("Q");
  app->add_option("--step", sampling.step_voxels, "Sample distance in voxels, not the quality's")
      ->option_text("S");
  app->add_option("--classification", sampling.classification, "post (default) or pre-integrated")
      ->option_text("C");
  app->add_flag("--jitter", sampling.jitter, "Fine noise instead of rings");
  app->add_flag("--print-camera", options->prints_camera,
                "Print the camera as a file for --camera and draw nothing");
  add_picture_options(*app, options->scene_view.picture);
  app->add_option("-o,--output", options->output,
                  "Picture to write; .exr: floats with depth, normals and offsets")
      ->option_text("IMAGE.png|.exr");
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_render(*options, global, console);
          }};
}

}  // namespace supple::tools

// supple render: a picture of a volume, of a volume through any warp, or of a state, none of them
// resampled.
#include <cstdio>

#include "raycast/scene/framing.h"
#include "raycast/scene/transfer_file.h"
#include "tools/console/command.h"
#include "tools/console/dry_run.h"
#include "tools/console/field_options.h"
#include "tools/console/parse.h"
#include "tools/scene/plan/memory_need.h"
#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/reports.h"
#include "tools/scene/run/scene_run.h"
#include "tools/scene/run/staging.h"
#include "volumes/base/json.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

namespace {

struct RenderOptions {
  explicit RenderOptions(CLI::App& app) : scene(app) {}

  SceneOptions scene;
  std::string input, offsets, preset, camera, output;
  std::vector<std::string> clip_planes, clip_boxes, lights, meshes;
  std::string clip_keep = "inside", clip_space = "deformed";
  bool deform_meshes = false, orthographic = false, prints_camera = false;
  bool dry_run = false;
};

/// "A:B", split at its colon. Throws UsageError.
std::pair<std::string, std::string> halves(const std::string& option, const std::string& text,
                                           const char* expected) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) refuse_option(option, text, expected);
  return {text.substr(0, colon), text.substr(colon + 1)};
}

Value clip_tables(const RenderOptions& options) {
  Value tables = Value::List();
  const auto add = [&](const char* key, Value shape) {
    tables.push_back(
        {{key, std::move(shape)}, {"keep", options.clip_keep}, {"space", options.clip_space}});
  };
  for (const std::string& plane : options.clip_planes) {
    const auto [point, normal] =
        halves("--clip-plane", plane, "a point and a normal X,Y,Z:NX,NY,NZ");
    add("plane", {{"point", numbers_value("--clip-plane", point)},
                  {"normal", numbers_value("--clip-plane", normal)}});
  }
  for (const std::string& box : options.clip_boxes) {
    const auto [corner, opposite] = halves("--clip-box", box, "two corners I,J,K:I,J,K");
    numbers_value("--clip-box", corner);
    numbers_value("--clip-box", opposite);
    add("box", numbers_value("--clip-box", corner + "," + opposite, 6));
  }
  return tables;
}

Value colour_value(const std::string& option, const std::string& text) {
  if (!parse_colour(text)) refuse_option(option, text, "a colour #RRGGBB");
  return text;
}

/// "[camera:]X,Y,Z[:INTENSITY[:#RRGGBB]]".
Value light_table(const std::string& text) {
  std::vector<std::string> parts = split(text, ':');
  const bool is_of_camera = !parts.empty() && parts.front() == "camera";
  if (is_of_camera) parts.erase(parts.begin());
  if (parts.empty() || parts.size() > 3) {
    refuse_option("--light", text, "[camera:]X,Y,Z[:INTENSITY[:#RRGGBB]]");
  }
  Value table = {{"direction", numbers_value("--light", parts[0])}};
  if (is_of_camera) table["frame"] = "camera";
  if (parts.size() > 1) table["intensity"] = number_value("--light", parts[1]);
  if (parts.size() > 2) table["colour"] = colour_value("--light", parts[2]);
  return table;
}

/// "FILE[:#RRGGBB[:OPACITY]]".
Value mesh_table(const RenderOptions& options, const std::string& text) {
  const std::size_t colour = text.rfind(":#");
  Value table = {{"path", text.substr(0, colour)}};
  if (colour != std::string::npos) {
    const std::vector<std::string> parts = split(text.substr(colour + 1), ':');
    if (parts.size() > 2) {
      refuse_option("--mesh", text, "FILE[:#RRGGBB[:OPACITY]]");
    }
    table["colour"] = colour_value("--mesh", parts[0]);
    if (parts.size() > 1) table["opacity"] = number_value("--mesh", parts[1]);
  }
  if (options.deform_meshes) table["deform"] = true;
  return table;
}

template <class ToTable>
Value list_of(const std::vector<std::string>& texts, const ToTable& to_table) {
  Value list = Value::List();
  for (const std::string& text : texts) list.push_back(to_table(text));
  return list;
}

void set_camera(RenderOptions& options) {
  SceneOptions& given = options.scene;
  if (!options.camera.empty()) {
    given.set("view", "camera", options.camera, "--camera");
  }
  if (options.orthographic) {
    given.set("view.camera", "projection", "orthographic", "--orthographic");
  }
}

/// The options as a scene of one view.
Scene to_scene(RenderOptions& options) {
  SceneOptions& given = options.scene;
  given.set("volume", "path", options.input, "input");
  if (!options.offsets.empty()) {
    given.set("volume", "offsets", options.offsets, "--offsets");
  }
  given.set("view", "image", options.output, "--output");
  const std::string& preset = options.preset;
  const bool is_file = preset.size() > 5 && preset.compare(preset.size() - 5, 5, ".toml") == 0;
  if (!preset.empty()) {
    if (!is_file) require_preset("--preset", preset);
    given.set("view", is_file ? "transfer" : "preset", preset, "--preset");
  }
  set_camera(options);
  if (!options.clip_planes.empty() || !options.clip_boxes.empty()) {
    given.set("view", "clip", clip_tables(options), "--clip");
  }
  if (!options.lights.empty()) {
    given.set("view", "light", list_of(options.lights, light_table), "--light");
  }
  if (!options.meshes.empty()) {
    const auto write = [&](const std::string& text) { return mesh_table(options, text); };
    given.set("view", "mesh", list_of(options.meshes, write), "--mesh");
  }
  return read_scene(given.scene());
}

/// Refuses options that only a state has where the input is a volume.
void check_options(const Scene& scene) {
  if (is_state_file(scene.volume_path)) return;
  const SceneView& view = scene.views.front();
  const auto refuse = [](const std::string& option, const char* expected) {
    throw UsageError(option + ": found a volume, expected " + expected);
  };
  if (!view.deformed) refuse("--undeformed", "a state file");
  if (!view.inverse) refuse("--no-inverse", "a state file");
  if (view.half_offsets && scene.warp_path.empty() && view.path.empty()) {
    refuse("--half-offsets", "a state file, or --offsets or --path beside it");
  }
}

/// The camera file of what would be drawn.
void print_camera(const Scene& scene) {
  const SceneView& view = scene.views.front();
  const Geometry geometry = is_state_file(scene.volume_path)
                                ? read_state(scene.volume_path).geometry
                                : open_volume(scene.volume_path, scene.read)->header().geometry;
  if (view.lattice || geometry.dims().z == 1) {
    throw InputError({scene.volume_path, "--print-camera", "a lattice, which frames its body",
                      "a volume of several slices"});
  }
  if (view.fit == "body" || view.fit == "visible") {
    throw UsageError("--fit " + view.fit +
                     ": found --print-camera, which reads no voxels, expected box");
  }
  const double aspect = double(view.size[0]) / view.size[1];
  Camera camera = resolve_camera(view.camera, geometry, aspect);
  if (view.fit == "box") {
    camera = framed(camera, aspect, box_corners_lps_mm(geometry), CameraMotion::still,
                    framing_margins(view));
  }
  std::fputs(to_toml(zoomed(camera, view.zoom)).c_str(), stdout);
}

int run_render(RenderOptions& options, const GlobalOptions& global, Console& console) {
  if (options.output.empty() && options.dry_run) options.output = "picture.png";
  const Scene scene = to_scene(options);
  if (options.prints_camera) {
    print_camera(scene);
    return kOk;
  }
  if (options.output.empty()) throw UsageError("--output is required");
  check_options(scene);
  const OutputPlan plan = check_scene(scene, "", global.force || options.dry_run);
  if (options.dry_run) return tell_plan(scene, "", global, console);
  console.claim(plan.files());
  require_memory_to_run(scene, &console);
  SceneRun run(scene, "", false, console);
  require_memory(scene, run);
  run.run();
  if (global.json) {
    const SceneView& view = scene.views.front();
    Value json = to_value(run.drawn());
    json["image"] = view.image;
    json["files"] = picture_files(view.picture, view.image);
    std::printf("%s\n", json_text(json, 2).c_str());
  }
  return kOk;
}

}  // namespace

Command add_render(CLI::App& program) {
  CLI::App* app = add_subcommand(
      program, "render",
      "Render a volume, also through a warp, or a deformed state, without resampling",
      "  supple render head.nhdr --preset Bone -o head.png\n"
      "  supple render drag.vdb --preset Muscle --view left --size 800,600 -o skin.png\n"
      "  supple render head.nhdr --offsets warp.nrrd --camera side.toml -o warped.png");
  auto options = std::make_shared<RenderOptions>(*app);
  app->add_option("input", options->input, "A volume or a state")
      ->required()
      ->option_text("VOLUME|STATE.vdb");
  ReadOptions read;
  std::string path;
  SceneView view;
  options->scene.add("volume", fields(read));
  app->add_option("--offsets", options->offsets, "Show a volume through a resample-direction warp")
      ->option_text("FIELD");
  app->add_option(
         "--preset", options->preset,
         "One that `supple presets` lists (default: Bone with HU, else MR-Default), or a file "
         "as `supple presets NAME` prints")
      ->option_text("NAME|F.toml");
  app->add_option("--clip-plane", options->clip_planes,
                  "Leave out what is behind a point and normal in LPS mm; repeatable")
      ->allow_extra_args(false)
      ->option_text("X,Y,Z:NX,NY,NZ");
  app->add_option("--clip-box", options->clip_boxes,
                  "Leave out what lies outside a box of voxels; repeatable")
      ->allow_extra_args(false)
      ->option_text("I,J,K:I,J,K");
  Clip clip;
  for (const Field& field : fields(clip)) {
    std::string& value = field.name() == "keep" ? options->clip_keep : options->clip_space;
    app->add_option("--clip-" + field.name(), value,
                    field.traits().help + " (default: " + value + ")")
        ->check(CLI::IsMember(field.names()))
        ->option_text(field.placeholder());
  }
  app->add_option("--light", options->lights,
                  "Direction to a light, LPS or right, up, to the viewer; repeatable")
      ->allow_extra_args(false)
      ->option_text("[camera:]X,Y,Z[:INTENSITY[:#RRGGBB]]");
  app->add_option("--mesh", options->meshes,
                  "Show a surface (STL, PLY, OBJ; LPS mm), too; repeatable")
      ->allow_extra_args(false)
      ->option_text("FILE[:#RRGGBB[:OPACITY]]");
  app->add_flag("--deform-meshes", options->deform_meshes,
                "Meshes were made at rest and move along with the tissue");
  app->add_option("--camera", options->camera, "Camera file")->option_text("C.toml");
  app->add_flag("--orthographic", options->orthographic, "Parallel instead of perspective rays")
      ->excludes("--camera");
  options->scene.add("view", fields(view));
  options->scene.add("view", {path_file_field(path)});
  options->scene.add("view.camera", {side_field(view.camera.view)});
  app->get_option("--view")->excludes("--camera");
  for (const char* other : {"--undeformed", "--offsets", "--path", "--offset"}) {
    app->get_option("--no-inverse")->excludes(other);
  }
  app->get_option("--half-offsets")->excludes("--no-inverse")->excludes("--undeformed");
  app->get_option("--lattice")->excludes("--offsets");
  app->add_flag("--print-camera", options->prints_camera,
                "Print the camera as a file for --camera and draw nothing");
  app->add_flag("--dry-run", options->dry_run,
                "Print what would be held and computed, and why; write nothing");
  app->add_option("-o,--output", options->output,
                  "Picture to write; .exr: floats with depth, normals and offsets")
      ->option_text("IMAGE.png|.exr");
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_render(*options, global, console);
          }};
}

}  // namespace supple::tools

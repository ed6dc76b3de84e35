// supple slice: axial, coronal, sagittal and oblique slices of a volume or a deformed state.
#include <filesystem>

#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/plan/memory_need.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

namespace {

struct SliceOptions {
  explicit SliceOptions(CLI::App& app) : scene(app) {}

  SceneOptions scene;
  std::string input, output;
  bool undeformed = false;
};

int run_slice(SliceOptions& options, const GlobalOptions& global, Console& console) {
  if (options.undeformed && !is_state_file(options.input)) {
    throw UsageError("--undeformed: found a volume, expected a state file");
  }
  if (std::filesystem::path(options.output).extension() != ".png") {
    throw InputError({options.output, "output", "another extension", "extension .png"});
  }
  SceneOptions& given = options.scene;
  given.set("volume", "path", options.input, "input");
  given.include("view.slice");
  given.set("view", "image", options.output, "--output");
  if (options.undeformed) given.set("view", "deformed", false, "--undeformed");
  const Scene scene = read_scene(given.scene());
  console.claim(check_scene(scene, "", global.force).files());
  require_memory_to_run(scene, &console);
  SceneRun run(scene, "", false, console);
  require_memory(scene, run);
  run.run();
  return kOk;
}

}  // namespace

Command add_slice(CLI::App& program) {
  CLI::App* app = add_subcommand(
      program, "slice",
      "Axial, coronal, sagittal and oblique slices of a volume or a deformed state",
      "  supple slice drag.vdb --at 128,200,12 --plane sagittal --window -1000,1000 -o bone.png\n"
      "  supple slice drag.vdb --plane axial --grid 10 --arrows 8 --annotate all -o moved.png\n"
      "  supple slice head.nii.gz --lightbox 4x3 --scale 1 -o head.png");
  auto options = std::make_shared<SliceOptions>(*app);
  app->add_option("input", options->input, "A volume or a state")
      ->required()
      ->option_text("VOLUME|STATE.vdb");
  ReadOptions read;
  std::string path;
  SliceChoice slice;
  Decoration decoration;
  options->scene.add("volume", fields(read));
  options->scene.add("view", {path_file_field(path)});
  options->scene.add("view", fields(decoration));
  options->scene.add("view.slice", fields(slice));
  app->add_flag("--undeformed", options->undeformed, "Show a state's body at rest");
  app->add_option("-o,--output", options->output, "Picture to write")
      ->required()
      ->option_text("IMAGE.png");
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_slice(*options, global, console);
          }};
}

}  // namespace supple::tools

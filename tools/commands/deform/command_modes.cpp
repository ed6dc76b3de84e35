// supple modes: the lowest modes of vibration of a body, and states that have their shapes.
#include <cstdio>

#include "lib/session/fem/fem_modes.h"
#include "lib/session/session.h"
#include "tools/console/body_options.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/pictures/picture_options.h"
#include "tools/scene/plan/memory_need.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/reports.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/base/json.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

namespace {

struct ModesOptions {
  explicit ModesOptions(CLI::App& app) : scene(app) {}

  SceneOptions scene;
  BodyOptions body;
  std::string output;
};

Scene scene_of(ModesOptions& options) {
  SceneOptions& given = options.scene;
  set_body(options.body, given);
  given.set("step", "model", "fem", "modes");
  given.include("step.fem.modes");
  given.call("step[1]", "modes");
  return read_scene(given.scene());
}

/// Files of all modes, numbered from 1.
std::vector<std::string> files_of(const std::string& output, int count) {
  if (output.empty()) return {};
  if (!has_frame_number(output)) {
    throw UsageError("--output: found '" + output +
                     "', expected a name with the number of the mode, as mode_%02d.vdb");
  }
  std::vector<std::string> files;
  for (int n = 1; n <= count; ++n) files.push_back(frame_name(output, n));
  return files;
}

void print_modes(const ModesRecord& record) {
  const ModesReport& report = record.report;
  std::printf("elements        %lld, of %.4g kg\n", static_cast<long long>(report.elements),
              report.mass_kg);
  if (report.rigid_modes > 0) {
    std::printf("free            %lld rigid modes of %lld pieces left out\n",
                static_cast<long long>(report.rigid_modes), static_cast<long long>(report.islands));
  }
  std::printf("solved          %lld unknowns, %d solutions, %d iterations; memory %zu MiB\n",
              static_cast<long long>(report.unknowns), report.solutions, report.iterations,
              report.bytes >> 20);
  std::printf("\nmode  frequency Hz   part of the mass along x, y, z   residual\n");
  for (std::size_t n = 0; n < record.modes.size(); ++n) {
    const ModeRow& mode = record.modes[n];
    const Vec3d part = mode.effective_mass_kg / report.mass_kg;
    std::printf("%4zu  %12.6g   %8.4f  %8.4f  %8.4f      %.1e\n", n + 1, mode.frequency_hz, part.x,
                part.y, part.z, mode.residual);
  }
}

int run_modes(ModesOptions& options, const GlobalOptions& global, Console& console) {
  const Scene scene = scene_of(options);
  const std::vector<std::string> files =
      files_of(options.output, scene.steps.front().fem->modes->count);
  OutputPlan plan = check_scene(scene, "", global.force);
  for (const std::string& file : files) plan.add_state(file);
  console.claim(plan.files());
  require_memory_to_open(scene, &console);
  Session session(scene.volume_path, {scene.material, scene.labels_path, scene.read}, &console);
  check_places(scene, session.geometry());
  const StepRecord& record = session.step(scene.steps.front(), &console);
  for (std::size_t n = 0; n < files.size(); ++n) {
    session.show_mode(int(n) + 1);
    session.write_state(files[n], &console);
  }
  if (global.json) {
    Value json = to_value(record);
    json["states"] = files;
    std::printf("%s\n", json_text(json, 2).c_str());
  } else if (!global.quiet) {
    print_modes(*record.equilibrium.modes);
  }
  return kOk;
}

}  // namespace

Command add_modes(CLI::App& program) {
  CLI::App* app = add_subcommand(
      program, "modes", "Lowest modes of vibration: frequencies, masses that take part, shapes",
      "  supple modes head.nhdr --material ct-head --fix density:300:3000 --count 6\n"
      "  supple modes liver.nii.gz --material liver.toml --json\n"
      "  supple modes ear.nhdr --fix 0,0,0:60,60,2 -o mode_%02d.vdb\n"
      "  supple render mode_01.vdb --sequence 48 --swing -o mode_01_%02d.png");
  auto options = std::make_shared<ModesOptions>(*app);
  add_body_options(*app, options->body);
  ReadOptions read;
  ModeStep modes;
  SceneOptions& scene = options->scene;
  scene.add("volume", fields(read));
  scene.add("labels", {});
  scene.add("material", {});
  scene.add("step", {});
  scene.add("step.fem", {});
  scene.add("step.fem.modes", fields(modes));
  app->add_option("-o,--output", options->output,
                  "States with the shapes of the modes, one for each")
      ->option_text("MODE_%02d.vdb");
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_modes(*options, global, console);
          }};
}

}  // namespace supple::tools

// supple run: everything that a scene file asks for.
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "tools/console/command.h"
#include "tools/console/parse.h"
#include "tools/outputs/frames.h"
#include "tools/outputs/output_plan.h"
#include "tools/outputs/outputs.h"
#include "tools/scene/run_step.h"
#include "tools/scene/scene.h"
#include "volumes/io/open_volume.h"
#include "volumes/state/state_outputs.h"

namespace supple::tools {

namespace {

struct RunSceneOptions {
  std::string scene;
  std::string folder = ".";
  bool dry_run = false;
};

std::string path_in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

class SceneRun {
 public:
  /// `tells_forces`: the results hold what handles feel.
  SceneRun(const Scene& scene, const RunSceneOptions& options, bool tells_forces, Console& console)
      : m_scene(scene),
        m_folder(options.folder),
        m_tells_forces(tells_forces),
        m_console(console),
        m_session(scene.volume_path, {scene.material, scene.labels_path, scene.read}, &console) {}

  /// Solves and draws everything first, so that a scene that fails leaves nothing behind.
  void run() {
    draw_views(0);
    for (std::size_t n = 0; n < m_scene.steps.size(); ++n) {
      run_step(m_session, m_scene.steps[n], m_tells_forces, &m_console);
      draw_views(int(n) + 1);
    }
    if (writes_fields()) seen(last_step());
    m_pictures.commit();
    for (const std::string& name : m_scene.outputs()) {
      std::filesystem::create_directories(std::filesystem::path(path_of(name)).parent_path());
    }
    write_outputs();
  }

  const Session& session() const { return m_session; }
  const InversionCertificate* certificate() const {
    return m_inverted_step >= 0 ? &m_deformed.offsets.certificate : nullptr;
  }

 private:
  int last_step() const { return int(m_scene.steps.size()); }
  bool writes_fields() const {
    const SceneOutput& output = m_scene.output;
    return !(output.state.empty() && output.offsets.empty() && output.displacements.empty() &&
             output.volumes.empty());
  }

  std::string path_of(const std::string& name) const { return path_in(m_folder, name); }

  /// State and displacement after the present step, computed once and only when something needs
  /// them.
  const Displacement& displacement(int step) {
    if (m_displaced_step != step) {
      m_state = m_session.state();
      m_deformed.displacement = extended_displacement_of(m_state);
      m_displaced_step = step;
    }
    return m_deformed.displacement;
  }

  /// With the inverse.
  const Pose& deformed(int step) {
    displacement(step);
    if (m_inverted_step != step) {
      m_deformed.offsets = invert_displacement(m_state, m_deformed.displacement, &m_console);
      m_inverted_step = step;
    }
    return m_deformed;
  }

  /// The same as the scene's functions show it.
  const Pose& seen(int step) {
    if (m_scene.offset.empty()) return deformed(step);
    if (m_seen_step != step) {
      m_seen = send_along(m_scene.offset, deformed(step), m_console);
      m_seen_step = step;
    }
    return *m_seen;
  }

  /// The displacement for a view in which samples solve for themselves.
  const Displacement& without_inverse(const SceneView& view, int step) {
    const Displacement& moved = displacement(step);
    if (has_open_cuts(m_state, moved)) {
      throw InputError(
          {view.place, "inverse", "cuts that have opened", "inverse = true, or a body without"});
    }
    return moved;
  }

  /// What a view shows with its inverse; null: the body at rest. `own` holds what is this view's
  /// alone, and the view gets the functions of the scene, too.
  const Pose* inverted_for(SceneView& view, int step, std::optional<Pose>& own) {
    const bool has_own = !view.offset.empty();
    if (view.deformed) {
      view.offset.insert(view.offset.begin(), m_scene.offset.begin(), m_scene.offset.end());
      if (!has_own) return &seen(step);
      own = send_along(view.offset, deformed(step), m_console);
      return &*own;
    }
    m_state = m_session.state();
    if (!has_own) return nullptr;
    own = send_along(view.offset, m_state.geometry, m_state.density.bricks(), m_console);
    return &*own;
  }

  void draw_views(int step) {
    for (const SceneView& view : m_scene.views) {
      if (view.after_step.value_or(last_step()) != step) continue;
      SceneView asked = view;
      std::optional<Pose> own;
      const OffsetField* offsets = nullptr;
      const Displacement* moved = nullptr;
      if (view.deformed && !view.inverse) {
        moved = &without_inverse(view, step);
      } else if (const Pose* inverted = inverted_for(asked, step, own)) {
        offsets = &inverted->offsets;
        moved = &inverted->displacement;
      }
      const SceneView drawn = effective_view(asked, m_state.geometry, m_state.density.background());
      const MaterialTable& material = m_session.body().material;
      PictureWriter writer(m_pictures, path_of(view.image), view.picture);
      draw_view({m_state.geometry, m_state.density, m_state.elements, offsets, moved,
                 material.domain_lo, material.domain_hi},
                drawn, writer, nullptr, m_console);
    }
  }

  void write_outputs() {
    const SceneOutput& output = m_scene.output;
    const int last = last_step();
    if (!output.state.empty()) {
      const Pose& moved = deformed(last);
      write_state(path_of(output.state), m_state, moved.offsets, &m_console);
    }
    for (const std::string& name : output.offsets) {
      write_state_warp(
          {path_of(name), WarpDirection::resample, VoidMode::nearest, m_state.geometry}, m_state,
          seen(last), &m_console);
    }
    for (const std::string& name : output.displacements) {
      write_state_warp(
          {path_of(name), WarpDirection::material, VoidMode::nearest, m_state.geometry}, m_state,
          seen(last), &m_console);
    }
    for (const std::string& name : output.volumes) {
      write_resampled(path_of(name), m_state, seen(last), m_state.geometry, {}, &m_console);
    }
  }

  const Scene& m_scene;
  std::string m_folder;
  bool m_tells_forces;
  Console& m_console;
  Session m_session;
  State m_state;
  Pose m_deformed;
  int m_displaced_step = -1, m_inverted_step = -1;
  std::optional<Pose> m_seen;
  int m_seen_step = -1;
  PendingFiles m_pictures;
};

/// Everything that can be known to fail is checked before anything is computed.
void check_scene(const Scene& scene, const RunSceneOptions& options, const GlobalOptions& global) {
  OutputPlan plan(global, true);
  plan.protect(scene.file);
  plan.protect(scene.volume_path);
  if (!scene.labels_path.empty()) plan.protect(scene.labels_path);
  if (!scene.material_path.empty()) plan.protect(scene.material_path);
  for (const SceneStep& step : scene.steps) {
    for (const CutSurface& cut : step.cuts) {
      if (cut.mesh) plan.protect(cut.place);
    }
  }
  for (const SceneView& view : scene.views) {
    check_view(view);
    check_inverse(view, scene.offset);
    plan.add_pictures(view.picture, path_in(options.folder, view.image));
  }
  const SceneOutput& output = scene.output;
  if (!output.state.empty()) plan.add_state(path_in(options.folder, output.state));
  for (const auto* names : {&output.offsets, &output.displacements, &output.volumes}) {
    for (const std::string& name : *names) plan.add_dense(path_in(options.folder, name));
  }
  const Geometry geometry = is_state_file(scene.volume_path)
                                ? read_state(scene.volume_path).geometry
                                : open_volume(scene.volume_path, scene.read)->header().geometry;
  for (const SceneStep& step : scene.steps) check_step(step, geometry);
  to_path(scene.offset, geometry);
  for (const SceneView& view : scene.views) to_path(view.offset, geometry);
}

void print_plan(const Scene& scene, const RunSceneOptions& options) {
  std::printf("volume  %s\n", scene.volume_path.c_str());
  for (std::size_t n = 0; n < scene.steps.size(); ++n) {
    const SceneStep& step = scene.steps[n];
    std::size_t points = 0;
    for (const PointFile& file : step.fix_points) points += file.rows.size();
    std::printf("step %zu  %zu handles, %zu fixed boxes, points and labels, %zu cuts%s%s\n", n + 1,
                step.handles.size(), step.fix.size() + step.fix_labels.size() + points,
                step.cuts.size(), step.release ? ", releases" : "",
                step.relax     ? ", relaxes"
                : step.springs ? ", springs"
                               : "");
  }
  for (const std::string& name : scene.outputs()) {
    std::printf("writes  %s\n", path_in(options.folder, name).c_str());
  }
}

void print_results(const SceneRun& run, const Scene& scene, const RunSceneOptions& options,
                   const GlobalOptions& global, Console& console) {
  const auto stages = console.stage_seconds();
  if (global.json) {
    nlohmann::ordered_json json;
    json["steps"] = nlohmann::ordered_json::array();
    for (const StepRecord& record : run.session().records())
      json["steps"].push_back(to_json(record));
    if (run.certificate() != nullptr) json["certificate"] = to_json(*run.certificate());
    for (const auto& [name, seconds] : stages) json["stage_seconds"][name] = seconds;
    for (const std::string& name : scene.outputs()) {
      json["outputs"].push_back(path_in(options.folder, name));
    }
    std::printf("%s\n", json.dump(2).c_str());
    return;
  }
  if (global.quiet) return;
  double total = 0;
  for (const auto& [name, seconds] : stages) total += seconds;
  for (const auto& [name, seconds] : stages) {
    std::printf("%-18s %7.2f s  %3.0f %%\n", name.c_str(), seconds, 100 * seconds / total);
  }
  for (const std::string& name : scene.outputs()) {
    std::printf("wrote %s\n", path_in(options.folder, name).c_str());
  }
}

int run_scene(const RunSceneOptions& options, const GlobalOptions& global, Console& console) {
  const Scene scene = read_scene(options.scene);
  check_scene(scene, options, global);
  if (options.dry_run) {
    print_plan(scene, options);
    return kOk;
  }
  SceneRun scene_run(scene, options, global.json, console);
  scene_run.run();
  print_results(scene_run, scene, options, global, console);
  return kOk;
}

}  // namespace

Command add_run(CLI::App& program) {
  auto options = std::make_shared<RunSceneOptions>();
  CLI::App* app = add_subcommand(program, "run", "Run a scene file: deform, render and export",
                                 "  supple run head_drag.toml\n"
                                 "  supple run head_drag.toml -o out/head_drag --force\n"
                                 "  supple run head_drag.toml --dry-run");
  app->add_option("scene", options->scene, "A scene file")->required()->option_text("SCENE.toml");
  app->add_option("-o,--output", options->folder, "Folder of the outputs, created when missing")
      ->option_text("DIR");
  app->add_flag("--dry-run", options->dry_run, "Check the scene and print what it would write");
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_scene(*options, global, console);
          }};
}

}  // namespace supple::tools

#include "tools/scene/run/scene_run.h"

#include <algorithm>
#include <filesystem>

#include "lib/session/fem_limits.h"
#include "lib/state/state_outputs.h"
#include "tools/scene/pictures/picture_writer.h"
#include "tools/scene/run/element_volumes.h"
#include "tools/scene/run/film_record.h"
#include "tools/scene/run/frames.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/scene_files.h"
#include "tools/scene/run/scene_poses.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"
#include "volumes/io/mesh/mesh_writer.h"

namespace supple::tools {

namespace {

bool writes_fields(const SceneOutput& output) {
  return !(output.state.empty() && output.offsets.empty() && output.displacements.empty() &&
           output.volumes.empty());
}

}  // namespace

std::shared_ptr<const Scene> open_scene(const std::string& path) {
  return std::make_shared<const Scene>(read_scene(path));
}

std::vector<std::string> planned_files(const Scene& scene, const std::string& folder,
                                       bool may_overwrite) {
  return check_scene(scene, folder, may_overwrite).files();
}

OutputPlan check_scene(const Scene& scene, const std::string& folder, bool may_overwrite) {
  const bool is_file = !scene.file.empty();
  if (scene.has_events) {
    throw InputError({scene.file, "event", "the journal of a live session",
                      "a scene of it (`supple replay --scene`), or `supple replay`"});
  }
  OutputPlan plan(may_overwrite, is_file);
  if (is_file) plan.protect(scene.file);
  if (is_file || !is_state_file(scene.volume_path)) {
    plan.protect(scene.volume_path, scene.read);
  } else {  // a command may continue a state in place
    plan.protect_source_of(scene.volume_path);
  }
  for (const std::string& input : {scene.labels_path, scene.material_path, scene.warp_path}) {
    if (!input.empty()) plan.protect(input);
  }
  for (const SceneBody& body : scene.bodies) {
    plan.protect(body.setup.path);
    if (!scene.film && !body.output.empty())
      plan.add_like(path_in(folder, body.output), body.output);
  }
  for (const Step& step : scene.steps) {
    for (const CutSurface& cut : step.cuts) {
      if (cut.mesh) plan.protect(cut.place);
    }
  }
  for (const SceneView& view : scene.views) {
    check_view(view);
    check_inverse(view, scene.path);
    // A state may hold labels.
    check_ids(view, !scene.labels_path.empty() || is_state_file(scene.volume_path));
    if (!scene.film) plan.add_pictures(view.picture, path_in(folder, view.image));
  }
  if (scene.film) {
    plan_film(scene, folder, plan);
  } else {
    plan_outputs(scene.output, folder, plan);
  }
  return plan;
}

bool needs_body(const Scene& scene) {
  if (!scene.steps.empty() || !scene.bodies.empty() || writes_fields(scene.output)) return true;
  return scene.material || !scene.labels_path.empty();
}

void check_places(const Scene& scene, const Geometry& geometry) {
  for (const Step& step : scene.steps) check_places(step, geometry);
  to_path(scene.path, geometry);
  for (const SceneView& view : scene.views) to_path(view.path, geometry);
}

SessionOptions session_options(const Scene& scene) {
  const bool is_animated = scene.film && scene.still_steps() < scene.steps.size();
  return {scene.material, scene.labels_path, scene.read, is_animated, scene.output.refers};
}

SceneRun::SceneRun(const Scene& scene, const std::string& folder, bool tells_reactions,
                   Progress& progress)
    : m_scene(scene),
      m_folder(folder),
      m_tells_reactions(tells_reactions || !scene.output.motion.empty() ||
                        !scene.output.forces.empty()),
      m_progress(progress),
      m_pictures(std::make_unique<PendingFiles>()) {
  for (const std::string& line : scene.warnings) progress.warn(line);
  const Stopwatch clock;
  m_poses = std::make_unique<ScenePoses>(scene, progress);
  m_open_s = clock.ms() * kSPerMs;
  check_places(scene, m_poses->state().geometry);
}

SceneRun::~SceneRun() = default;

void SceneRun::check_steps() const {
  for (const Step& step : m_scene.steps) m_poses->session()->check(step);
}

int SceneRun::last_step() const {
  return int(m_scene.steps.size());
}

std::string SceneRun::path_of(const std::string& name) const {
  return path_in(m_folder, name);
}

void SceneRun::run() {
  if (m_scene.film) return run_film();
  draw_views(0);
  for (std::size_t n = 0; n < m_scene.steps.size(); ++n) {
    solve(n);
    draw_views(int(n) + 1);
  }
  if (reads_inverse(m_scene)) m_poses->seen(last_step());
  m_pictures->commit();
  make_folders();
  write_outputs(last_step(), 0);
}

/// Solves a step, from when on nothing reads what was of the body before.
void SceneRun::solve(std::size_t n, double time) {
  m_poses->forget();
  Step step = m_scene.steps[n];
  step.tells_reactions = m_tells_reactions;
  const bool writes_forces = !m_scene.output.motion.empty() || !m_scene.output.forces.empty();
  if (step.fem && writes_forces && m_scene.labels_path.empty()) settle_reactions(*step.fem);
  m_poses->session()->step(step, &m_progress, time);
}

void SceneRun::make_folders() const {
  if (m_scene.file.empty()) return;
  for (const std::string& name : m_scene.outputs()) {
    std::filesystem::create_directories(std::filesystem::path(path_of(name)).parent_path());
  }
}

State SceneRun::opened() const {
  return session() != nullptr ? session()->state() : m_poses->state();
}

const Session* SceneRun::session() const {
  return m_poses->session();
}

const InversionCertificate* SceneRun::certificate() const {
  return m_poses->certificate();
}

void SceneRun::draw_views(int step) {
  for (const SceneView& view : m_scene.views) {
    if (view.after_step.value_or(last_step()) != step) continue;
    const PosedView drawn = m_poses->drawn_after(step, view);
    PictureWriter writer(*m_pictures, path_of(view.image), view.picture);
    draw_view(drawn.subject, drawn.view, writer, &m_drawn, m_progress);
  }
}

/// Writes all outputs; for a film those with a number, and after its last frame all.
void SceneRun::write_outputs(int last, int frame) {
  const SceneOutput& output = m_scene.output;
  const State& state = m_poses->state();
  const auto is_due = [&](const std::string& name) {
    if (!m_scene.film) return !name.empty();
    return has_frame_number(name) || (!name.empty() && frame == m_scene.film->frames - 1);
  };
  const auto file_of = [&](const std::string& name) {
    return path_of(m_scene.film ? frame_name(name, frame) : name);
  };
  if (is_due(output.state)) {
    const Pose& moved = m_poses->deformed(last);
    write_state(file_of(output.state), state, moved.offsets, &m_progress);
  }
  const auto write_warps = [&](const std::vector<std::string>& names, WarpDirection direction) {
    for (const std::string& name : names) {
      if (!is_due(name)) continue;
      const Pose& pose = m_poses->moved(last);
      write_state_warp({file_of(name), direction, VoidMode::nearest, state.geometry}, state, pose,
                       &m_progress);
    }
  };
  write_warps(output.offsets, WarpDirection::resample);
  write_warps(output.displacements, WarpDirection::material);
  for (const std::string& name : output.volumes) {
    if (!is_due(name)) continue;
    const Pose& pose = m_poses->seen(last);
    write_resampled(file_of(name), state, pose, state.geometry, {}, &m_progress);
  }
  for (const ElementOutput& wanted : output.elements) {
    if (!is_due(wanted.path)) continue;
    write_element_volume(file_of(wanted.path), *session(), wanted.quantity, &m_progress);
  }
  for (const SceneBody& body : m_scene.bodies) {
    if (!is_due(body.output)) continue;
    for (const DeformableMesh& mesh : session()->meshes()) {
      if (mesh.name() == body.setup.name) write_mesh(file_of(body.output), mesh.shape());
    }
  }
  if (is_due(output.forces)) write_force_table(path_of(output.forces), *session());
  if (is_due(output.motion)) write_motion_table(path_of(output.motion), *session());
}

}  // namespace supple::tools

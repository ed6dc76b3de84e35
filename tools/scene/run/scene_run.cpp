#include "tools/scene/run/scene_run.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "lib/material/material.h"
#include "lib/state/state_outputs.h"
#include "tools/scene/pictures/picture_writer.h"
#include "tools/scene/run/drawn_view.h"
#include "tools/scene/run/element_volumes.h"
#include "tools/scene/run/film_record.h"
#include "tools/scene/run/frames.h"
#include "tools/scene/run/output_plan.h"
#include "tools/scene/run/scene_files.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"
#include "volumes/grid/brick_topology.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/mesh/mesh_writer.h"
#include "volumes/io/warp_file.h"

namespace supple::tools {

namespace {

bool writes_fields(const SceneOutput& output) {
  return !(output.state.empty() && output.offsets.empty() && output.displacements.empty() &&
           output.volumes.empty());
}

/// Throws InputError where a warp is asked for beside what moves by itself.
void require_no_warp(const Scene& scene, const std::string& found) {
  if (scene.warp_path.empty()) return;
  throw InputError({scene.file, "offsets", found, "a volume alone"});
}

/// The warp file as offsets of the volume; warns when none of them leads into it.
OffsetField read_offsets(const std::string& path, const Geometry& source, Progress& progress) {
  OffsetField offsets = offsets_from_warp(read_warp(path, &progress, &source), source, &progress);
  if (offsets.o.topology.empty()) {
    progress.warn(path + ": no vector leads into the volume, the picture is empty");
  }
  return offsets;
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
  open();
  m_open_s = clock.ms() * kSPerMs;
  check_places(scene, m_state.geometry);
}

SceneRun::~SceneRun() = default;

void SceneRun::open() {
  if (needs_body(m_scene)) {
    require_no_warp(m_scene, "a body that moves by itself");
    m_session =
        std::make_unique<Session>(m_scene.volume_path, session_options(m_scene), &m_progress);
    add_bodies(m_scene.bodies, *m_session);
    m_state.geometry = m_session->geometry();
    m_grey_lo = m_session->body().material.domain_lo;
    m_grey_hi = m_session->body().material.domain_hi;
  } else if (is_state_file(m_scene.volume_path)) {
    require_no_warp(m_scene, "a state, which has its own");
    require_unused(m_scene.read, m_scene.volume_path);
    m_state = read_state(m_scene.volume_path, &m_progress);
    const MaterialTable material = parse_material(m_state.material_toml, m_scene.volume_path);
    m_grey_lo = material.domain_lo;
    m_grey_hi = material.domain_hi;
  } else {
    open_volume_alone();
  }
}

void SceneRun::open_volume_alone() {
  m_is_volume = true;
  for (const SceneView& view : m_scene.views) {
    if (view.inverse) continue;
    throw InputError({view.place, "inverse", "a volume that nothing moves", "a state or steps"});
  }
  const auto file = open_volume(m_scene.volume_path, m_scene.read, &m_progress);
  const Geometry& geometry = file->header().geometry;
  const bool is_slice = std::all_of(m_scene.views.begin(), m_scene.views.end(),
                                    [](const SceneView& view) { return view.slice.has_value(); });
  const bool is_lattice =
      !is_slice &&
      (geometry.dims().z == 1 || std::any_of(m_scene.views.begin(), m_scene.views.end(),
                                             [](const SceneView& view) { return view.lattice; }));
  if (is_lattice) require_no_warp(m_scene, "a lattice to draw");
  // The warp is read before the volume: its vectors are gone when the voxels come.
  m_has_warp = !m_scene.warp_path.empty();
  if (m_has_warp) m_deformed.offsets = read_offsets(m_scene.warp_path, geometry, m_progress);
  // A lattice shows every voxel; a picture leaves out the air at the file's minimum.
  const double everything = std::numeric_limits<double>::max();
  Volume volume = is_lattice
                      ? load_elements(*file, -everything, everything, 0, 0, &m_progress).volume
                      : load_volume(*file, &m_progress);
  const std::string void_values = void_values_text(volume.statistics);
  if (!void_values.empty()) {
    m_progress.warn(m_scene.volume_path + ": " + void_values + " treated as void");
  }
  m_grey_lo = volume.statistics.min;
  m_grey_hi = std::max(volume.statistics.max, volume.statistics.min + 1);
  m_state.geometry = volume.geometry;
  m_state.density = std::move(volume.density);
}

void SceneRun::check_steps() const {
  for (const Step& step : m_scene.steps) m_session->check(step);
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
  if (reads_inverse(m_scene)) seen(last_step());
  m_pictures->commit();
  make_folders();
  write_outputs(last_step(), 0);
}

/// Solves a step, from when on nothing reads what was of the body before.
void SceneRun::solve(std::size_t n, double time) {
  forget_pose();
  Step step = m_scene.steps[n];
  step.tells_reactions = m_tells_reactions;
  m_session->step(step, &m_progress, time);
}

void SceneRun::make_folders() const {
  if (m_scene.file.empty()) return;
  for (const std::string& name : m_scene.outputs()) {
    std::filesystem::create_directories(std::filesystem::path(path_of(name)).parent_path());
  }
}

const InversionCertificate* SceneRun::certificate() const {
  return m_has_inverted ? &m_deformed.offsets.certificate : nullptr;
}

void SceneRun::draw_views(int step) {
  for (const SceneView& view : m_scene.views) {
    if (view.after_step.value_or(last_step()) != step) continue;
    const Drawn drawn = drawn_after(step, view);
    PictureWriter writer(*m_pictures, path_of(view.image), view.picture);
    draw_view(drawn.subject, drawn.view, writer, &m_drawn, m_progress);
    m_own.reset();
  }
}

/// Writes all outputs; for a film those with a number, and after its last frame all.
void SceneRun::write_outputs(int last, int frame) {
  const SceneOutput& output = m_scene.output;
  const auto is_due = [&](const std::string& name) {
    if (!m_scene.film) return !name.empty();
    return has_frame_number(name) || (!name.empty() && frame == m_scene.film->frames - 1);
  };
  const auto file_of = [&](const std::string& name) {
    return path_of(m_scene.film ? frame_name(name, frame) : name);
  };
  if (is_due(output.state)) {
    const Pose& moved = deformed(last);
    write_state(file_of(output.state), m_state, moved.offsets, &m_progress);
  }
  const auto write_warps = [&](const std::vector<std::string>& names, WarpDirection direction) {
    for (const std::string& name : names) {
      if (!is_due(name)) continue;
      if (reads_inverse(m_scene)) {
        seen(last);
      } else {
        displacement(last);
      }
      write_state_warp({file_of(name), direction, VoidMode::nearest, m_state.geometry}, m_state,
                       m_scene.path.empty() ? m_deformed : *m_seen, &m_progress);
    }
  };
  write_warps(output.offsets, WarpDirection::resample);
  write_warps(output.displacements, WarpDirection::material);
  for (const std::string& name : output.volumes) {
    if (!is_due(name)) continue;
    write_resampled(file_of(name), m_state, seen(last), m_state.geometry, {}, &m_progress);
  }
  for (const ElementOutput& wanted : output.elements) {
    if (!is_due(wanted.path)) continue;
    write_element_volume(file_of(wanted.path), *m_session, wanted.quantity, &m_progress);
  }
  for (const SceneBody& body : m_scene.bodies) {
    if (!is_due(body.output)) continue;
    for (const DeformableMesh& mesh : m_session->meshes()) {
      if (mesh.name() == body.setup.name) write_mesh(file_of(body.output), mesh.shape());
    }
  }
  if (is_due(output.forces)) write_force_table(path_of(output.forces), *m_session);
  if (is_due(output.motion)) write_motion_table(path_of(output.motion), *m_session);
}

}  // namespace supple::tools

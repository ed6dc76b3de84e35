#include "tools/scene/file/scene.h"

#include <algorithm>

#include "lib/material/material_file.h"
#include "tools/scene/file/cut_keys.h"
#include "tools/scene/file/handle_keys.h"
#include "tools/scene/file/model_keys.h"
#include "tools/scene/file/transfer_file.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/table.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/open_volume.h"

namespace supple::tools {

namespace {

RelaxParams read_relax(Table& table) {
  RelaxParams params;
  table.read(fields(params));
  if (params.bulk_modulus_kpa > 0 && params.poisson) {
    table.fail("poisson", "poisson beside bulk_modulus", "one of them");
  }
  if (params.conserves_volume() && !conserves_volume(params.method)) {
    table.fail(params.poisson ? "poisson" : "bulk_modulus",
               std::string("method \"") + name_of(params.method) + "\"",
               "method \"red-black\" or \"accelerated\"");
  }
  table.finish();
  return params;
}

/// Reads the removed and the rigid parts.
void read_parts(Table& table, const LabelNames& names, Step& step) {
  for (Table& part : table.table_or_tables("remove")) {
    step.remove.push_back(read_part(part, names));
    part.finish();
  }
  for (Table& part : table.table_or_tables("rigid")) {
    step.rigid.parts.push_back(read_part(part, names));
    part.finish();
  }
  const auto seeds = table.rows("rigid_seeds", {3}, "a list of voxels [i, j, k]");
  for (std::size_t n = 0; seeds && n < seeds->size(); ++n) {
    step.rigid.seeds.push_back(to_box(table, "rigid_seeds", (*seeds)[n]).lo);
  }
}

Retraction read_retraction(Table& table) {
  Retraction retraction;
  retraction.place = table.place();
  table.read(fields(retraction));
  require_area(table, retraction.edge1, retraction.edge2);
  table.finish();
  return retraction;
}

}  // namespace

MaterialTable read_material_choice(Table& table, const LabelNames& names, std::string* path) {
  const auto file = table.path("table");
  if (!file) return read_material_table(table, names);
  table.finish();
  if (path != nullptr) *path = *file;
  return read_material(*file, names);
}

Step read_step(Table& table, const LabelNames& names) {
  Step step;
  step.place = table.place();
  for (Table& handle : table.tables("handles")) {
    step.drags.push_back(read_handle(handle, names));
    handle.finish();
  }
  const bool is_short = has_handle(table);
  if (is_short && !step.drags.empty()) {
    table.fail("grab", "grab beside handles", "either the short form or handles");
  }
  const auto rows = table.rows("fix", {3, 6}, "a list of [i, j, k] or [i0, j0, k0, i1, j1, k1]");
  if (rows) {
    for (const auto& row : *rows) step.fix.push_back(to_box(table, "fix", row));
  }
  for (const std::string& path : table.paths("fix_points")) {
    step.fix.emplace_back().placed.emplace().points = read_point_file(path);
  }
  for (const std::int32_t label : read_labels(table, "fix_label", names)) {
    step.fix.emplace_back().label = label;
  }
  for (Table& anchor : table.table_or_tables("anchors")) {
    step.fix.emplace_back().placed = read_anchor(anchor, names);
    anchor.finish();
  }
  read_parts(table, names, step);
  StepKeys keys;
  table.read(fields(step, keys));
  if (keys.fix_density) {
    PlacedSelection& bone = step.fix.emplace_back().placed.emplace();
    bone.place = table.place("fix_density");
    bone.density = keys.fix_density;
  }
  if (step.rigid.joint_mm > 0 && step.rigid.parts.empty() && step.rigid.seeds.empty()) {
    table.fail("joint", "no rigid or rigid_seeds beside it", "pieces that the joint is around");
  }
  if (step.shift_pieces && step.turn_pieces) {
    table.fail("turn_pieces", "turn_pieces beside shift_pieces", "one of them");
  }
  read_model(table, names, keys.model, step);
  for (Table& cut : table.tables("cut")) step.cuts.push_back(read_cut(cut, names));
  for (Table& patch : table.table_or_tables("retract")) {
    step.retract.push_back(read_retraction(patch));
  }
  if (auto relax = table.table("relax")) {
    if (step.no_relax) table.fail("no_relax", "no_relax beside relax", "one of them");
    step.relax = read_relax(*relax);
  }
  if (auto material = table.table("material")) {
    step.material = read_material_choice(*material, names);
  }
  table.finish();
  if (is_short) step.drags.push_back(read_handle(table, names));
  if (step.does_nothing()) {
    table.fail("", "a step that does nothing",
               "grab, handles, fix, fix_label, fix_points, cut, remove, rigid, retract, relax, "
               "model, material, release, turn_pieces "
               "or limits");
  }
  return step;
}

namespace {

void require_motion(const Scene& scene) {
  if (scene.output.motion.empty()) return;
  if (has_frame_number(scene.output.motion)) {
    throw InputError({scene.file, "output.motion", scene.output.motion,
                      "a name without a number, as one table has all times"});
  }
  for (const Step& step : scene.steps) {
    if (step.fem && step.fem->motion) return;
  }
  throw InputError({scene.file, "output.motion", "no motion in time",
                    "a step with model = \"fem\" and fem = { motion = { ... } }"});
}

/// Steps of finite elements hand their nodes to a motion that follows.
void keep_nodes(std::vector<Step>& steps) {
  for (std::size_t n = 1; n < steps.size(); ++n) {
    const bool is_motion = steps[n].fem && steps[n].fem->motion;
    if (is_motion && steps[n - 1].fem) steps[n - 1].fem->keeps_nodes = true;
  }
}

/// The last step of finite elements has to say what the outputs want of its elements.
void ask_for_elements(Scene& scene) {
  if (scene.output.elements.empty()) return;
  const auto step = std::find_if(scene.steps.rbegin(), scene.steps.rend(),
                                 [](const Step& one) { return one.fem.has_value(); });
  if (step == scene.steps.rend()) {
    throw InputError({scene.file, scene.output.elements.front().table, "no step of finite elements",
                      "a step with model = \"fem\""});
  }
  for (const ElementOutput& output : scene.output.elements) {
    step->fem->wanted.push_back(output.quantity);
  }
}

/// Lengthens the film to the time of a key, unless it has a number of frames.
void stretch(Film& film, bool has_frames, double time) {
  if (!has_frames) film.frames = std::max(film.frames, film.frames_until(time));
}

/// The frames show the motion of a step evenly over its time.
void spread_motion(Scene& scene, std::size_t number, const Film& film) {
  Step& step = scene.steps[number];
  const auto refuse = [&](const char* field, const char* found, const char* expected) {
    throw InputError({step.place, field, found, expected});
  };
  if (film.frames == 0) refuse("film", "a motion in time and no frames", "film.frames");
  if (number + 1 < scene.steps.size())
    refuse("motion", "steps after it in a film", "the last step");
  for (const Step& any : scene.steps) {
    if (any.is_animated()) refuse("motion", "handles that follow a path", "one of them in a film");
  }
  MotionStep& motion = *step.fem->motion;
  for (int frame = 0; frame < film.frames; ++frame) {
    motion.frame_times_s.push_back(motion.time_s * frame / std::max(1, film.frames - 1));
  }
}

void read_film(Table& table, Scene& scene) {
  Film film;
  table.read(fields(film));
  table.finish();
  const bool has_frames = film.frames > 0;
  for (const Step& step : scene.steps) {
    for (const Drag& handle : step.drags) {
      if (handle.is_animated()) stretch(film, has_frames, handle.placed->path.back().time);
    }
  }
  for (std::size_t n = 0; n < scene.steps.size(); ++n) {
    if (scene.steps[n].fem && scene.steps[n].fem->motion) spread_motion(scene, n, film);
  }
  for (SceneView& view : scene.views) {
    if (!view.camera_keys.empty()) stretch(film, has_frames, view.camera_keys.back().time);
  }
  if (film.frames == 0) table.fail_missing("frames", "how many, or keys with times in a path");
  for (int frame = 0; frame < film.frames; ++frame) film.frames_to_make.push_back(frame);
  for (SceneView& view : scene.views) {
    if (view.after_step) {
      throw InputError({view.place, "after_step", "a step in a film", "a film of all steps"});
    }
    view.picture.film = film.frames;
    view.picture.frames_per_second = film.frames_per_second;
  }
  scene.film = film;
}

/// Paths need a film's times.
void require_film(const Scene& scene) {
  for (const SceneView& view : scene.views) {
    if (view.camera_keys.empty()) continue;
    throw InputError({view.camera_keys.front().place, "camera_path", "a path without a film",
                      "a table [film] beside it"});
  }
}

/// Describes all that results depend on, but for the contents of the volume, its labels and meshes.
std::string description_of(const Scene& scene, const std::string& text) {
  std::string all = text;
  if (scene.material) all += material_to_toml(*scene.material);
  for (const SceneView& view : scene.views) {
    if (view.transfer) all += to_toml(*view.transfer);
    if (view.camera.camera) all += to_toml(*view.camera.camera);
  }
  return all;
}

}  // namespace

bool Scene::films_motion() const {
  return film && !steps.empty() && steps.back().fem && steps.back().fem->motion;
}

std::size_t Scene::still_steps() const {
  const auto first =
      std::find_if(steps.begin(), steps.end(), [](const Step& step) { return step.is_animated(); });
  return std::size_t(first - steps.begin());
}

std::vector<std::string> Scene::outputs_of(int frame) const {
  std::vector<std::string> paths;
  for (const SceneView& view : views) {
    const std::vector<std::string> files = frame_files(view.picture, view.image, frame);
    paths.insert(paths.end(), files.begin(), files.end());
  }
  for (const std::string& name : output.all()) {
    if (has_frame_number(name) || frame == film->frames - 1) {
      paths.push_back(frame_name(name, frame));
    }
  }
  return paths;
}

std::vector<std::string> Scene::outputs() const {
  std::vector<std::string> paths;
  if (film) {
    for (const int frame : film->frames_to_make) {
      const std::vector<std::string> files = outputs_of(frame);
      paths.insert(paths.end(), files.begin(), files.end());
    }
    for (const SceneView& view : views) {
      const std::string& video = view.picture.video;
      if (film->makes_videos && !video.empty()) paths.push_back(video);
    }
    return paths;
  }
  for (const SceneView& view : views) {
    const std::vector<std::string> files = picture_files(view.picture, view.image);
    paths.insert(paths.end(), files.begin(), files.end());
  }
  const std::vector<std::string> names = output.all();
  paths.insert(paths.end(), names.begin(), names.end());
  return paths;
}

Fields fields(Step& step, StepKeys& keys) {
  return {
      Field("model", keys.model, {"ecm", "springs", "fem"},
            "What moves the body: Enhanced ChainMail, springs, or finite elements "
            "(docs/models)"),
      Field("limits", step.limits, {"box", "ball", "tighten"},
            "box: each component of a link; ball: its length, order-dependent; tighten: box, and "
            "narrower across stretched links"),
      Field("fix_density", keys.fix_density, "Elements of these densities stay where they are"),
      Field("rigid_density", step.rigid.density,
            "Connected parts of these densities move as rigid pieces"),
      Field("joint", step.rigid.joint_mm, "Part the tissue between pieces that are so near")
          .unit("mm")
          .at_least(0),
      Field("no_relax", step.no_relax, "Leave drags unrelaxed, whatever the material asks for"),
      Field("shift_pieces", step.shift_pieces,
            "Rigid pieces that nothing holds only shift with these drags, which is found sooner; "
            "they turn in the next step of ECM without it")
          .only_in_scenes(),
      Field("turn_pieces", step.turn_pieces, "Turn them now, with nothing else in the step")
          .only_in_scenes(),
      Field("release", step.release, "Let go of everything that is held or fixed"),
  };
}

Scene read_scene(const std::string& path) {
  return read_scene(Table::read(path));
}

Scene read_scene(Table root) {
  Scene scene;
  scene.file = root.file();

  root.know({"volume", "labels", "material", "step", "view", "path", "output", "film", "event"});
  scene.has_events = root.has("event");
  Table volume = root.require(root.table("volume"), "volume", "a table [volume] with a path");
  volume.know({"path", "offsets"});
  volume.read(fields(scene.read));
  scene.volume_path = volume.require(volume.path("path"), "path", "the path of a volume");
  scene.warp_path = volume.path("offsets").value_or("");
  volume.finish();

  LabelNames& names = scene.label_names;
  if (auto labels = root.table("labels")) {
    scene.labels_path = labels->require(labels->path("path"), "path", "the path of a volume");
    labels->finish();
    names = label_names(scene.labels_path);
  }
  if (auto material = root.table("material")) {
    scene.material = read_material_choice(*material, names, &scene.material_path);
  }
  for (Table& step : root.tables("step")) {
    scene.steps.push_back(read_step(step, names));
  }
  const int steps = int(scene.steps.size());
  for (Table& view : root.tables("view")) scene.views.push_back(read_view(view, steps));
  scene.path = read_path(root);
  if (auto output = root.table("output")) scene.output = read_output(*output);
  ask_for_elements(scene);
  keep_nodes(scene.steps);
  require_motion(scene);
  if (auto film = root.table("film")) {
    read_film(*film, scene);
  } else {
    require_film(scene);
  }
  root.finish();
  scene.described = description_of(scene, json_text(root.value()));
  scene.warnings = root.warnings();
  return scene;
}

}  // namespace supple::tools

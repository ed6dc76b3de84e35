#include "tools/scene/file/scene.h"

#include <algorithm>

#include "lib/material/material.h"
#include "raycast/scene/transfer_file.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/table.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/label_file.h"
#include "volumes/io/mesh/mesh_writer.h"

namespace supple::tools {

Fields fields(SceneBody& body) {
  Fields all = supple::fields(body.setup);
  all.push_back(Field("output", body.output, "Mesh to write after the last step")
                    .shown_as("FILE")
                    .otherwise(""));
  return all;
}

std::vector<SceneBody> read_bodies(Table& root) {
  std::vector<SceneBody> bodies;
  for (Table& table : root.tables("body")) {
    SceneBody body;
    body.setup.place = table.place();
    table.read(fields(body));
    const std::string& name = body.setup.name;
    if (name.empty()) table.fail("name", "an empty name", "one by which steps name the body");
    if (body.setup.path.empty()) table.fail_missing("path", "the path of a mesh");
    const bool is_twice = std::any_of(bodies.begin(), bodies.end(), [&](const SceneBody& other) {
      return other.setup.name == name;
    });
    if (is_twice) table.fail("name", "\"" + name + "\" twice", "a name of its own");
    if (!body.output.empty()) {
      require_mesh_name(body.output, table.place("output"), table.full_name("output"));
    }
    table.finish();
    bodies.push_back(std::move(body));
  }
  return bodies;
}

void add_bodies(const std::vector<SceneBody>& bodies, Session& session) {
  for (const SceneBody& body : bodies) session.add(body.setup);
}

std::vector<std::string> SceneOutput::all() const {
  std::vector<std::string> names;
  if (!state.empty()) names.push_back(state);
  for (const auto* list : {&offsets, &displacements, &volumes}) {
    names.insert(names.end(), list->begin(), list->end());
  }
  for (const ElementOutput& output : elements) names.push_back(output.path);
  for (const std::string* table : {&forces, &motion}) {
    if (!table->empty()) names.push_back(*table);
  }
  return names;
}

SceneOutput read_output(Table& table) {
  SceneOutput output;
  output.state = table.get<std::string>("state").value_or("");
  output.refers = table.get<bool>("refer").value_or(false);
  output.offsets =
      table.get<std::vector<std::string>>("offsets").value_or(std::vector<std::string>{});
  output.displacements =
      table.get<std::vector<std::string>>("displacements").value_or(std::vector<std::string>{});
  output.volumes =
      table.get<std::vector<std::string>>("volumes").value_or(std::vector<std::string>{});
  output.forces = table.get<std::string>("forces").value_or("");
  output.motion = table.get<std::string>("motion").value_or("");
  if (auto elements = table.table("elements")) {
    for (const auto& [quantity, name] : kFemQuantities) {
      if (const auto path = elements->get<std::string>(std::string(name))) {
        output.elements.push_back({quantity, *path, table.full_name("elements")});
      }
    }
    elements->finish();
  }
  if (output.refers && output.state.empty()) table.fail("refer", "no state", "state beside it");
  table.finish();
  return output;
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
  for (const std::string& name : written()) {
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
  const std::vector<std::string> names = written();
  paths.insert(paths.end(), names.begin(), names.end());
  return paths;
}

std::vector<std::string> Scene::written() const {
  std::vector<std::string> names = output.all();
  for (const SceneBody& body : bodies) {
    if (!body.output.empty()) names.push_back(body.output);
  }
  return names;
}

Scene read_scene(const std::string& path) {
  return read_scene(Table::read(path));
}

void read_subject(Table& root, Scene& scene) {
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
  keep_nodes(scene.steps);
  for (Table& view : root.tables("view")) scene.views.push_back(read_view(view, steps));
}

Scene read_scene(Table root) {
  Scene scene;
  scene.file = root.file();

  root.know(
      {"volume", "labels", "material", "body", "step", "view", "path", "output", "film", "event"});
  scene.has_events = root.has("event");
  scene.bodies = read_bodies(root);
  read_subject(root, scene);
  scene.path = read_path(root);
  if (auto output = root.table("output")) scene.output = read_output(*output);
  ask_for_elements(scene);
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

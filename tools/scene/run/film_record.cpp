#include "tools/scene/run/film_record.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>

#include "tools/scene/run/scene_files.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"
#include "volumes/base/sha256.h"
#include "volumes/base/version.h"

namespace supple::tools {

namespace {

namespace fs = std::filesystem;

SceneOutput output_of(const SceneOutput& output, int frame, bool is_last) {
  SceneOutput named;
  const auto is_due = [&](const std::string& name) {
    return !name.empty() && (is_last || has_frame_number(name));
  };
  if (is_due(output.state)) named.state = frame_name(output.state, frame);
  const auto take = [&](const std::vector<std::string>& names, std::vector<std::string>& taken) {
    for (const std::string& name : names) {
      if (is_due(name)) taken.push_back(frame_name(name, frame));
    }
  };
  take(output.offsets, named.offsets);
  take(output.displacements, named.displacements);
  take(output.volumes, named.volumes);
  for (const ElementOutput& elements : output.elements) {
    if (!is_due(elements.path)) continue;
    named.elements.push_back({elements.quantity, frame_name(elements.path, frame), elements.table});
  }
  return named;
}

/// Identity of everything that decides on the pictures, but for the contents of the volume, its
/// labels and meshes.
std::string identity_of(const Scene& scene) {
  const std::string all = std::string(kVersion) + scene.described;
  return sha256_hex(all.data(), all.size());
}

bool is_made(const Scene& scene, const std::string& folder, int frame) {
  const std::vector<std::string> files = scene.outputs_of(frame);
  return std::all_of(files.begin(), files.end(), [&](const std::string& name) {
    return fs::is_regular_file(path_in(folder, name));
  });
}

}  // namespace

void plan_film(const Scene& scene, const std::string& folder, OutputPlan& plan) {
  const Film& film = *scene.film;
  for (const int frame : film.frames_to_make) {
    for (const SceneView& view : scene.views) {
      plan.add_files(frame_files(view.picture, path_in(folder, view.image), frame));
    }
    plan_outputs(output_of(scene.output, frame, frame == film.frames - 1), folder, plan);
  }
  if (!film.makes_videos) return;
  for (const SceneView& view : scene.views) {
    if (!view.picture.video.empty()) plan.add_files({path_in(folder, view.picture.video)});
  }
}

std::vector<int> frames_of(const std::string& text, const Film& film) {
  if (text.empty()) return film.frames_to_make;
  std::smatch match;
  static const std::regex pattern("([0-9]{1,5})(:([0-9]{1,5}))?");
  const auto refuse = [&] {
    throw UsageError(to_line({"", "--frames", "'" + text + "'",
                              "A:B or N, from 0 to " + std::to_string(film.frames - 1)}));
  };
  if (!std::regex_match(text, match, pattern)) refuse();
  const int first = std::stoi(match[1]), last = match[3].matched ? std::stoi(match[3]) : first;
  if (first > last || last >= film.frames) refuse();
  std::vector<int> frames;
  for (int frame = first; frame <= last; ++frame) frames.push_back(frame);
  return frames;
}

void leave_out_made(Scene& scene, const std::string& folder) {
  Film& film = *scene.film;
  std::vector<int> missing;
  for (const int frame : film.frames_to_make) {
    if (!is_made(scene, folder, frame)) missing.push_back(frame);
  }
  if (missing.size() < film.frames_to_make.size()) {
    const std::string path = film_record_path(scene, folder);
    const Value record = json_or_null(text_of_file(path));
    const bool has_record = record.contains("scene");
    if (record["scene"] != Value(identity_of(scene))) {
      throw InputError({path, "scene", has_record ? "frames of another scene or version" : "none",
                        "the scene that made the frames; --force makes all anew"});
    }
  }
  const auto lacks = [&](const SceneView& view) {
    const std::string& video = view.picture.video;
    return !video.empty() && !fs::is_regular_file(path_in(folder, video));
  };
  film.makes_videos =
      film.makes_videos &&
      (!missing.empty() || std::any_of(scene.views.begin(), scene.views.end(), lacks));
  film.frames_to_make = std::move(missing);
}

std::string film_record_path(const Scene& scene, const std::string& folder) {
  return path_in(folder, fs::path(scene.file).stem().string() + ".film.json");
}

void write_film_record(const Scene& scene, const std::string& folder) {
  const std::string path = film_record_path(scene, folder);
  const Value record = {{"program", std::string("supple ") + kVersion},
                        {"scene", identity_of(scene)},
                        {"frames", scene.film->frames}};
  AtomicFile file(path);
  std::ofstream(file.path()) << json_text(record, 2) << "\n";
  file.commit();
}

}  // namespace supple::tools

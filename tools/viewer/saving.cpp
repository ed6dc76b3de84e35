#include "tools/viewer/saving.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>

#include "lib/state/state_outputs.h"
#include "raycast/scene/transfer_file.h"
#include "tools/scene/file/measure.h"
#include "tools/scene/live/replay.h"
#include "tools/scene/pictures/picture_writer.h"
#include "tools/scene/run/slice_pictures.h"
#include "tools/scene/run/view_pictures.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/text.h"
#include "volumes/base/toml.h"
#include "volumes/base/value.h"

namespace supple::tools {

namespace {

namespace fs = std::filesystem;

struct SaveKind {
  const char* name;
  std::vector<std::string> extensions;
};

const std::vector<SaveKind>& save_kinds() {
  static const std::vector<SaveKind> kinds = {
      {"state", {".vdb"}},
      {"scene", {".toml"}},
      {"journal", {".toml"}},
      {"measures", {".csv"}},
      {"camera", {".toml"}},
      {"transfer", {".toml"}},
      {"screenshot", {".png"}},
      {"slices", {".png"}},
      {"warp", {".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz", ".h5", ".vdb"}},
      {"volume", {".nrrd", ".nhdr", ".mha", ".mhd", ".nii", ".nii.gz"}},
      {"turntable", {".png", ".mp4", ".webm", ".avi"}},
      {"film", {".png", ".mp4", ".webm", ".avi"}}};
  return kinds;
}

void check_extension(const Table& table, const SaveRequest& request) {
  for (const SaveKind& kind : save_kinds()) {
    if (kind.name != request.what) continue;
    const bool fits =
        std::any_of(kind.extensions.begin(), kind.extensions.end(), [&](const std::string& end) {
          return request.path != end && ends_with(request.path, end);
        });
    std::string expected;
    for (const std::string& end : kind.extensions) expected += (expected.empty() ? "" : ", ") + end;
    if (!fits) table.fail("path", request.path, "a name that ends in " + expected);
  }
}

void write_text(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  std::ofstream out(file.path(), std::ios::binary);
  if (!(out << text << std::flush)) throw_write_error(path, errno);
  file.commit();
}

/// The camera turned around the axis through the target along what is up.
Camera turned(const Camera& camera, double angle) {
  const CameraFrame frame = camera_frame(camera);
  const Vec3d from = camera.position_lps_mm - camera.target_lps_mm;
  const Vec3d& axis = frame.up;
  const Vec3d along = axis * axis.dot(from), across = from - along;
  Camera next = camera;
  next.up_lps = axis;
  next.position_lps_mm = camera.target_lps_mm + along + across * std::cos(angle) +
                         axis.cross(across) * std::sin(angle);
  return next;
}

bool is_series(const std::string& what) {
  return what == "turntable" || what == "film";
}

void require_free(const PictureSeries& series, int length, const SaveRequest& request) {
  if (request.force) return;
  for (const std::string& path : series.files(length)) {
    if (fs::exists(fs::symlink_status(path))) {
      throw InputError({path, "path", "a file that exists", "another name, or force"});
    }
  }
}

void add_turntable(OpenScene& scene, const SaveRequest& request, PictureSeries& series) {
  constexpr double kTurn = 6.283185307179586;
  const Camera camera = *scene.picture().view().camera.camera;
  Progress& progress = scene.outlets().progress;
  progress.stage("turntable");
  for (int n = 0; n < request.frames; ++n) {
    report(&progress, double(n) / request.frames);
    series.add(
        scene.picture().shot(turned(camera, kTurn * n / request.frames), request.size, nullptr));
  }
}

/// Replays all that was carried out so far, from the beginning, in a session of its own.
Replay replay_of(OpenScene& scene, const SaveRequest& request) {
  ReplayOptions options;
  options.size = request.size;
  options.speed = request.speed;
  options.frames_per_second = request.frames_per_second;
  return {Table(scene.live().journal(), "journal"), options, scene.outlets().console,
          scene.outlets().progress};
}

/// Returns how large its files are.
std::uintmax_t save_series(OpenScene& scene, const SaveRequest& request) {
  PictureSeries series(request.path, request.frames_per_second, "save");
  int length = request.frames;
  if (request.what == "film") {
    Replay replay = replay_of(scene, request);
    length = replay.film_length();
    require_free(series, length, request);
    replay.film([&](const Image& image) { series.add(image); });
  } else {
    require_free(series, length, request);
    add_turntable(scene, request, series);
  }
  series.commit();
  std::uintmax_t bytes = 0;
  for (const std::string& path : series.files(length)) bytes += fs::file_size(path);
  return bytes;
}

void save_slices(OpenScene& scene, const SaveRequest& request) {
  const State& state = scene.picture().opened();
  const SliceSettings& slices = scene.settings().slices;
  SliceChoice choice;
  choice.at = slices.cursor;
  choice.window = {slices.level - slices.window / 2, slices.level + slices.window / 2};
  choice.outline = slices.outline;
  Decoration decoration;
  decoration.annotate = {"all"};
  const bool deformed = scene.settings().deformed();
  const OffsetField* offsets =
      deformed ? &scene.live().session().pose(&scene.outlets().progress).offsets : nullptr;
  const SliceSource source{state.geometry, state.density, deformed ? &state.elements : nullptr,
                           offsets, state.elements};
  write_png(request.path, to_image(draw_slices(source, choice, decoration)));
}

void save_screenshot(OpenScene& scene, const SaveRequest& request) {
  if (request.view == 0) {
    const Camera camera = *scene.picture().view().camera.camera;
    return write_png(request.path,
                     scene.picture().shot(camera, request.size, &scene.outlets().progress));
  }
  const RestPlaceAt rest = scene.picture().rest_places(true);
  write_png(request.path, scene.pane_of(request.view, request.size, rest, 1).image);
}

void save_dense(OpenScene& scene, const SaveRequest& request) {
  Session& session = scene.live().session();
  Progress* progress = &scene.outlets().progress;
  const Pose& pose = session.pose(progress);
  if (request.what == "volume") {
    write_resampled(request.path, session.state(), pose, session.geometry(), {}, progress);
    return;
  }
  write_state_warp({request.path, request.direction, VoidMode::nearest, session.geometry(), {}},
                   session.state(), pose, progress);
}

void write_what(OpenScene& scene, const SaveRequest& request) {
  LiveSession& live = scene.live();
  const std::string& what = request.what;
  if (what == "state") return live.session().write_state(request.path, &scene.outlets().progress);
  if (what == "scene") return write_text(request.path, toml_document(live.batch_scene()));
  if (what == "journal") return write_text(request.path, toml_document(live.journal()));
  if (what == "measures") {
    return write_text(request.path,
                      measures_csv(live.history().measures(), scene.picture().displacement()));
  }
  const SceneView& view = scene.picture().view();
  if (what == "camera") return write_text(request.path, to_toml(*view.camera.camera));
  if (what == "transfer") return write_text(request.path, to_toml(look_of(view)));
  if (what == "screenshot") return save_screenshot(scene, request);
  if (what == "slices") return save_slices(scene, request);
  save_dense(scene, request);
}

}  // namespace

Fields fields(SaveRequest& request) {
  std::vector<std::string> names;
  for (const SaveKind& kind : save_kinds()) names.emplace_back(kind.name);
  return {
      Field("what", request.what, "What is saved").one_of(names).required(),
      Field("force", request.force, "Overwrite existing outputs"),
      Field("size", request.size, "Pixels").range(1, 16384),
      Field("direction", request.direction, {"resample", "material"},
            "resample: out(x) = in(x + o(x)); material: voxel X moves to X + u(X)"),
      Field("frames", request.frames, "Pictures of a turn").range(1, 3600),
      Field("frames_per_second", request.frames_per_second, "Of a video, and of a film")
          .range(1, 240),
      Field("speed", request.speed, "Of a film, times that of the session").range(0.1, 100),
  };
}

SaveRequest save_request(Table& table, const Folders& folders) {
  SaveRequest request;
  table.know({"path", "view"});
  table.read(fields(request));
  const std::string view = table.get<std::string>("view").value_or("3d");
  const auto named = std::find(kViewNames.begin(), kViewNames.end(), view);
  if (named == kViewNames.end()) table.fail("view", view, "3d, axial, coronal or sagittal");
  request.view = int(named - kViewNames.begin());
  request.path =
      folders.output(table.require(table.get<std::string>("path"), "path", "a file's name"));
  table.finish();
  check_extension(table, request);
  if (is_series(request.what)) PictureSeries(request.path, request.frames_per_second, "save");
  if (!request.force && fs::exists(fs::symlink_status(request.path))) {
    table.fail("path", request.path + " exists", "another name, or force");
  }
  return request;
}

Value save(OpenScene& scene, const SaveRequest& request) {
  const bool holds_all =
      request.what == "state" || request.what == "scene" || request.what == "journal";
  if (is_series(request.what)) {
    return {{"path", request.path}, {"bytes", save_series(scene, request)}};
  }
  write_what(scene, request);
  if (holds_all) scene.saved();
  std::error_code error;
  const auto bytes = fs::file_size(request.path, error);
  return {{"path", request.path}, {"bytes", error ? 0 : bytes}};
}

}  // namespace supple::tools

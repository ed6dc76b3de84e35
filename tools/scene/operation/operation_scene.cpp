#include "tools/scene/operation/operation_scene.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "lib/contact/mesh_surface.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/operation/operated_volume.h"
#include "tools/scene/operation/operation_keys.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/base/units.h"

namespace supple::tools {

namespace {

constexpr int kSettledShadowSamples = 16;

InstrumentTrack made_track(Table& table, const std::optional<Vec3d>& incision_mm) {
  HandKeys hand;
  double before_s = -HUGE_VAL;
  for (Table& row : table.tables("way")) {
    WayKeys key;
    row.read(fields(key));
    if (!row.has("axis") && incision_mm && *incision_mm != key.pose.tip_mm) {
      key.pose.axis = *incision_mm - key.pose.tip_mm;
    }
    if (key.pose.axis.length() == 0) row.fail("axis", "[0, 0, 0]", "a direction");
    key.pose.axis.normalize();
    if (key.time_s <= before_s) {
      row.fail("time", number_text(key.time_s), "a time after " + number_text(before_s));
    }
    before_s = key.time_s;
    row.finish();
    hand.motion.way.push_back({key.time_s, key.pose});
  }
  std::optional<Table> keys = table.table("hand");
  if (!keys) return InstrumentTrack(hand.motion.way);
  keys->read(fields(hand));
  keys->finish();
  hand.motion.seed = std::uint64_t(hand.seed);
  return make_track(hand.motion);
}

std::optional<Vec3d> incision_of(Table& table, const OperationSetup& setup,
                                 const std::string& name) {
  if (name.empty()) return {};
  if (!setup.eye) table.fail("incision", name, "a table [eye], which has incisions");
  std::string known;
  for (const Incision& incision : setup.eye->incisions) {
    if (incision.name == name) return incision.place_mm;
    known += (known.empty() ? "" : ", ") + incision.name;
  }
  table.fail("incision", name, known);
}

/// Reads what only an instrument of own parts has.
InstrumentParts read_parts(Table& table) {
  InstrumentParts own;
  for (Table& row : table.tables("parts")) {
    PartKeys keys;
    row.read(fields(keys));
    row.finish();
    own.parts.push_back(
        {{keys.a_mm, keys.b_mm, keys.radii_mm.first, keys.radii_mm.second}, keys.jaw});
  }
  if (own.parts.empty()) table.fail("kind", "no parts", "parts = [{ a, b, radii }, …]");
  if (auto row = table.table("grip")) {
    GripKeys keys;
    row->read(fields(keys));
    row->finish();
    own.grip = GripZone{{keys.a_mm, keys.b_mm, keys.radius_mm, keys.radius_mm},
                        keys.grips_below_degrees,
                        keys.releases_above_degrees};
  }
  if (auto row = table.table("port")) {
    own.port = standard_port();
    row->read(fields(*own.port));
    if (own.port->outward.length() == 0) row->fail("outward", "[0, 0, 0]", "a direction");
    own.port->outward.normalize();
    row->finish();
  }
  if (auto row = table.table("lamp")) {
    own.lamp = standard_lamp();
    row->read(fields(*own.lamp));
    row->finish();
  }
  return own;
}

void read_instrument(Table& table, OperationScene& scene) {
  OperationTool tool;
  ToolKeys keys;
  InstrumentTrack track;
  table.read(supple::fields(tool.shape));
  table.read(fields(keys));
  if (tool.shape.kind == InstrumentKind::parts) tool.shape.own = read_parts(table);
  for (const char* key : {"parts", "grip", "port", "lamp", "hinge"}) {
    if (tool.shape.kind == InstrumentKind::parts || !table.has(key)) continue;
    table.fail(key, "beside another kind", "it with kind = \"parts\" only");
  }
  tool.shape.own.hinge_mm = keys.hinge_mm;
  tool.incision = keys.incision;
  const std::optional<Vec3d> incision_mm = incision_of(table, scene.setup, tool.incision);
  const bool has_way = table.has("way");
  if (!keys.track.empty() && has_way) table.fail("way", "a way beside a track", "one of them");
  if (keys.track.empty() && !has_way) table.fail_missing("track", "a track, or else a way");
  if (keys.track.empty()) {
    track = made_track(table, incision_mm);
  } else if (table.has("hand")) {
    table.fail("hand", "a hand beside a track", "one along a way");
  } else {
    track = read_track(keys.track);
  }
  table.finish();
  tool.start = track.at(0);
  scene.setup.tools.push_back(std::move(tool));
  scene.tracks.push_back({std::move(track), keys.rgb});
}

void read_eye(Table& table, OperationSetup& setup) {
  EyeSetup eye;
  table.read(supple::fields(eye));
  const std::vector<Table> incisions = table.tables("incisions");
  if (!incisions.empty()) eye.incisions.clear();
  for (Table row : incisions) {
    Incision incision;
    row.read(fields(incision));
    if (incision.place_mm.length() == 0) row.fail("at", "[0, 0, 0]", "a place on the globe");
    row.finish();
    eye.incisions.push_back(incision);
  }
  for (Incision& incision : eye.incisions) {
    incision.place_mm *= eye.radius_mm / incision.place_mm.length();
  }
  table.finish();
  setup.eye = std::move(eye);
}

void read_shape(Table& table, OperationSetup& setup) {
  ShapeKeys keys;
  table.read(fields(keys));
  if (keys.kind != "mesh" && !keys.path.empty()) {
    table.fail("path", "a path of a " + keys.kind, "one with kind = \"mesh\" only");
  }
  if (keys.kind == "mesh" && keys.path.empty()) table.fail_missing("path", "the path of a mesh");
  Obstacle shape{keys.name, SphereShape{keys.at, keys.radius_mm}};
  if (keys.kind == "mesh") {
    shape.surface = MeshShape{std::make_shared<const MeshSurface>(read_mesh(keys.path)), keys.at};
  } else if (keys.kind == "plane") {
    if (keys.normal.length() == 0) table.fail("normal", "[0, 0, 0]", "a direction");
    shape.surface = PlaneShape{keys.at, keys.normal.normalized()};
  } else if (keys.kind == "hollow") {
    shape.surface = HollowSphere{keys.at, keys.radius_mm};
  }
  table.finish();
  setup.shapes.push_back(std::move(shape));
}

/// The generated sheet of a membrane in the eye.
TriangleMesh read_sheet(Table& table, const OperationSetup& setup, const MembraneParams& params) {
  if (!setup.eye) table.fail("sheet", "no eye", "a table [eye], on whose retina it lies");
  SheetKeys keys;
  table.read(fields(keys));
  if (keys.middle.length() == 0) table.fail("middle", "[0, 0, 0]", "a direction");
  table.finish();
  return membrane_on_sphere({0, 0, 0}, setup.eye->radius_mm - params.thickness_mm,
                            keys.middle.normalized(), keys.radius_mm, keys.nodes);
}

std::vector<ModelChange> read_changes(Table& table) {
  std::vector<ModelChange> changes;
  for (Table& row : table.tables("models")) {
    ModelChange change;
    row.read(fields(change));
    row.finish();
    changes.push_back(change);
  }
  return changes;
}

void read_membrane(Table& table, OperationScene& scene) {
  MembraneKeys keys;
  OperationMembrane membrane;
  table.read(fields(keys));
  table.read(supple::fields(membrane.params));
  membrane.name = keys.name;
  std::optional<Table> sheet = table.table("sheet");
  if (!keys.path.empty() && sheet) table.fail("sheet", "a sheet beside a path", "one of them");
  if (keys.path.empty() && !sheet) {
    table.fail_missing("path", "the path of a mesh, or else a sheet");
  }
  membrane.changes = read_changes(table);
  membrane.mesh = sheet ? read_sheet(*sheet, scene.setup, membrane.params)
                        : merge_equal_vertices(read_mesh(keys.path)).mesh;
  table.finish();
  scene.setup.membranes.push_back(std::move(membrane));
  scene.membranes.push_back(keys.look);
}

void read_view(Table& table, OperationScene& scene) {
  MicroscopeView view;
  view.place = table.place();
  table.read(fields(view));
  double before_s = -HUGE_VAL;
  for (Table& row : table.tables("keys")) {
    ViewKey key;
    row.read(fields(key));
    if (key.time_s <= before_s) {
      row.fail("time", number_text(key.time_s), "a time after " + number_text(before_s));
    }
    before_s = key.time_s;
    if (row.has("focus")) view.focus_keys.add(key.time_s, key.focus_mm, Easing::smooth);
    if (row.has("zoom")) view.zoom_keys.add(key.time_s, key.zoom, Easing::smooth);
    row.finish();
    view.camera_at(key.time_s).validate(view.place);
  }
  table.finish();
  view.camera_at(0).validate(view.place);
  scene.views.push_back(std::move(view));
}

/// Events, tasks and files name things by these.
void require_own_names(const OperationScene& scene) {
  std::set<std::string> instruments, places{kRetina, kLens, kBone};
  const auto require_new = [&](std::set<std::string>& names, const std::string& name,
                               const char* of) {
    if (!name.empty() && name.find('/') == std::string::npos && names.insert(name).second) return;
    throw InputError({scene.file, std::string("name of ") + of, "\"" + name + "\"",
                      "a name of its own without \"/\", not \"retina\", \"lens\" or \"bone\""});
  };
  for (const OperationTool& tool : scene.setup.tools) {
    require_new(instruments, tool.shape.name, "an [[instrument]]");
  }
  for (const Obstacle& shape : scene.setup.shapes) require_new(places, shape.name, "a [[shape]]");
  for (const OperationMembrane& membrane : scene.setup.membranes) {
    require_new(places, membrane.name, "a [[body]]");
  }
}

/// The scanned volume, once all that tells the number of frames is there.
void read_volume(Table& root, OperationScene& scene) {
  scene.volume = std::make_shared<Scene>();
  scene.volume->file = scene.file;
  read_subject(root, *scene.volume);
  Film film;
  film.frames = scene.frame_count();
  film.frames_per_second = scene.frames_per_second;
  for (int frame = 0; frame < film.frames; ++frame) film.frames_to_make.push_back(frame);
  for (SceneView& view : scene.volume->views) {
    view.picture.film = film.frames;
    view.picture.frames_per_second = film.frames_per_second;
  }
  scene.volume->film = film;
}

}  // namespace

bool is_operation(Table& root) {
  return root.has("operation");
}

Vec3d MicroscopeView::focus_at(double time_s) const {
  return focus_keys.empty() ? focus_mm : focus_keys.at(time_s);
}

double MicroscopeView::zoom_at(double time_s) const {
  return zoom_keys.empty() ? 1 : zoom_keys.at(time_s);
}

Camera MicroscopeView::camera_at(double time_s) const {
  Camera camera;
  camera.target_lps_mm = focus_at(time_s);
  const double length = from.length();
  camera.position_lps_mm = camera.target_lps_mm + from * (distance_mm / (length > 0 ? length : 1));
  camera.up_lps = up;
  const double half_mm = field_mm / zoom_at(time_s) / 2;
  camera.vertical_fov_degrees = 2 * std::atan(half_mm / distance_mm) * kDegreesPerRadian;
  return camera;
}

MicroscopeSettings MicroscopeView::settings() const {
  MicroscopeSettings settings;
  settings.width = size[0];
  settings.height = size[1];
  settings.ambient = ambient;
  settings.shadow_samples = shadow == ShadowKind::none ? 0 : shadow == ShadowKind::hard ? 1 : 4;
  settings.smooth_edges = smooth_edges;
  settings.haze_part = vitreous_part;
  settings.eyepiece = eyepiece;
  if (!is_settled) return settings;
  if (shadow != ShadowKind::none) settings.shadow_samples = kSettledShadowSamples;
  if (vitreous_part > 0) settings.haze_part = 1;
  settings.smooth_edges = true;
  return settings;
}

std::vector<InstrumentPose> OperationScene::poses_at(double time_s) const {
  std::vector<InstrumentPose> poses;
  for (const ToolTrack& tool : tracks) {
    const double end_s = tool.track.end_s();
    poses.push_back(tool.track.at(repeats && end_s > 0 ? std::fmod(time_s, end_s) : time_s));
  }
  return poses;
}

int OperationScene::step_count() const {
  double end_s = duration_s;
  if (end_s == 0) {
    for (const ToolTrack& tool : tracks) end_s = std::max(end_s, tool.track.end_s());
  }
  return std::max(1, int(std::lround(end_s / setup.step_s)));
}

std::vector<std::string> OperationScene::outputs() const {
  std::vector<std::string> names{output.log, output.score, output.tracks};
  for (const MicroscopeView& view : views) {
    names.push_back(view.image);
    names.push_back(view.video);
  }
  if (volume) {
    const std::vector<std::string> more = volume->outputs();
    names.insert(names.end(), more.begin(), more.end());
  }
  names.erase(std::remove(names.begin(), names.end(), ""), names.end());
  return names;
}

int OperationScene::frame_count() const {
  return std::max(1, int(step_count() * setup.step_s * frames_per_second + 1e-9));
}

OperationScene read_operation(Table root) {
  OperationScene scene;
  scene.file = root.file();
  root.know({"operation", "eye", "instrument", "shape", "body", "vitreous", "task", "score", "view",
             "output", "volume", "labels", "material", "step"});
  Table run = root.require(root.table("operation"), "operation", "a table [operation]");
  RunKeys keys;
  run.read(fields(keys));
  run.finish();
  scene.setup.step_s = keys.step_s;
  scene.setup.seed = std::uint64_t(keys.seed);
  scene.duration_s = keys.duration_s;
  scene.repeats = keys.repeats;
  scene.frames_per_second = keys.frames_per_second;
  if (keys.frames_per_second * keys.step_s > 1 + 1e-9) {
    run.fail("frames_per_second", number_text(keys.frames_per_second),
             "at most one for each step of " + number_text(keys.step_s) + " s");
  }
  if (auto eye = root.table("eye")) read_eye(*eye, scene.setup);
  for (Table& table : root.tables("shape")) read_shape(table, scene.setup);
  for (Table& table : root.tables("instrument")) read_instrument(table, scene);
  for (Table& table : root.tables("body")) read_membrane(table, scene);
  if (auto table = root.table("vitreous")) {
    scene.setup.vitreous.emplace();
    table->read(supple::fields(*scene.setup.vitreous));
    table->finish();
  }
  scene.tasks = read_tasks(root);
  scene.rules = read_score_rules(root);
  if (root.has("volume")) {
    read_volume(root, scene);
  } else {
    for (Table& table : root.tables("view")) read_view(table, scene);
  }
  if (auto table = root.table("output")) {
    table->read(fields(scene.output));
    const std::string& tracks = scene.output.tracks;
    if (!tracks.empty() && tracks.find("%s") == std::string::npos) {
      table->fail("tracks", tracks, "%s in place of the instrument's name");
    }
    table->finish();
  }
  root.finish();
  require_own_names(scene);
  return scene;
}

}  // namespace supple::tools

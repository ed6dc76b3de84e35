#include "tools/scene/operation/operation_scene.h"

#include <algorithm>
#include <cmath>

#include "lib/contact/mesh_surface.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/base/units.h"

namespace supple::tools {

namespace {

/// Keys of [operation].
struct RunKeys {
  double step_s = 0.02, duration_s = 0, frames_per_second = 25;
  bool repeats = false;
  int seed = 1;
};

Fields fields(RunKeys& keys) {
  return {
      Field("step", keys.step_s, "Time of a step").unit("s").positive(),
      Field("duration", keys.duration_s, "Time until the operation ends")
          .unit("s")
          .at_least(0)
          .otherwise("until the last track ends"),
      Field("repeat", keys.repeats, "Tracks begin again when they end"),
      Field("seed", keys.seed, "Seed of generated tissue").at_least(0),
      Field("frames_per_second", keys.frames_per_second, "Pictures of videos per second")
          .positive(),
  };
}

Fields fields(InstrumentPose& pose) {
  return {
      Field("tip", pose.tip_mm, "Place of the tip").unit("mm").required(),
      Field("axis", pose.axis, "Direction from the tip to the hand"),
      Field("roll", pose.roll_degrees, "Turn about the axis").unit("degrees"),
      Field("opening", pose.opening_degrees, "Angle between the jaws").unit("degrees").range(0, 90),
      Field("active", pose.active, "Suction of a vitrector, light of a lamp").range(0, 1),
  };
}

Fields fields(HandMotion& hand) {
  return {
      Field("bandwidth", hand.bandwidth_hz, "Frequency to which the way is smoothed")
          .unit("Hz")
          .positive(),
      Field("tremor", hand.tremor_mm, "Tremor of the tip, root mean square per axis")
          .unit("mm")
          .at_least(0),
      Field("tremor_lowest", hand.tremor_lowest_hz, "Lowest frequency of the tremor")
          .unit("Hz")
          .positive(),
      Field("tremor_highest", hand.tremor_highest_hz, "Highest frequency of the tremor")
          .unit("Hz")
          .positive(),
      Field("sampling", hand.sampling_hz, "Rate of the tracking").unit("Hz").positive(),
      Field("latency", hand.latency_s, "Latency of the tracking").unit("s").at_least(0),
  };
}

InstrumentTrack made_track(Table& table, const std::optional<Vec3d>& incision_mm) {
  HandMotion hand;
  InstrumentPose pose;
  double before_s = -HUGE_VAL;
  for (Table& row : table.tables("way")) {
    double time_s = 0;
    Fields all = fields(pose);
    all.push_back(Field("time", time_s, "Time of the key").unit("s").required());
    row.read(all);
    if (!row.has("axis") && incision_mm && *incision_mm != pose.tip_mm) {
      pose.axis = (*incision_mm - pose.tip_mm).normalized();
    }
    if (pose.axis.length() == 0) row.fail("axis", "[0, 0, 0]", "a direction");
    pose.axis.normalize();
    if (time_s <= before_s) {
      row.fail("time", number_text(time_s), "a time after " + number_text(before_s));
    }
    before_s = time_s;
    row.finish();
    hand.way.push_back({time_s, pose});
  }
  int seed = 1;
  if (auto keys = table.table("hand")) {
    Fields all = fields(hand);
    all.push_back(Field("seed", seed, "Seed of the tremor").at_least(0));
    keys->read(all);
    keys->finish();
  } else {
    return InstrumentTrack(hand.way);
  }
  hand.seed = std::uint64_t(seed);
  return make_track(hand);
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

void read_instrument(Table& table, OperationScene& scene) {
  OperationTool tool;
  ToolTrack track;
  table.read(fields(tool.shape));
  table.read({Field("incision", tool.incision, "Incision of the eye through which it goes"),
              Field("colour", track.rgb, "Colour in pictures")});
  const std::optional<Vec3d> incision_mm = incision_of(table, scene.setup, tool.incision);
  const std::optional<std::string> path = table.path("track");
  if (path && table.has("way")) table.fail("way", "a way beside a track", "one of them");
  if (path) {
    table.know({"hand"});
    if (table.has("hand")) table.fail("hand", "a hand beside a track", "one along a way");
    track.track = read_track(*path);
  } else if (table.has("way")) {
    track.track = made_track(table, incision_mm);
  } else {
    table.fail_missing("track", "a track or a way");
  }
  table.finish();
  tool.start = track.track.at(0);
  scene.setup.tools.push_back(std::move(tool));
  scene.tracks.push_back(std::move(track));
}

void read_eye(Table& table, OperationSetup& setup) {
  EyeSetup eye;
  table.read(supple::fields(eye));
  const std::vector<Table> incisions = table.tables("incisions");
  if (!incisions.empty()) eye.incisions.clear();
  for (Table row : incisions) {
    Incision incision;
    row.read({Field("name", incision.name, "By which instruments name it").required(),
              Field("at", incision.place_mm, "Direction from the centre").required()});
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
  Obstacle shape;
  std::string kind;
  Vec3d at{0, 0, 0}, normal{0, 0, 1};
  double radius_mm = 1;
  table.read(
      {Field("name", shape.name, "By which events name it").required(),
       Field("kind", kind, "What it is").one_of({"sphere", "hollow", "plane", "mesh"}).required(),
       Field("at", at, "Centre, a point of the plane, or the shift of the mesh").unit("mm"),
       Field("normal", normal, "Direction of a plane's free side"),
       Field("radius", radius_mm, "Radius").unit("mm").positive()});
  if (kind == "mesh") {
    const auto path = table.require(table.path("path"), "path", "the path of a mesh");
    shape.surface = MeshShape{std::make_shared<const MeshSurface>(read_mesh(path)), at};
  } else if (kind == "plane") {
    if (normal.length() == 0) table.fail("normal", "[0, 0, 0]", "a direction");
    shape.surface = PlaneShape{at, normal.normalized()};
  } else if (kind == "hollow") {
    shape.surface = HollowSphere{at, radius_mm};
  } else {
    shape.surface = SphereShape{at, radius_mm};
  }
  table.finish();
  setup.shapes.push_back(std::move(shape));
}

/// The generated sheet of a membrane in the eye.
TriangleMesh read_sheet(Table& table, const OperationSetup& setup, const MembraneParams& params) {
  if (!setup.eye) table.fail("sheet", "no eye", "a table [eye], on whose retina it lies");
  Vec3d middle{0, 0, -1};
  double radius_mm = 3;
  int nodes = 1500;
  table.read({Field("middle", middle, "Direction of its middle from the eye's centre"),
              Field("radius", radius_mm, "Radius of the sheet").unit("mm").positive(),
              Field("nodes", nodes, "Least number of nodes").range(7, 100000)});
  if (middle.length() == 0) table.fail("middle", "[0, 0, 0]", "a direction");
  table.finish();
  return membrane_on_sphere({0, 0, 0}, setup.eye->radius_mm - params.thickness_mm,
                            middle.normalized(), radius_mm, nodes);
}

void read_membrane(Table& table, OperationScene& scene) {
  OperationMembrane membrane;
  MembraneLook look;
  std::string kind;
  table.read({Field("kind", kind, "What it is").one_of({"membrane"}).required(),
              Field("name", membrane.name, "By which events and tasks name it").required(),
              Field("colour", look.rgb, "Colour in pictures"),
              Field("opacity", look.opacity, "Opacity in pictures").range(0, 1)});
  table.read(supple::fields(membrane.params));
  const std::optional<std::string> path = table.path("path");
  std::optional<Table> sheet = table.table("sheet");
  if (path.has_value() == sheet.has_value()) {
    table.fail_missing("path", "the path of a mesh, or else a sheet");
  }
  membrane.mesh = path ? merge_equal_vertices(read_mesh(*path)).mesh
                       : read_sheet(*sheet, scene.setup, membrane.params);
  table.finish();
  scene.setup.membranes.push_back(std::move(membrane));
  scene.membranes.push_back(look);
}

void read_view(Table& table, OperationScene& scene) {
  MicroscopeView view;
  view.place = table.place();
  table.read(fields(view));
  for (Table& row : table.tables("keys")) {
    double time_s = 0, zoom = 1;
    Vec3d focus_mm = view.focus_mm;
    row.read({Field("time", time_s, "Time of the key").unit("s").required(),
              Field("focus", focus_mm, "Place that is in focus").unit("mm"),
              Field("zoom", zoom, "Magnification").positive()});
    if (row.has("focus")) view.focus_keys.add(time_s, focus_mm, Easing::smooth);
    if (row.has("zoom")) view.zoom_keys.add(time_s, zoom, Easing::smooth);
    row.finish();
  }
  table.finish();
  view.camera_at(0).validate(view.place);
  scene.views.push_back(std::move(view));
}

}  // namespace

bool is_operation(Table& root) {
  return root.has("operation");
}

Fields fields(MicroscopeView& view) {
  return {
      Field("image", view.image, "Picture of the end").shown_as("F.png").otherwise(""),
      Field("video", view.video, "All of it: .mp4, .webm, .avi or numbered a_%04d.png")
          .shown_as("F")
          .otherwise(""),
      Field("focus", view.focus_mm, "Place that is in focus").unit("mm"),
      Field("from", view.from, "Direction from the focus to the microscope"),
      Field("up", view.up, "Direction that is up in the picture"),
      Field("distance", view.distance_mm, "Distance from the focus").unit("mm").positive(),
      Field("field", view.field_mm, "Height that is seen at the focus").unit("mm").positive(),
      Field("eye_separation", view.eye_separation_mm, "Distance of the eyes of a stereo pair")
          .unit("mm")
          .positive(),
      Field("stereo", view.stereo, {"none", "side_by_side", "anaglyph", "two_streams"},
            "One picture, or a pair and how it is shown"),
      Field("shadow", view.shadow, {"none", "hard", "soft"}, "Shadow of the lamp"),
      Field("size", view.size, "Size of one picture").unit("pixels").range(16, 8192),
      Field("smooth_edges", view.smooth_edges, "Four samples per pixel at edges"),
      Field("vitreous_part", view.vitreous_part,
            "The vitreous is marched at this part of the width; 0: not drawn")
          .range(0, 16),
      Field("ambient", view.ambient, "Light without the lamp").range(0, 1),
  };
}

Fields fields(OperationOutput& output) {
  return {
      Field("log", output.log, "Log of steps and events, JSON lines")
          .shown_as("F.jsonl")
          .otherwise(""),
      Field("score", output.score, "Scores with what was measured")
          .shown_as("F.json")
          .otherwise(""),
      Field("tracks", output.tracks, "Poses that hands asked for, %s being the instrument")
          .shown_as("F_%s.csv")
          .otherwise(""),
  };
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

OperationScene read_operation(Table root) {
  OperationScene scene;
  scene.file = root.file();
  root.know({"operation", "eye", "instrument", "shape", "body", "vitreous", "task", "score", "view",
             "output"});
  Table run = root.require(root.table("operation"), "operation", "a table [operation]");
  RunKeys keys;
  run.read(fields(keys));
  run.finish();
  scene.setup.step_s = keys.step_s;
  scene.setup.seed = std::uint64_t(keys.seed);
  scene.duration_s = keys.duration_s;
  scene.repeats = keys.repeats;
  scene.frames_per_second = keys.frames_per_second;
  if (auto eye = root.table("eye")) read_eye(*eye, scene.setup);
  for (Table& table : root.tables("shape")) read_shape(table, scene.setup);
  for (Table& table : root.tables("instrument")) read_instrument(table, scene);
  for (Table& table : root.tables("body")) read_membrane(table, scene);
  if (auto table = root.table("vitreous")) {
    scene.setup.vitreous.emplace();
    table->read(supple::fields(*scene.setup.vitreous));
    table->finish();
  }
  for (Table& table : root.tables("view")) read_view(table, scene);
  if (auto table = root.table("output")) {
    table->read(fields(scene.output));
    table->finish();
  }
  root.finish();
  return scene;
}

}  // namespace supple::tools

#include "tools/scene/file/camera_keys.h"

#include "lib/session/file/handle_keys.h"
#include "lib/session/handles/handles.h"
#include "tools/scene/file/film.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

/// Keys of a camera table that say its position.
struct CameraPosition {
  std::optional<Vec3d> position, target, up;
  std::optional<double> fov, height;

  /// True if there is more than a named view may have.
  bool is_given() const { return position || target || up; }
};

Fields camera_fields(CameraChoice& choice, CameraPosition& given) {
  return {
      Field("projection", choice.projection, {"perspective", "orthographic"}, "Of the rays"),
      side_field(choice.view),
      Field("position", given.position, "Of the eye, in LPS mm, instead of a side"),
      Field("target", given.target, "What it looks at, in LPS mm"),
      Field("up", given.up, "Upwards in the picture, in LPS").otherwise("[0, 0, 1]"),
      Field("fov", given.fov, "Vertical angle of a perspective picture")
          .unit("degrees")
          .otherwise("30"),
      Field("height", given.height, "Of an orthographic picture").unit("mm").otherwise("300"),
  };
}

CameraChoice checked(const Table& table, CameraChoice choice, const CameraPosition& given,
                     bool has_view) {
  const bool perspective = choice.projection == Projection::perspective;
  if (perspective && given.height) table.fail("height", "height", "fov for a perspective camera");
  if (!perspective && given.fov) table.fail("fov", "fov", "height for an orthographic camera");
  Camera camera;
  if (!given.is_given()) {
    choice.fov_degrees = given.fov;
    choice.height_mm = given.height;
    camera.vertical_fov_degrees = given.fov.value_or(camera.vertical_fov_degrees);
    camera.height_mm = given.height.value_or(camera.height_mm);
    camera.validate(table.place());
    return choice;
  }
  if (has_view) {
    table.fail("view", "view beside position", "a named view or a position, not both");
  }
  camera.projection = choice.projection;
  camera.position_lps_mm = table.require(given.position, "position", "three numbers in LPS mm");
  camera.target_lps_mm = table.require(given.target, "target", "three numbers in LPS mm");
  camera.up_lps = given.up.value_or(camera.up_lps);
  camera.vertical_fov_degrees = given.fov.value_or(camera.vertical_fov_degrees);
  camera.height_mm = given.height.value_or(camera.height_mm);
  camera.validate(table.place());
  choice.camera = camera;
  return choice;
}

CameraChoice read_camera(Table table) {
  CameraChoice choice;
  CameraPosition given;
  table.read(camera_fields(choice, given));
  table.finish();
  return checked(table, choice, given, table.has("view"));
}

/// The camera of a key that names a side or a position, seen as `start` is.
CameraKey read_camera_key(Table& table, const CameraChoice& start) {
  CameraKey key;
  key.place = table.place();
  table.read(fields(key));
  table.finish();
  if (key.up && !key.position) table.fail_missing("position", "three numbers in LPS mm");
  const bool has_place = key.position || key.target || !key.view.empty();
  if (!has_place && !key.fov && !key.height && !key.turn_deg && !key.zoom) {
    table.fail_missing("view", "view, position and target, fov, height, turn or zoom");
  }
  CameraChoice choice = start;
  choice.camera.reset();
  if (!key.view.empty()) choice.view = key.view;
  CameraPosition position{key.position, key.target, key.up, key.fov, key.height};
  if (choice.projection == Projection::orthographic) {
    if (!key.height) position.height = start.height_mm;
    if (!position.height && key.position && start.camera) position.height = start.camera->height_mm;
  } else if (!key.fov) {
    position.fov = start.camera ? start.camera->vertical_fov_degrees : start.fov_degrees;
  }
  choice = checked(table, choice, position, !key.view.empty());
  if (has_place) key.choice = choice;
  return key;
}

}  // namespace

Field side_field(std::string& side) {
  return Field("view", side, "The side that the volume is seen from")
      .one_of(view_names())
      .also("front", "anterior")
      .also("back", "posterior")
      .also("top", "superior")
      .also("bottom", "inferior")
      .shown_as("SIDE");
}

Fields fields(CameraKey& key) {
  Fields all = key_fields(key.time, key.easing);
  const Fields own = {
      side_field(key.view),
      Field("position", key.position, "Of the eye, in LPS mm, instead of a side"),
      Field("target", key.target, "What it looks at, in LPS mm"),
      Field("up", key.up, "Upwards in the picture, in LPS").otherwise("[0, 0, 1]"),
      Field("fov", key.fov, "Vertical angle of a perspective picture").unit("degrees"),
      Field("height", key.height, "Of an orthographic picture").unit("mm"),
      Field("turn", key.turn_deg,
            "Turn about the patient's axis through the target, to the patient's left first")
          .unit("degrees"),
      Field("zoom", key.zoom, "Magnification").range(0.01, 1000),
  };
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

CameraChoice read_camera_choice(Table& view) {
  if (view.is_string("camera")) return read_camera(view.named_file("camera"));
  if (const auto camera = view.table("camera")) return read_camera(*camera);
  return {};
}

std::vector<CameraKey> read_camera_keys(Table& view, const CameraChoice& start) {
  std::vector<CameraKey> keys;
  for (Table& table : view.tables("camera_path")) {
    keys.push_back(read_camera_key(table, start));
    require_later(table, keys);
  }
  return keys;
}

std::string to_toml(const Camera& camera) {
  const auto list = [](const Vec3d& v) {
    return "[" + exact_text(v.x) + ", " + exact_text(v.y) + ", " + exact_text(v.z) + "]\n";
  };
  const bool perspective = camera.projection == Projection::perspective;
  std::string text = "projection = \"";
  text += perspective ? "perspective\"\n" : "orthographic\"\n";
  text += "position = " + list(camera.position_lps_mm) + "target = " + list(camera.target_lps_mm) +
          "up = " + list(camera.up_lps);
  return text + (perspective ? "fov = " + exact_text(camera.vertical_fov_degrees) + "\n"
                             : "height = " + exact_text(camera.height_mm) + "\n");
}

}  // namespace supple::tools

#include "tools/scene/file/view.h"

#include <algorithm>

#include "lib/session/file/handle_keys.h"
#include "lib/session/handles/handles.h"
#include "raycast/scene/transfer_file.h"
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
  if (is_text(view.find("camera"))) return read_camera(view.named_file("camera"));
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

namespace {

Fields half_space_fields(HalfSpace& half) {
  return {
      Field("point", half.point_lps_mm, "A point in LPS mm").required(),
      Field("normal", half.normal_lps, "A vector in LPS, to what is inside").required(),
  };
}

std::pair<Vec3d, Vec3d> read_corners(Table& table) {
  const auto corners = table.get<std::vector<double>>("box");
  if (corners->size() != 6) {
    table.fail("box", std::to_string(corners->size()) + " numbers",
               "six voxel coordinates [i0, j0, k0, i1, j1, k1]");
  }
  const auto& c = *corners;
  return {Vec3d(c[0], c[1], c[2]), Vec3d(c[3], c[4], c[5])};
}

ClipChoice read_clip(Table& table) {
  ClipChoice choice;
  table.know({"plane", "box"});
  table.read(fields(choice.clip));
  auto plane = table.table("plane");
  if (plane.has_value() == table.has("box")) {
    if (plane) table.fail("box", "plane and box", "one of both");
    table.fail_missing("box", "either plane or box");
  }
  if (plane) {
    HalfSpace half{};
    plane->read(half_space_fields(half));
    plane->finish();
    choice.clip.region = {half};
  } else {
    choice.voxel_corners = read_corners(table);
  }
  table.finish();
  if (plane) choice.clip.validate(table.place());
  return choice;
}

/// Slices have their own place and scale, and nothing but their picture in common with a view in
/// space.
void refuse_beside_slice(const Table& table, const Fields& fields) {
  for (const std::string& key : table.keys()) {
    const bool is_of_slices = key == "slice" || key == "path" || key == "offset" ||
                              std::any_of(fields.begin(), fields.end(), [&](const Field& field) {
                                return field.traits().is_for_slices && field.name() == key;
                              });
    if (!is_of_slices) table.fail(key, key + " beside slice", "one of both");
  }
}

}  // namespace

Fields fields(Clip& clip) {
  return {
      Field("keep", clip.keep, {"inside", "outside"}, "What a clip keeps: inside or outside of it"),
      Field("space", clip.space, {"source", "deformed"},
            "deformed: cut the picture; source: cut the tissue, which takes the cut along"),
  };
}

void Sampling::apply_to(RenderSettings& settings) const {
  settings.set_quality(quality);
  if (step_voxels) settings.set_step(*step_voxels);
  settings.jitter = jitter;
  settings.classification = classification;
}

Fields fields(SceneView& view) {
  Sampling& sampling = view.sampling;
  Fields all = {
      Field("image", view.image,
            "Picture to write: .png, or .exr with depth, normals and offsets as floats")
          .required()
          .shown_as("FILE")
          .for_slices()
          .only_in_scenes(),
      Field("preset", view.preset, "One that `supple presets` lists")
          .only_in_scenes()
          .otherwise("Bone with HU, else MR-Default"),
      Field("after_step", view.after_step, "Draw after this step; 0: before the first")
          .at_least(0)
          .for_slices()
          .only_in_scenes()
          .otherwise("the last"),
      Field("deformed", view.deformed, "Show a state's body at rest")
          .option("undeformed")
          .for_slices(),
      Field("inverse", view.inverse,
            "Samples of a state solve for themselves: less memory, slower"),
      Field("half_offsets", view.half_offsets,
            "Keep every second offset along each axis: a sixth of their memory"),
      Field("lattice", view.lattice, "Draw elements and links (always so for one-slice bodies)"),
      Field("fit", view.fit, "What fills the picture")
          .one_of({"box", "body", "visible"})
          .otherwise("box, or as the camera file"),
      Field("outline", view.outline, "The silhouette of the body at rest"),
      Field("zoom", view.zoom, "Magnification").range(0.01, 1000),
      Field("size", view.size, "Pixels").range(1, 16384).otherwise("1024,1024"),
      Field("quality", sampling.quality, {"draft", "default", "accurate"}, "Speed for accuracy"),
      Field("step", sampling.step_voxels, "Sample distance, not the quality's")
          .unit("voxels")
          .range(0.01, 16),
      sampling_field(sampling.interpolation),
      Field("classification", sampling.classification, {"post", "pre-integrated"},
            "Colours at the samples, or of the way between two"),
      Field("jitter", sampling.jitter, "Fine noise instead of rings"),
      Field("caster", view.caster, {"supple", "vtk"},
            "Whose program casts the rays: vtk draws the resampled volume, to compare with")
          .only_in_scenes(),
      Field("clip_meshes", view.clip_meshes, "Clips of the picture cut meshes, too"),
  };
  for (const Fields& more :
       {fields(view.lighting), fields(view.marks), fields(view.decoration), fields(view.picture)}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

SceneView read_view(Table& table, int steps) {
  SceneView view;
  view.place = table.place();
  table.know({"transfer", "camera", "clip", "light", "mesh", "slice", "path", "camera_path"});
  table.read(fields(view));
  if (table.has("transfer")) {
    if (!view.preset.empty()) table.fail("transfer", "preset and transfer", "one of both");
    if (is_text(table.find("transfer"))) {
      view.transfer = read_transfer_function(*table.path("transfer"));
    } else if (auto transfer = table.table("transfer")) {
      view.transfer = read_transfer_function(*transfer);
    }
  }
  view.path = read_path(table);
  for (Table& clip : table.tables("clip")) view.clips.push_back(read_clip(clip));
  view.lighting.lights = read_lights(table);
  view.meshes = read_meshes(table);
  view.camera = read_camera_choice(table);
  view.camera_keys = read_camera_keys(table, view.camera);
  if (view.half_offsets && !view.inverse) {
    table.fail("half_offsets", "half_offsets without inverse", "one of both");
  }
  if (auto slice = table.table("slice")) {
    view.slice.emplace();
    slice->read(fields(*view.slice));
    slice->finish();
    complete_slice(*view.slice, slice->place());
  }
  read_marks(view.marks, view.place);
  if (view.after_step && *view.after_step > steps) {
    table.fail("after_step", std::to_string(*view.after_step), "0 to " + std::to_string(steps));
  }
  table.finish();
  if (view.slice) refuse_beside_slice(table, fields(view));
  return view;
}

std::vector<Clip> resolve_clips(const std::vector<ClipChoice>& choices, const Geometry& geometry) {
  std::vector<Clip> clips;
  for (const ClipChoice& choice : choices) {
    clips.push_back(choice.clip);
    if (!choice.voxel_corners) continue;
    const auto& [corner, opposite] = *choice.voxel_corners;
    clips.back().region = box_region(geometry, corner, opposite);
  }
  return clips;
}

}  // namespace supple::tools

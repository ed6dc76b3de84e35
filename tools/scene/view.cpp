#include "tools/scene/view.h"

#include <algorithm>

#include "tools/console/command.h"
#include "tools/console/parse.h"
#include "tools/scene/transfer_file.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

Projection read_projection(TomlTable& table) {
  const std::string name = table.string("projection").value_or("perspective");
  if (name == "perspective") return Projection::perspective;
  if (name == "orthographic") return Projection::orthographic;
  table.fail("projection", "\"" + name + "\"", "\"perspective\" or \"orthographic\"");
}

CameraChoice read_camera_table(TomlTable& table) {
  CameraChoice choice;
  table.know({"projection", "view", "position", "target", "up", "fov", "height"});
  choice.projection = read_projection(table);
  choice.view = table.string("view").value_or(choice.view);
  const std::vector<std::string> views = view_names();
  if (std::find(views.begin(), views.end(), choice.view) == views.end()) {
    std::string expected = "one of";
    for (const std::string& name : views) expected += " " + name;
    table.fail("view", "\"" + choice.view + "\"", expected);
  }
  const auto position = table.vector("position");
  const auto target = table.vector("target");
  const auto up = table.vector("up");
  const auto fov = table.number("fov");
  const auto height = table.number("height");
  table.finish();
  if (!position && !target && !up && !fov && !height) return choice;
  if (table.has("view")) {
    table.fail("view", "view beside position", "a named view or a position, not both");
  }
  const bool perspective = choice.projection == Projection::perspective;
  if (perspective && height) table.fail("height", "height", "fov for a perspective camera");
  if (!perspective && fov) table.fail("fov", "fov", "height for an orthographic camera");
  Camera camera;
  camera.projection = choice.projection;
  camera.position_lps_mm = table.require(position, "position", "three numbers in LPS mm");
  camera.target_lps_mm = table.require(target, "target", "three numbers in LPS mm");
  camera.up_lps = up.value_or(camera.up_lps);
  camera.vertical_fov_degrees = fov.value_or(camera.vertical_fov_degrees);
  camera.height_mm = height.value_or(camera.height_mm);
  camera.validate(table.place());
  choice.camera = camera;
  return choice;
}

HalfSpace read_half_space(TomlTable& table) {
  table.know({"point", "normal"});
  const HalfSpace half{table.require(table.vector("point"), "point", "three numbers in LPS mm"),
                       table.require(table.vector("normal"), "normal", "a vector in LPS")};
  table.finish();
  return half;
}

std::pair<Vec3d, Vec3d> read_corners(TomlTable& table) {
  const auto corners = table.numbers("box");
  if (corners->size() != 6) {
    table.fail("box", std::to_string(corners->size()) + " numbers",
               "six voxel coordinates [i0, j0, k0, i1, j1, k1]");
  }
  const auto& c = *corners;
  return {Vec3d(c[0], c[1], c[2]), Vec3d(c[3], c[4], c[5])};
}

/// `first` or `second`; the default is `first`.
bool is_second(TomlTable& table, const std::string& key, const std::string& first,
               const std::string& second) {
  const std::string text = table.string(key).value_or(first);
  if (text == first || text == second) return text == second;
  table.fail(key, "\"" + text + "\"", "\"" + first + "\" or \"" + second + "\"");
}

ClipChoice read_clip(TomlTable& table) {
  ClipChoice choice;
  table.know({"plane", "box", "keep", "space"});
  auto plane = table.table("plane");
  if (plane.has_value() == table.has("box")) {
    if (plane) table.fail("box", "plane and box", "one of both");
    table.fail_missing("box", "either plane or box");
  }
  if (plane) {
    choice.clip.region = {read_half_space(*plane)};
  } else {
    choice.voxel_corners = read_corners(table);
  }
  if (is_second(table, "keep", "inside", "outside")) choice.clip.keep = ClipKeep::outside;
  if (is_second(table, "space", "deformed", "source")) choice.clip.space = ClipSpace::source;
  const std::string place = table.place();
  table.finish();
  if (plane) choice.clip.validate(place);
  return choice;
}

/// Slices have their own place and scale.
void refuse_beside_slice(TomlTable& table) {
  for (const char* key :
       {"preset", "transfer", "camera", "size", "step", "quality", "classification", "jitter",
        "lattice", "clip", "mesh", "stereo", "aux", "turntable", "inverse", "half_offsets"}) {
    if (table.has(key)) table.fail(key, std::string(key) + " beside slice", "one of both");
  }
}

}  // namespace

void Sampling::apply_to(RenderSettings& settings) const {
  settings.set_quality(parse_quality(quality));
  if (step_voxels) settings.set_step(*step_voxels);
  settings.jitter = jitter;
  if (classification == "pre-integrated") {
    settings.classification = Classification::pre_integrated;
  } else if (classification != "post") {
    throw InputError({"", "classification", "'" + classification + "'", "post or pre-integrated"});
  }
}

SceneView read_view(TomlTable& table, int steps) {
  SceneView view;
  view.place = table.place();
  table.know({"image",    "preset",  "transfer",          "camera",     "size",        "step",
              "deformed", "inverse", "lattice",           "after_step", "clip",        "shading",
              "light",    "shadows", "ambient_occlusion", "mesh",       "clip_meshes", "offset",
              "slice",    "quality", "classification",    "jitter",     "half_offsets"});
  view.image = table.require(table.string("image"), "image", "the name of a PNG file");
  view.preset = table.string("preset").value_or(view.preset);
  if (const auto path = table.path("transfer")) {
    if (!view.preset.empty()) table.fail("transfer", "preset and transfer", "one of both");
    view.transfer = read_transfer_function(*path);
  }
  view.offset = read_offset_functions(table);
  for (TomlTable& clip : table.tables("clip")) view.clips.push_back(read_clip(clip));
  view.lighting = read_lighting(table);
  view.meshes = read_meshes(table);
  view.clip_meshes = table.boolean("clip_meshes").value_or(false);
  if (auto camera = table.table("camera")) view.camera = read_camera_table(*camera);
  if (const auto size = table.numbers("size")) {
    if (size->size() != 2 || !is_integer((*size)[0]) || !is_integer((*size)[1])) {
      table.fail("size", "another list", "two integers [width, height]");
    }
    view.width = int((*size)[0]);
    view.height = int((*size)[1]);
  }
  view.sampling.quality = table.string("quality").value_or(view.sampling.quality);
  view.sampling.step_voxels = table.number("step");
  view.sampling.classification =
      table.string("classification").value_or(view.sampling.classification);
  view.sampling.jitter = table.boolean("jitter").value_or(false);
  view.deformed = table.boolean("deformed").value_or(true);
  view.inverse = table.boolean("inverse").value_or(true);
  view.half_offsets = table.boolean("half_offsets").value_or(false);
  if (view.half_offsets && !view.inverse) {
    table.fail("half_offsets", "half_offsets without inverse", "one of both");
  }
  view.lattice = table.boolean("lattice").value_or(false);
  view.picture = read_picture_options(table);
  if (auto slice = table.table("slice")) {
    view.slice = read_slice(*slice);
    refuse_beside_slice(table);
  }
  if (const auto after = table.integer("after_step")) {
    if (*after < 0 || *after > steps) {
      table.fail("after_step", std::to_string(*after), "0 to " + std::to_string(steps));
    }
    view.after_step = int(*after);
  }
  table.finish();
  return view;
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

CameraChoice read_camera(const std::string& path) {
  TomlTable table = TomlTable::read(path);
  return read_camera_table(table);
}

void choose_transfer(SceneView& view, const std::string& preset_or_path) {
  view.preset.clear();
  view.transfer.reset();
  const std::string ending = ".toml";
  const std::size_t length = preset_or_path.size();
  if (length > ending.size() &&
      preset_or_path.compare(length - ending.size(), ending.size(), ending) == 0) {
    view.transfer = read_transfer_function(preset_or_path);
  } else {
    view.preset = preset_or_path;
  }
}

ClipChoice parse_clip_plane(const std::string& option, const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw UsageError(
        to_line({"", option, "'" + text + "'", "a point and a normal X,Y,Z:NX,NY,NZ"}));
  }
  ClipChoice choice;
  choice.clip.region = {
      {parse_vector(option, text.substr(0, colon)), parse_vector(option, text.substr(colon + 1))}};
  choice.clip.validate(option);
  return choice;
}

ClipChoice parse_clip_box(const std::string& option, const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw UsageError(to_line({"", option, "'" + text + "'", "two corners I,J,K:I,J,K"}));
  }
  ClipChoice choice;
  choice.voxel_corners = {parse_vector(option, text.substr(0, colon)),
                          parse_vector(option, text.substr(colon + 1))};
  return choice;
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

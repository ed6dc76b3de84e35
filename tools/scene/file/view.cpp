#include "tools/scene/file/view.h"

#include <algorithm>

#include "tools/scene/file/transfer_file.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

Fields half_space_fields(HalfSpace& half) {
  return {
      Field("point", half.point_lps_mm, "A point in LPS mm").required(),
      Field("normal", half.normal_lps, "A vector in LPS, to what is inside").required(),
  };
}

std::pair<Vec3d, Vec3d> read_corners(Table& table) {
  const auto corners = table.numbers("box");
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
                                return field.is_for_slices() && field.name() == key;
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
    if (table.is_string("transfer")) {
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

#include "tools/lab/stress/stress_input.h"

#include "volumes/base/files.h"
#include "volumes/base/text.h"
#include "volumes/io/volume_writer.h"

namespace supple::tools {

namespace {

constexpr const char* kVolumeName = "volume.nrrd";

std::string lines_of(const TomlKeys& keys) {
  std::string lines;
  for (const auto& [key, value] : keys) lines += key + " = " + value + '\n';
  return lines;
}

std::string in_braces(const TomlKeys& keys) {
  std::string text;
  for (const auto& [key, value] : keys) text += (text.empty() ? "" : ", ") + key + " = " + value;
  return "{ " + text + " }";
}

std::string toml_box(const IndexBox& box) {
  return "[[" + to_text(box.lo) + "," + to_text(box.hi) + "]]";
}

TomlKeys first_step(const StressInput& input) {
  TomlKeys step = input.step;
  const std::string grab =
      input.grab.empty() ? "grab = [" + to_text(input.grabbed) + "]" : input.grab;
  step["handles"] = "[{ " + grab + ", by = " + toml_text(input.by_mm()) + " }]";
  if (input.fixed) step["fix"] = toml_box(*input.fixed);
  return step;
}

std::string scene_text(const StressInput& input, bool has_view) {
  std::string text = "[volume]\npath = \"" + std::string(kVolumeName) + "\"\n\n[material]\n" +
                     lines_of(input.material) + "\n[[step]]\n" + lines_of(first_step(input));
  for (const TomlKeys& step : input.later_steps) text += "\n[[step]]\n" + lines_of(step);
  if (!has_view) return text;
  TomlKeys view = input.view;
  if (input.has_slices) {  // without camera, size and colours
    view = {{"image", view["image"]}, {"slice", in_braces(input.slice)}};
  } else {
    view["transfer"] = in_braces(input.transfer);
  }
  return text + "\n[[view]]\n" + lines_of(view);
}

/// Tables are as narrow as curves, so that links look up what extremes say of their densities.
const TomlKeys kTissue = {
    {"domain", "[0, 255]"},        {"active", "[1, 255]"},   {"max_length", "[[0, 1.25]]"},
    {"min_length", "[[0, 0.75]]"}, {"shear", "[[0, 0.35]]"}, {"stiffness", "[[0, 5]]"},
    {"density", "[[0, 1000]]"},    {"damping", "[[0, 2]]"},  {"poisson", "[[0, 0.45]]"}};

}  // namespace

StressInput::StressInput()
    : density([](const Vec3i&) { return 100.0f; }),
      material(kTissue),
      view{{"image", "\"view.png\""}, {"size", "[48, 40]"}},
      transfer{{"opacity", "[[20, 0], [60, 0.8]]"},
               {"colour", "[[0, 1, 0.5, 0.2], [255, 1, 1, 1]]"}} {
  take_block({12, 10, 8});
}

void StressInput::take_block(const Vec3i& block_dims) {
  dims = block_dims;
  grabbed = {dims.x - 1, dims.y / 2, dims.z / 2};
  fixed.reset();
  if (dims.x > 1) fixed = IndexBox{{0, 0, 0}, {0, dims.y - 1, dims.z - 1}};
}

Vec3d StressInput::by_mm() const {
  return by_voxels * geometry().spacing_mm();
}

std::string toml_text(const Vec3d& v) {
  return "[" + exact_text(v.x) + ", " + exact_text(v.y) + ", " + exact_text(v.z) + "]";
}

std::string toml_curve(double value) {
  return "[[0, " + exact_text(value) + "]]";
}

std::string toml_curve(double density_a, double a, double density_b, double b) {
  return "[[" + exact_text(density_a) + ", " + exact_text(a) + "], [" + exact_text(density_b) +
         ", " + exact_text(b) + "]]";
}

std::string write_input(const StressInput& input, const std::string& folder, bool has_view) {
  const Vec3i& dims = input.dims;
  const auto slice = [&](int k, std::vector<float>& values) {
    values.clear();
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) values.push_back(input.density({i, j, k}));
    }
  };
  const std::string volume = folder + '/' + kVolumeName;
  DenseImage image;
  image.geometry = input.geometry();
  const std::unique_ptr<DenseWriter> writer = create_dense(volume, image);
  std::vector<float> values;
  for (int k = 0; k < dims.z; ++k) {
    slice(k, values);
    writer->write_slice(values.data());
  }
  writer->commit();
  const std::string scene = folder + "/scene.toml";
  replace_text_file(scene, scene_text(input, has_view));
  return scene;
}

}  // namespace supple::tools

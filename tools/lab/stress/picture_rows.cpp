#include <algorithm>
#include <cmath>

#include "tools/lab/stress/stress_rows.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/run/scene_run.h"
#include "tools/scene/run/view_pictures.h"

namespace supple::tools {

namespace {

/// Pictures of more pixels are looked at in their file alone: a second one would not fit beside it.
constexpr double kMostPixelsDrawnAgain = 1e6;

void measure_file(const StressInput& input, const SceneView& view, const std::string& path,
                  MeasuredValues& all) {
  const Image image = read_png(path);
  const double pixels = double(image.width) * image.height;
  double covered = 0;
  for (std::size_t n = 3; n < image.rgba.size(); n += 4) {
    const std::uint8_t* pixel = &image.rgba[n - 3];
    const bool is_seen = image.has_alpha ? pixel[3] > 0 : pixel[0] + pixel[1] + pixel[2] > 0;
    covered += is_seen;
  }
  if (!view.slice) {
    all.push_back({"width", double(image.width), double(view.size[0]), double(view.size[0])});
    all.push_back({"height", double(image.height), double(view.size[1]), double(view.size[1])});
  }
  all.push_back(
      {"pixels with something, of all", covered / pixels, input.least_covered, input.most_covered});
}

/// Draws the picture of the file again, as it was before it became 8 bits.
FloatImage drawn_again(const Scene& scene, Session& session, Console& console) {
  const SceneView& asked = scene.views.front();
  const State state = session.state();
  const Pose* pose = asked.inverse ? &session.pose(&console) : nullptr;
  Displacement moved;
  if (pose == nullptr) moved = extended_displacement_of(state);
  const SceneView view = effective_view(asked, state.geometry, state.density.background());
  const MaterialTable& material = session.material();
  const PosedVolume subject{state.geometry,
                            state.density,
                            state.elements,
                            pose != nullptr ? &pose->offsets : nullptr,
                            pose != nullptr ? &pose->displacement : &moved,
                            material.domain_lo,
                            material.domain_hi,
                            0,
                            &state.elements,
                            &state.cuts,
                            &state.labels};
  const bool is_marched = !view.slice && !view.lattice;
  const std::unique_ptr<Renderer> renderer = is_marched ? make_renderer(subject, view) : nullptr;
  return draw(subject, renderer.get(), view, nullptr, console);
}

/// Colours are premultiplied. Highlights pass 1, by what the shares of the light add up to; files
/// of 8 and 16 bits end at 1.
void measure_floats(const FloatImage& picture, double most_light, MeasuredValues& all) {
  double least = 0, brightest = 0, least_opacity = 1, opacity = 0, strange = 0;
  for (std::size_t n = 0; n < picture.rgba.size(); ++n) {
    const float value = picture.rgba[n];
    strange += !std::isfinite(value);
    const bool is_opacity = n % 4 == 3;
    double& most = is_opacity ? opacity : brightest;
    double& lowest = is_opacity ? least_opacity : least;
    most = std::max(most, double(value));
    lowest = std::min(lowest, double(value));
  }
  all.push_back({"values that are no numbers", strange, 0, 0});
  all.push_back({"least colour", least, 0, most_light});
  all.push_back({"largest colour", brightest, 0, most_light});
  all.push_back({"least opacity", least_opacity, 0, 1});
  all.push_back({"largest opacity", opacity, 0, 1});
}

}  // namespace

void run_picture(const StressInput& input, const std::string& folder, Console& console,
                 MeasuredValues& all) {
  const Scene scene = read_scene(write_input(input, folder, true));
  SceneRun run(scene, folder, false, console);
  run.check_steps();
  run.run();
  const SceneView& view = scene.views.front();
  measure_file(input, view, folder + '/' + view.image, all);
  if (double(view.size[0]) * view.size[1] > kMostPixelsDrawnAgain) return;
  const TransferFunction shares = view.transfer.value_or(TransferFunction());
  Session session(scene.volume_path, {scene.material}, &console);
  session.step(scene.steps.front(), &console);
  const double most_light = view.slice ? 1 : shares.ambient + shares.diffuse + shares.specular;
  measure_floats(drawn_again(scene, session, console), most_light, all);
}

}  // namespace supple::tools

#include "tools/lab/bench/render/render_extension.h"

#include <map>

#include "raycast/pictures/compare.h"
#include "raycast/render.h"
#include "tools/lab/bench/bodies/block_topology.h"
#include "tools/lab/bench/bodies/half_sampled_head.h"
#include "volumes/base/parallel.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/offset_field.h"
#include "volumes/field/procedural.h"

namespace supple::tools {

namespace {

constexpr Vec3i kCubeSize(256);
constexpr int kImageSize = 512;
constexpr int kShellRings = 2;  // as states keep them

/// The head without its rest, with the shell around it, as a state holds it.
struct ExtendedHead {
  explicit ExtendedHead(const HalfSampledHead& head)
      : geometry(head_phantom(kCubeSize).geometry),
        elements(largest_components(
            block_topology(kCubeSize, [&](const Vec3i& v) { return head.is_tissue(v); }), 1)),
        shell(dilate_inside(elements, kShellRings, kCubeSize)),
        density(fill_density_grid(
            shell,
            [&](std::size_t b, float* out) {
              for (int n = 0; n < kBrickVoxels; ++n)
                out[n] = head(shell.origin(b) + brick_local(n));
            },
            -1000)) {}

  Geometry geometry;
  BrickTopology elements, shell;
  DensityGrid density;
};

/// Bulk along all axes; the head stays inside its box.
AnalyticWarp warp_of(const std::string& name) {
  const Vec3d middle = Vec3d(kCubeSize) / 2;
  if (name == "bump") return bump_warp(middle, 48, -16);
  if (name == "shear") return shear_warp(middle, 0.25);
  return stretch_warp(middle, 1.25);
}

/// u on elements and shell; in the shell as the row's `air` says.
Displacement displacement_with(const std::string& air, const AnalyticWarp& warp,
                               const ExtendedHead& body) {
  if (air == "analytic") return sample_displacement(warp, body.geometry, body.shell);
  const Displacement inside = sample_displacement(warp, body.geometry, body.elements);
  if (air == "extended") return extend(inside, body.shell);
  Displacement torn{body.geometry, {body.shell, BrickVectors(body.shell.brick_count())}};
  for (std::size_t b = 0; b < body.shell.brick_count(); ++b) {
    for_each_active(body.shell.mask(b), [&](int offset) {
      Vec3f& u = torn.u.vectors.touch(b)[offset];
      inside.u.at(body.shell.origin(b) + brick_local(offset), u);
    });
  }
  return torn;
}

}  // namespace

std::vector<ExtensionSide> extension_sides(bool quick) {
  std::vector<ExtensionSide> sides;
  for (const std::string warp : {"bump", "shear", "stretch"}) {
    if (quick && warp != "bump") continue;
    for (const char* air : {"extended", "analytic", "zero"}) sides.push_back({warp, air});
  }
  return sides;
}

std::string extension_row_name(const ExtensionSide& side) {
  return "extension/" + side.warp + "/" + side.air;
}

std::vector<BenchRow> measure_extension(const std::vector<ExtensionSide>& sides,
                                        const RoundLimits& limits,
                                        const std::function<void()>& before_run) {
  const HalfSampledHead head(kCubeSize);
  const ExtendedHead body(head);
  const Camera camera = default_camera(body.geometry, 1);
  const TransferFunction skin = preset("Skin");
  RenderSettings settings;
  settings.width = settings.height = kImageSize;
  const BrickTopology box = block_topology(kCubeSize, [](const Vec3i&) { return true; });
  Renderer renderer(body.geometry, body.density);
  std::map<std::string, Image> expected;  // by the warp
  std::vector<BenchRow> rows;
  for (const ExtensionSide& side : sides) {
    before_run();
    const AnalyticWarp warp = warp_of(side.warp);
    if (expected.count(side.warp) == 0) {
      const OffsetField exact = sample_offsets(warp, body.geometry, box);
      renderer.set_offsets(&exact);
      expected[side.warp] = renderer.render(camera, skin, settings);
    }
    const OffsetField offsets = invert(displacement_with(side.air, warp, body));
    renderer.set_offsets(&offsets);
    const ThreadLimit one_thread(1);
    Image image;
    std::vector<TimedSide> timed(1);
    timed[0].run = [&](Times& times) {
      times.ms.push_back(time_ms([&] { image = renderer.render(camera, skin, settings); }));
    };
    take_turns(timed, limits, before_run);
    const Comparison found = compare(image, expected[side.warp], true);
    BenchRow row = {{"case", "extension"},
                    {"warp", side.warp},
                    {"air", side.air},
                    {"size", {kCubeSize.x, kCubeSize.y, kCubeSize.z}},
                    {"image", {kImageSize, kImageSize}},
                    {"ssim", found.ssim},
                    {"rmse", found.rmse}};
    add_times(row, timed[0].times, 1);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace supple::tools

#include "tools/lab/bench/render/render_frames.h"

#include <map>

#include "raycast/pictures/compare.h"
#include "tools/lab/bench/bodies/block_topology.h"
#include "tools/lab/bench/bodies/half_sampled_head.h"
#include "volumes/base/parallel.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/procedural.h"

namespace supple::tools {

namespace {

constexpr float kAir = -950;           // HU; what is below is not stored
constexpr float kStoredZero = 1e-30f;  // no offset, but one that must be read
constexpr double kBumpRadius = 24, kBumpHeight = 14, kShear = 0.3;  // voxels

struct Head {
  Geometry geometry;
  DensityGrid density;
};

Head make_head(const Vec3i& size) {
  const HalfSampledHead head(size);
  const BrickTopology tissue =
      block_topology(size, [&](const Vec3i& voxel) { return head(voxel) > kAir; });
  const auto fill = [&](std::size_t b, float* out) {
    for (int n = 0; n < kBrickVoxels; ++n) out[n] = head(tissue.origin(b) + brick_local(n));
  };
  return {head_phantom(size).geometry, fill_density_grid(tissue, fill, -1000)};
}

RenderSettings settings_of(const std::string& name, int image_size) {
  RenderSettings settings;
  settings.width = settings.height = image_size;
  if (name == "reference") {
    settings.step_voxels = 0.1;
    settings.stride = 1;
    settings.early_termination = 1;
  } else {
    settings.set_quality(parse_quality(name));
  }
  return settings;
}

}  // namespace

std::string frame_row_name(const FrameSide& side) {
  return "frame/" + side.kind + "/" + side.setting + "/" + std::to_string(side.threads);
}

struct FrameBench::Impl {
  Impl(const Vec3i& size_, int image_size_)
      : size(size_),
        image_size(image_size_),
        head(make_head(size_)),
        straight(head.geometry, head.density, kRings),
        camera(default_camera(head.geometry, 1)) {}

  /// Displacement of the head and the air around it; null for offsets that are 0.
  std::unique_ptr<const Displacement> movement_of(const std::string& kind) const {
    if (kind == "identity" || kind == "zero" || kind == "straight") return nullptr;
    const Vec3d middle = Vec3d(size) / 2;
    const AnalyticWarp warp =
        kind == "local" ? bump_warp(middle, kBumpRadius, kBumpHeight) : shear_warp(middle, kShear);
    return std::make_unique<const Displacement>(
        sample_displacement(warp, head.geometry, dilate(head.density.bricks(), kRings + 1)));
  }
  OffsetField zero_offsets(const std::string& kind) const {
    const BrickTopology where = dilate(head.density.bricks(), kRings + 1);
    OffsetField zero = sample_offsets(shear_warp(Vec3d(size) / 2, 0), head.geometry, where);
    for_each_stored(zero.o.vectors,
                    [&](Vec3f& offset) { offset = Vec3f(kind == "zero" ? kStoredZero : 0.0f); });
    return zero;
  }

  Image draw(const Renderer& renderer, const std::string& setting, RenderReport& report) const {
    return renderer.render(camera, preset("Bone"), settings_of(setting, image_size), &report);
  }

  static constexpr int kRings = 2;

  Vec3i size;
  int image_size;
  Head head;
  Renderer straight;
  Camera camera;
};

FrameBench::FrameBench(const Vec3i& size, int image_size)
    : m_impl(std::make_unique<Impl>(size, image_size)) {}

FrameBench::~FrameBench() = default;

std::vector<BenchRow> FrameBench::measure(const std::vector<FrameSide>& sides,
                                          const RoundLimits& limits,
                                          const std::function<void()>& before_run) {
  const std::string kind = sides.front().kind;
  const std::unique_ptr<const Displacement> movement = m_impl->movement_of(kind);
  std::unique_ptr<Renderer> bent;
  if (kind != "straight") {
    bent = std::make_unique<Renderer>(m_impl->head.geometry, m_impl->head.density, Impl::kRings);
    const OffsetField offsets = movement ? invert(*movement) : m_impl->zero_offsets(kind);
    bent->set_offsets(&offsets, kind == "half" ? OffsetResolution::half : OffsetResolution::full);
  }
  const Renderer& renderer = bent ? *bent : m_impl->straight;
  RenderReport ignored;
  Image reference;
  if (movement) {
    // Every sample solves for itself.
    Renderer exact(m_impl->head.geometry, m_impl->head.density, Impl::kRings);
    exact.set_pointwise_offsets(std::make_shared<ForwardOffsets>(*movement));
    reference = m_impl->draw(exact, "reference", ignored);
  } else {
    reference = m_impl->draw(renderer, "reference", ignored);
  }

  // Side n and the straight frame with as many threads take turns.
  std::vector<BenchRow> rows;
  for (const FrameSide& side : sides) {
    const ThreadLimit limit(side.threads);
    Image image;
    RenderReport report;
    std::vector<TimedSide> timed(2);
    timed[0].run = [&](Times& times) {
      times.ms.push_back(time_ms([&] { image = m_impl->draw(renderer, side.setting, report); }));
    };
    timed[1].run = [&](Times& times) {
      times.ms.push_back(time_ms([&] { m_impl->draw(m_impl->straight, "default", ignored); }));
    };
    take_turns(timed, limits, before_run);
    const Comparison found = compare(image, reference, true);
    BenchRow row = {{"case", side.kind},
                    {"setting", side.setting},
                    {"size", {m_impl->size.x, m_impl->size.y, m_impl->size.z}},
                    {"image", {image.width, image.height}},
                    {"samples", report.samples},
                    {"of_straight", timed[0].times.median() / timed[1].times.median()},
                    {"ssim", found.ssim},
                    {"rmse", found.rmse},
                    {"mbytes", double(report.bytes) / 1e6}};
    add_times(row, timed[0].times, side.threads);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace supple::tools

#include "raycast/render.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>

#include <oneapi/tbb/blocked_range2d.h>
#include <oneapi/tbb/parallel_for.h>

#include "raycast/marcher.h"

namespace supple {

namespace {

constexpr int kTile = 16;

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Premultiplied 0…1 to straight 8 bits.
void store_pixel(const Float4& sum, std::uint8_t* rgba) {
  const long alpha = std::lround(std::min(sum[3], 1.0f) * 255.0f);
  for (int c = 0; c < 3; ++c) {
    const float straight = alpha > 0 ? sum[c] / sum[3] : 0;
    rgba[c] = std::uint8_t(std::lround(std::clamp(straight, 0.0f, 1.0f) * 255.0f));
  }
  rgba[3] = std::uint8_t(alpha);
}

/// Progress from many threads: one at a time reports, any may cancel.
class SharedProgress {
 public:
  SharedProgress(Progress* progress, std::int64_t total) : m_progress(progress), m_total(total) {}
  void done(std::int64_t count) {
    const std::int64_t now = m_done += count;
    if (m_progress == nullptr) return;
    if (m_progress->cancelled()) throw Cancelled();
    const std::unique_lock lock(m_mutex, std::try_to_lock);
    if (lock) report(m_progress, double(now) / double(m_total));
  }

 private:
  Progress* m_progress;
  std::int64_t m_total;
  std::atomic<std::int64_t> m_done{0};
  std::mutex m_mutex;
};

/// The voxels within `rings` of active ones that lie inside the box.
BrickTopology grow_inside(const BrickTopology& active, int rings, const Vec3i& dims) {
  const BrickTopology grown = dilate(active, rings);
  const IndexBox box{{0, 0, 0}, dims - Vec3i(1)};
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < grown.brick_count(); ++b) {
    BrickMask mask{};
    for_each_active(grown.mask(b), [&](int offset) {
      const Vec3i voxel = grown.origin(b) + brick_local(offset);
      if (box.contains(voxel) || active.is_active(voxel)) mask_set(mask, offset);
    });
    origins.push_back(grown.origin(b));
    masks.push_back(mask);
  }
  return {std::move(origins), std::move(masks)};
}

SourceBricks make_source(const Geometry& geometry, const DensityGrid& density, int rings) {
  if (rings <= 0) return SourceBricks(density);
  return {density, grow_inside(density.bricks(), rings, geometry.dims())};
}

void require(bool good, const char* field, double value, const char* expected) {
  if (!good) throw InputError({"", field, number_text(value), expected});
}

}  // namespace

void RenderSettings::validate() const {
  require(width >= 1 && width <= 16384, "width", width, "1 to 16384 pixels");
  require(height >= 1 && height <= 16384, "height", height, "1 to 16384 pixels");
  require(step_voxels >= 0.01 && step_voxels <= 16, "step", step_voxels, "0.01 to 16 voxels");
  require(stride >= 1 && stride <= 16, "stride", stride, "1 to 16");
  require(early_termination > 0 && early_termination <= 1, "early_termination", early_termination,
          "more than 0, at most 1");
  for (const Clip& clip : clips) clip.validate("");
}

struct Renderer::Impl {
  Impl(const Geometry& geometry_, const DensityGrid& density, int background_rings)
      : geometry(geometry_),
        source(make_source(geometry_, density, background_rings)),
        output(std::make_unique<OffsetBricks>(source)) {}

  Geometry geometry;
  SourceBricks source;
  std::unique_ptr<OffsetBricks> output;
};

Renderer::Renderer(const Geometry& geometry, const DensityGrid& density, int background_rings)
    : m_impl(std::make_unique<Impl>(geometry, density, background_rings)) {}

Renderer::~Renderer() = default;

void Renderer::set_offsets(const OffsetField* offsets) {
  if (offsets == nullptr) {
    m_impl->output = std::make_unique<OffsetBricks>(m_impl->source);
    return;
  }
  if (!(offsets->geometry == m_impl->geometry)) {
    throw InputError({"", "offsets", "another geometry", "the geometry of the volume"});
  }
  m_impl->output = std::make_unique<OffsetBricks>(m_impl->source, offsets->o);
}

Image Renderer::render(const Camera& camera, const TransferFunction& transfer_function,
                       const RenderSettings& settings, RenderReport* report,
                       Progress* progress) const {
  camera.validate("");
  transfer_function.validate("");
  settings.validate();
  if (progress != nullptr) progress->stage("rendering");
  const auto start = Clock::now();
  const Frame frame(m_impl->geometry, m_impl->source, *m_impl->output, camera, transfer_function,
                    settings);
  const double prepare_ms = ms_since(start);

  Image image(settings.width, settings.height);
  const std::int64_t pixels = std::int64_t(settings.width) * settings.height;
  SharedProgress shared(progress, pixels);
  std::atomic<std::int64_t> samples{0};
  const auto march_start = Clock::now();
  const tbb::blocked_range2d<int> all(0, settings.height, kTile, 0, settings.width, kTile);
  tbb::parallel_for(
      all,
      [&](const tbb::blocked_range2d<int>& tile) {
        Marcher marcher(frame);
        for (int y = tile.rows().begin(); y < tile.rows().end(); ++y) {
          for (int x = tile.cols().begin(); x < tile.cols().end(); ++x) {
            const Ray ray = camera_ray(camera, settings.width, settings.height, x + 0.5, y + 0.5);
            store_pixel(marcher.march(ray), &image.rgba[4 * (std::size_t(y) * settings.width + x)]);
          }
        }
        samples += marcher.samples();
        shared.done(std::int64_t(tile.rows().size()) * std::int64_t(tile.cols().size()));
      },
      tbb::simple_partitioner());

  if (report != nullptr) {
    report->samples = samples;
    report->rays = pixels;
    report->prepare_ms = prepare_ms;
    report->march_ms = ms_since(march_start);
    report->bytes = m_impl->source.bytes() + m_impl->output->bytes() + frame.bounds.bytes();
  }
  return image;
}

}  // namespace supple

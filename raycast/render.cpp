#include "raycast/render.h"

#include <algorithm>
#include <chrono>

#include "raycast/march/march_pixels.h"
#include "volumes/base/stopwatch.h"
#include "volumes/field/split_offsets.h"

namespace supple {

namespace {

using Clock = std::chrono::steady_clock;

SourceBricks make_source(const Geometry& geometry, const DensityGrid& density, int rings,
                         Interpolation interpolation) {
  if (rings <= 0) return SourceBricks(density, interpolation);
  return {density, dilate_inside(density.bricks(), rings, geometry.dims()), interpolation};
}

}  // namespace

struct Renderer::Impl {
  Impl(const Geometry& geometry_, const DensityGrid& density, int background_rings,
       Interpolation interpolation)
      : geometry(geometry_),
        source(make_source(geometry_, density, background_rings, interpolation)),
        lattice(std::make_unique<OffsetBricks>(source)) {}

  Geometry geometry;
  SourceBricks source;
  const OffsetBricks& output() const { return is_pointwise ? *pointwise : *lattice; }

  std::unique_ptr<OffsetBricks> lattice, pointwise;
  bool is_pointwise = false;
  std::unique_ptr<SurfaceScene> surfaces;

  std::uint64_t version = 0;                // counts changes of `lattice` and `surfaces`
  std::uint64_t all_changed = 0;            // the last one of more than some bricks
  std::vector<std::uint64_t> last_changed;  // per brick of `lattice`; at first none
};

Renderer::Renderer(const Geometry& geometry, const DensityGrid& density, int background_rings,
                   Interpolation interpolation)
    : m_impl(std::make_unique<Impl>(geometry, density, background_rings, interpolation)) {}

Renderer::~Renderer() = default;

void Renderer::set_offsets(const OffsetField* offsets, OffsetResolution resolution) {
  if (offsets != nullptr && !(offsets->geometry == m_impl->geometry)) {
    throw InputError({"", "offsets", "another geometry", "the geometry of the volume"});
  }
  m_impl->is_pointwise = false;
  m_impl->lattice.reset();  // before another one takes memory
  m_impl->lattice = offsets == nullptr ? std::make_unique<OffsetBricks>(m_impl->source)
                                       : std::make_unique<OffsetBricks>(
                                             m_impl->source, offsets->o, offsets->split,
                                             resolution == OffsetResolution::half ? 2 : 1);
  m_impl->all_changed = ++m_impl->version;
  m_impl->last_changed = {};
}

void Renderer::update_offsets(const std::vector<Vec3i>& changed, const VectorBrickFinder& offsets,
                              std::shared_ptr<const PointwiseOffsets> split) {
  m_impl->is_pointwise = false;
  const std::vector<std::size_t> bricks =
      m_impl->lattice->update(changed, offsets, std::move(split));
  ++m_impl->version;
  m_impl->last_changed.resize(m_impl->lattice->brick_count());
  for (const std::size_t b : bricks) m_impl->last_changed[b] = m_impl->version;
}

void Renderer::set_pointwise_offsets(std::shared_ptr<const PointwiseOffsets> offsets) {
  if (m_impl->pointwise == nullptr) {
    m_impl->pointwise = std::make_unique<OffsetBricks>(m_impl->source);
  }
  m_impl->pointwise->set_pointwise(std::move(offsets));
  m_impl->is_pointwise = true;
}

void Renderer::set_surfaces(const std::vector<Surface>& surfaces) {
  for (const Surface& surface : surfaces) surface.validate("");
  m_impl->surfaces = std::make_unique<SurfaceScene>(surfaces);
  m_impl->all_changed = ++m_impl->version;
}

std::unique_ptr<RenderContext> Renderer::prepare(const Camera& camera,
                                                 const TransferFunction& function,
                                                 const RenderSettings& settings) const {
  camera.validate("");
  function.validate("");
  settings.validate();
  settings.validate_with(function);
  return std::make_unique<RenderContext>(m_impl->geometry, m_impl->source, m_impl->output(), camera,
                                         function, settings, m_impl->surfaces.get());
}

std::optional<std::uint64_t> Renderer::version() const {
  if (m_impl->is_pointwise) return std::nullopt;
  return m_impl->version;
}

std::optional<std::vector<std::size_t>> Renderer::changed_since(std::uint64_t version) const {
  if (!this->version() || m_impl->all_changed > version) return std::nullopt;
  std::vector<std::size_t> bricks;
  for (std::size_t b = 0; b < m_impl->last_changed.size(); ++b) {
    if (m_impl->last_changed[b] > version) bricks.push_back(b);
  }
  return bricks;
}

FloatImage Renderer::render_float(const Camera& camera, const TransferFunction& transfer_function,
                                  const RenderSettings& settings, RenderReport* report,
                                  Progress* progress) const {
  if (progress != nullptr) progress->stage("rendering");
  const auto start = Clock::now();
  const std::unique_ptr<RenderContext> context = prepare(camera, transfer_function, settings);
  const double prepare_ms = ms_since(start);

  FloatImage picture(settings.width, settings.height, settings.auxiliary);
  if (settings.auxiliary && settings.tells_surfaces) {
    picture.surface.assign(picture.pixel_count(), -1);
  }
  const auto march_start = Clock::now();
  const std::int64_t samples = march_pixels(*context, camera, {}, picture, progress);

  if (report != nullptr) {
    report->samples = samples;
    report->rays = std::int64_t(picture.pixel_count());
    report->prepare_ms = prepare_ms;
    report->march_ms = ms_since(march_start);
    report->bytes = m_impl->source.bytes() + m_impl->output().bytes() + context->bounds.bytes();
    if (m_impl->surfaces != nullptr) report->bytes += m_impl->surfaces->bytes();
  }
  return picture;
}

Image Renderer::render(const Camera& camera, const TransferFunction& transfer_function,
                       const RenderSettings& settings, RenderReport* report,
                       Progress* progress) const {
  return to_image(render_float(camera, transfer_function, settings, report, progress));
}

}  // namespace supple

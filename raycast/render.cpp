#include "raycast/render.h"

#include <algorithm>
#include <chrono>

#include "raycast/march_pixels.h"
#include "volumes/field/split_offsets.h"

namespace supple {

namespace {

constexpr int kMaxStride = 16;

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

SourceBricks make_source(const Geometry& geometry, const DensityGrid& density, int rings) {
  if (rings <= 0) return SourceBricks(density);
  return {density, dilate_inside(density.bricks(), rings, geometry.dims())};
}

void require(bool good, const char* field, double value, const char* expected) {
  if (!good) throw InputError({"", field, number_text(value), expected});
}

}  // namespace

Quality parse_quality(const std::string& name) {
  if (name == "draft") return Quality::draft;
  if (name == "default") return Quality::standard;
  if (name == "accurate") return Quality::accurate;
  throw InputError({"", "quality", "'" + name + "'", "draft, default or accurate"});
}

void RenderSettings::set_quality(Quality quality) {
  set_step(1.0 / (quality == Quality::draft ? 2 : quality == Quality::accurate ? 5 : 3));
}

void RenderSettings::set_step(double voxels) {
  step_voxels = voxels;
  // Blocks of a voxel: longer ones leap over thin bone.
  stride = voxels > 0 ? int(std::clamp(1.0 / voxels + 1e-9, 1.0, double(kMaxStride))) : 1;
}

void RenderSettings::validate() const {
  require(width >= 1 && width <= 16384, "width", width, "1 to 16384 pixels");
  require(height >= 1 && height <= 16384, "height", height, "1 to 16384 pixels");
  require(step_voxels >= 0.01 && step_voxels <= 16, "step", step_voxels, "0.01 to 16 voxels");
  require(stride >= 1 && stride <= kMaxStride, "stride", stride, "1 to 16");
  require(early_termination > 0 && early_termination <= 1, "early_termination", early_termination,
          "more than 0, at most 1");
  for (const Clip& clip : clips) clip.validate("");
  lighting.validate("");
}

struct Renderer::Impl {
  Impl(const Geometry& geometry_, const DensityGrid& density, int background_rings)
      : geometry(geometry_),
        source(make_source(geometry_, density, background_rings)),
        lattice(std::make_unique<OffsetBricks>(source)) {}

  Geometry geometry;
  SourceBricks source;
  const OffsetBricks& output() const { return is_pointwise ? *pointwise : *lattice; }

  std::unique_ptr<OffsetBricks> lattice, pointwise;
  bool is_pointwise = false;
  std::unique_ptr<SurfaceScene> surfaces;
};

Renderer::Renderer(const Geometry& geometry, const DensityGrid& density, int background_rings)
    : m_impl(std::make_unique<Impl>(geometry, density, background_rings)) {}

Renderer::~Renderer() = default;

void Renderer::set_offsets(const OffsetField* offsets, OffsetResolution resolution) {
  if (offsets != nullptr && !(offsets->geometry == m_impl->geometry)) {
    throw InputError({"", "offsets", "another geometry", "the geometry of the volume"});
  }
  m_impl->is_pointwise = false;
  m_impl->lattice = offsets == nullptr ? std::make_unique<OffsetBricks>(m_impl->source)
                                       : std::make_unique<OffsetBricks>(
                                             m_impl->source, offsets->o, offsets->split,
                                             resolution == OffsetResolution::half ? 2 : 1);
}

void Renderer::update_offsets(const std::vector<Vec3i>& changed, const VectorBrickFinder& offsets) {
  if (m_impl->lattice->pointwise() != nullptr) {
    throw InputError({"", "offsets", "offsets that jump", "offsets set without a cut"});
  }
  m_impl->is_pointwise = false;
  m_impl->lattice->update(changed, offsets);
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
}

std::unique_ptr<Frame> Renderer::prepare(const Camera& camera, const TransferFunction& function,
                                         const RenderSettings& settings) const {
  camera.validate("");
  function.validate("");
  settings.validate();
  if (settings.classification == Classification::pre_integrated &&
      !function.gradient_opacity.empty()) {
    throw InputError({"", "classification", "pre-integrated with gradient opacity",
                      "post, or a transfer function without gradient opacity"});
  }
  return std::make_unique<Frame>(m_impl->geometry, m_impl->source, m_impl->output(), camera,
                                 function, settings, m_impl->surfaces.get());
}

FloatImage Renderer::render_float(const Camera& camera, const TransferFunction& transfer_function,
                                  const RenderSettings& settings, RenderReport* report,
                                  Progress* progress) const {
  if (progress != nullptr) progress->stage("rendering");
  const auto start = Clock::now();
  const std::unique_ptr<Frame> frame = prepare(camera, transfer_function, settings);
  const double prepare_ms = ms_since(start);

  FloatImage picture(settings.width, settings.height, settings.auxiliary);
  const auto march_start = Clock::now();
  const std::int64_t samples = march_pixels(*frame, camera, {}, picture, progress);

  if (report != nullptr) {
    report->samples = samples;
    report->rays = std::int64_t(picture.pixel_count());
    report->prepare_ms = prepare_ms;
    report->march_ms = ms_since(march_start);
    report->bytes = m_impl->source.bytes() + m_impl->output().bytes() + frame->bounds.bytes();
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

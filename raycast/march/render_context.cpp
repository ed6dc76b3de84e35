#include "raycast/march/render_context.h"

#include <algorithm>

#include "raycast/march/light_paths.h"

namespace supple {

namespace {

std::vector<std::uint8_t> visible_bricks(const OffsetBricks& bricks, const Classifier& classifier) {
  std::vector<std::uint8_t> visible(bricks.brick_count());
  for (std::size_t b = 0; b < visible.size(); ++b) {
    visible[b] = classifier.may_be_visible(bricks.range(b));
  }
  return visible;
}

double step_of(const Geometry& geometry, const RenderSettings& settings) {
  const Vec3d spacing = geometry.spacing_mm();
  return settings.step_voxels * std::min({spacing.x, spacing.y, spacing.z});
}

/// The piece at a place; -1 where it is void or in no pointwise brick.
int piece_at(const PointwiseOffsets& pointwise, const Vec3d& place) {
  const std::int32_t b = pointwise.bricks().find(floor_voxel(place));
  PointwiseOffsets::Sample found;
  return b >= 0 && pointwise.sample(std::size_t(b), place, found) ? found.piece : -1;
}

}  // namespace

RenderContext::RenderContext(const Geometry& geometry_, const SourceBricks& source_,
                             const OffsetBricks& output_, const Camera& camera,
                             const TransferFunction& function_, const RenderSettings& settings_,
                             const SurfaceScene* surfaces_)
    : geometry(geometry_),
      source(source_),
      output(output_),
      function(function_),
      settings(settings_),
      step_mm(step_of(geometry_, settings_)),
      classifier(function_, source_, step_mm),
      output_visible(visible_bricks(output_, classifier)),
      bounds(output_.index(), output_visible),
      shading(camera, function_, settings_.lighting),
      surfaces(surfaces_ != nullptr && surfaces_->empty() ? nullptr : surfaces_) {
  // The source box and the deformed bounds, each with the one voxel by which material can reach
  // beyond its outermost node. A zero displacement leaves the source box.
  box_lo = Vec3d(-1);
  box_hi = Vec3d(geometry.dims());
  const IndexBox& deformed = output.valid_bounds();
  for (int a = 0; a < 3 && !deformed.empty(); ++a) {
    box_lo[a] = std::min(box_lo[a], deformed.lo[a] - 1.0);
    box_hi[a] = std::max(box_hi[a], deformed.hi[a] + 1.0);
  }
  for (const Clip& clip : settings.clips) {
    (clip.space == ClipSpace::source ? source_clips : deformed_clips).emplace_back(clip, geometry);
  }
  find_border();
  for (int a = 0; a < 3; ++a) {
    Vec3d axis(0);
    axis[a] = source.scale();
    gradient_columns[a] = Vec3f(geometry.world_gradient_from_index(axis));
  }
  fill_tables();
  if (settings.lighting.has_paths()) medium = std::make_unique<LightMedium>(*this);
}

RenderContext::~RenderContext() = default;

Vec3f RenderContext::to_world(const Vec3f& g) const {
  return gradient_columns[0] * g.x + gradient_columns[1] * g.y + gradient_columns[2] * g.z;
}

Vec3f RenderContext::pull_back(const SampleBatch& batch, int lane, const Vec3d& x, const Vec3d& y,
                               const Vec3f& gradient) const {
  const bool is_smooth = source.interpolation() != Interpolation::linear;
  const bool is_pointwise = batch.pointwise >> lane & 1;
  if (is_smooth && (is_pointwise || (batch.split >> lane & 1))) {
    const std::int32_t piece = is_pointwise ? batch.piece[lane] : piece_at(*output.pointwise(), x);
    if (piece >= 0) {
      return Vec3f(output.pointwise()->pull_back_smoothly(piece, x, y, Vec3d(gradient)));
    }
  }
  if (is_pointwise) {
    return Vec3f(output.pointwise()->pull_back(batch.piece[lane], x, y, Vec3d(gradient)));
  }
  if (!(batch.bent >> lane & 1)) return gradient;
  Vec3f pulled;
  if (is_smooth && pull_back_smoothly(output, x, gradient, pulled)) return pulled;
  const float* node = tables.offsets + std::int64_t(batch.offset_node[lane]) * 3;
  return pull_back_gradient(
      {node, batch.ox[lane], batch.oy[lane], batch.oz[lane], tables.offset_dim}, gradient);
}

void RenderContext::find_border() {
  const Vec3i& dims = geometry.dims();
  if (std::min({dims.x, dims.y, dims.z}) == 1) return;
  const Vec3d last = Vec3d(dims) - Vec3d(1), spacing = geometry.spacing_mm();
  border = std::make_unique<IndexClip>(
      Clip{box_region(geometry, Vec3d(0), last), ClipKeep::inside, ClipSpace::source}, geometry);
  // Twice the depth of a face: tissue there may be compressed to half its length.
  const double reach_mm = 2 * (kFaceVoxels + 1) * std::min({spacing.x, spacing.y, spacing.z});
  for (int a = 0; a < 3; ++a) {
    Vec3d axis(0);
    axis[a] = 1;
    const double reach = reach_mm * geometry.world_gradient_from_index(axis).length();
    border_lo[a] = reach;
    border_hi[a] = last[a] - reach;
  }
}

void RenderContext::fill_tables() {
  const BrickIndex& sources = source.topology().index();
  const auto entry_of_source = [&](std::size_t b) {
    return classifier.may_be_visible(source.range(b)) ? std::int32_t(b) : SamplingTables::kSkip;
  };
  m_source_entries.assign(sources.place_count(), SamplingTables::kSkip);
  for (std::size_t b = 0; b < sources.count(); ++b) {
    m_source_entries[sources.place(b)] = entry_of_source(b);
  }

  const bool needs_highest = function.blend == Blend::maximum;
  m_output_entries.assign(output.index().place_count(), SamplingTables::kSkip);
  if (needs_highest) m_output_highest.resize(m_output_entries.size());
  for (std::size_t b = 0; b < output.brick_count(); ++b) {
    if (!output_visible[b]) continue;
    const std::size_t place = output.index().place(b);
    if (needs_highest) m_output_highest[place] = output.range(b).hi;
    std::int32_t& entry = m_output_entries[place];
    if (output.is_identity(b)) {
      if (output.beneath(b) >= 0) entry = entry_of_source(std::size_t(output.beneath(b)));
    } else if (output.is_pointwise(b)) {
      entry = SamplingTables::kPointwise + std::int32_t(output.pointwise_brick(b));
    } else if (output.is_deformed(b)) {
      entry = SamplingTables::kDeformed + output.slot(b);
    }
  }
  tables.output = output.index().lookup();
  tables.output.tables = m_output_entries.data();
  tables.output_highest = needs_highest ? m_output_highest.data() : nullptr;
  tables.source = sources.lookup();
  tables.source.tables = m_source_entries.data();
  tables.bricks = &source;
  tables.nodes = source.nodes();
  tables.offsets = output.offsets();
  tables.offset_dim = output.node_dim();
  tables.is_cubic = source.interpolation() != Interpolation::linear;
  tables.pointwise = output.pointwise();
  tables.pointwise_slots = output.pointwise_slots();
  tables.interpolated = output.interpolated();
  tables.first_visible = classifier.first_visible();
  tables.last_visible = classifier.last_visible();
  tables.visible_bits = classifier.visible_bits();
  tables.first_code = classifier.first_code();
  tables.entries_per_code = classifier.entries_per_code();
  tables.last_entry = classifier.last_entry();
}

}  // namespace supple

#include "raycast/frame.h"

#include <algorithm>

#include "raycast/light_paths.h"

namespace supple {

namespace {

template <class Bricks>
std::vector<std::uint8_t> visible_bricks(const Bricks& bricks, const Classifier& classifier) {
  std::vector<std::uint8_t> visible(bricks.topology().brick_count());
  for (std::size_t b = 0; b < visible.size(); ++b) {
    visible[b] = classifier.may_be_visible(bricks.range(b));
  }
  return visible;
}

double step_of(const Geometry& geometry, const RenderSettings& settings) {
  const Vec3d spacing = geometry.spacing_mm();
  return settings.step_voxels * std::min({spacing.x, spacing.y, spacing.z});
}

}  // namespace

Frame::Frame(const Geometry& geometry_, const SourceBricks& source_, const OffsetBricks& output_,
             const Camera& camera, const TransferFunction& function_,
             const RenderSettings& settings_, const SurfaceScene* surfaces_)
    : geometry(geometry_),
      source(source_),
      output(output_),
      function(function_),
      settings(settings_),
      step_mm(step_of(geometry_, settings_)),
      classifier(function_, source_, step_mm),
      output_visible(visible_bricks(output_, classifier)),
      bounds(output_.topology(), output_visible),
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
  for (int a = 0; a < 3; ++a) {
    Vec3d axis(0);
    axis[a] = source.scale();
    gradient_columns[a] = Vec3f(geometry.world_gradient_from_index(axis));
  }
  fill_tables();
  if (settings.lighting.has_paths()) medium = std::make_unique<LightMedium>(*this);
}

Frame::~Frame() = default;

Vec3f Frame::to_world(const Vec3f& g) const {
  return gradient_columns[0] * g.x + gradient_columns[1] * g.y + gradient_columns[2] * g.z;
}

Vec3f Frame::pull_back(const SampleBatch& batch, int lane, const Vec3d& x,
                       const Vec3f& gradient) const {
  if (batch.split >> lane & 1) {
    return Vec3f(output.split().pull_back(batch.piece[lane], x, Vec3d(gradient)));
  }
  if (!(batch.bent >> lane & 1)) return gradient;
  const float* node = tables.offsets + std::int64_t(batch.offset_node[lane]) * OffsetBricks::kStepZ;
  return pull_back_gradient({node, batch.ox[lane], batch.oy[lane], batch.oz[lane]}, gradient);
}

void Frame::fill_tables() {
  const std::size_t source_count = source.topology().brick_count();
  const std::size_t output_count = output.topology().brick_count();
  m_source_entries.resize(source_count);
  for (std::size_t b = 0; b < source_count; ++b) {
    const bool visible = classifier.may_be_visible(source.range(b));
    m_source_entries[b] = visible ? std::int32_t(b) : SamplingTables::kSkip;
  }
  m_output_entries.resize(output_count);
  m_output_highest.resize(output_count);
  for (std::size_t b = 0; b < output_count; ++b) {
    m_output_highest[b] = output.range(b).hi;
    std::int32_t entry = SamplingTables::kSkip;
    if (output_visible[b] && output.is_identity(b)) {
      const std::int32_t beneath = source.topology().find(output.topology().origin(b));
      if (beneath >= 0) entry = m_source_entries[beneath];
    } else if (output_visible[b] && output.is_split(b)) {
      entry = SamplingTables::kSplit + std::int32_t(output.split_brick(b));
    } else if (output_visible[b]) {
      entry = SamplingTables::kDeformed + output.slot(b);
    }
    m_output_entries[b] = entry;
  }
  tables.output = output.topology().lookup();
  tables.source = source.topology().lookup();
  tables.output_entries = m_output_entries.data();
  tables.output_highest = m_output_highest.data();
  tables.source_entries = m_source_entries.data();
  tables.nodes = source.nodes();
  tables.offsets = output.offsets();
  tables.split = output.has_split() ? &output.split() : nullptr;
  tables.visible_bits = classifier.visible_bits().data();
  tables.first_code = classifier.first_code();
  tables.entries_per_code = classifier.entries_per_code();
  tables.last_entry = classifier.last_entry();
}

}  // namespace supple

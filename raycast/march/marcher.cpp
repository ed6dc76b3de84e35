#include "raycast/march/marcher.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raycast/march/light_paths.h"

namespace supple {

namespace {

/// Accumulated opacity at which a ray has met a surface.
constexpr float kSurfaceOpacity = 0.5f;

constexpr std::int64_t kPieceSamples = 256;
constexpr float kNoDensity = std::numeric_limits<float>::quiet_NaN();
constexpr float kNothingYet = -std::numeric_limits<float>::infinity();

/// Density of a lane; not a number where the lane is empty.
float density_of(const SampleBatch& batch, int lane) {
  return batch.inside >> lane & 1 ? batch.encoded[lane] : kNoDensity;
}

}  // namespace

Marcher::Marcher(const RenderContext& context)
    : m_context(context),
      m_opaque(float(context.settings.early_termination)),
      m_is_maximum(context.function.blend == Blend::maximum),
      m_is_shaded(context.settings.lighting.model != ShadingModel::none),
      m_is_integrated(context.settings.classification == Classification::pre_integrated),
      m_needs_gradient(m_is_shaded || context.classifier.has_gradient_opacity()),
      m_paths(context.medium != nullptr ? std::make_unique<LightPaths>(*context.medium) : nullptr) {
}

Marcher::~Marcher() = default;

Float4 Marcher::march(const Ray& ray, float shift) {
  m_ray = {m_context.geometry.index_from_world(ray.origin_lps_mm),
           m_context.geometry.index_vector_from_world(ray.direction_lps)};
  m_world_ray = ray;
  m_view = m_context.shading.view(ray);
  m_sum = Float4{0, 0, 0, 0};
  m_surface = m_surface_crossing = -1;
  m_opaque_from = kEndless;
  if (m_paths != nullptr) m_paths->begin_ray();
  m_clips.begin_ray(m_context.deformed_clips, m_ray);
  m_crossings.begin_ray(m_context.surfaces, ray,
                        m_context.settings.clip_surfaces ? &m_clips : nullptr);
  march_volume(shift);
  while (m_crossings.next_t() < kEndless && !opaque()) composite_crossing();
  // The part of a ray that was left out once it was opaque counts as like the part that was met.
  if (!m_is_maximum && opaque()) m_sum = m_sum / m_sum[3];
  return m_sum;
}

void Marcher::march_volume(float shift) {
  const Interval span = clip_to_box(m_ray, m_context.box_lo, m_context.box_hi, {0, kEndless});
  if (!(span.begin <= span.end)) return;
  m_entry = span.begin + double(shift) * m_context.step_mm;
  if (m_entry > span.end) return;
  m_last_sample = std::int64_t((span.end - m_entry) / m_context.step_mm);

  // The block in which an opaque surface lies is judged like any other.
  const double last_block_end =
      m_crossings.opaque_t() + m_context.settings.stride * m_context.step_mm;
  const Interval kept{std::max(span.begin, m_clips.kept().begin),
                      std::min({span.end, m_clips.kept().end, last_block_end})};
  if (!(kept.begin <= kept.end)) return;

  if (m_context.settings.skip_empty_space) {
    m_context.bounds.intervals(m_ray, kept, m_intervals);
  } else {
    m_intervals.assign(1, kept);
  }
  m_maximum = kNothingYet;
  m_piece_number = -1;

  // Blocks that an interval touches, each once.
  const std::int64_t stride = m_context.settings.stride;
  std::int64_t next_block = 0;
  for (const Interval& interval : m_intervals) {
    const double begin = std::max((interval.begin - m_entry) / m_context.step_mm, 0.0);
    const double end = (interval.end - m_entry) / m_context.step_mm;
    const std::int64_t first_sample = std::max(std::int64_t(begin) - 1, std::int64_t(0));
    const std::int64_t last_sample = std::min(std::int64_t(end) + 1, m_last_sample);
    const std::int64_t first = std::max(next_block, (first_sample + stride - 1) / stride);
    const std::int64_t last = (last_sample + stride - 1) / stride;
    if (m_is_maximum) {
      find_maximum(std::max((first - 1) * stride + 1, std::int64_t(0)), last * stride);
    } else {
      march_blocks(first, last);
    }
    if (opaque()) break;
    next_block = std::max(next_block, last + 1);
  }
  if (m_is_maximum && m_maximum > kNothingYet) {
    const Float4 colour = m_context.classifier.classify(m_maximum);
    m_sum = colour * colour[3];
    m_sum[3] = colour[3];
    if (m_sum[3] < kSurfaceOpacity) m_surface = -1;
  }
}

/// Samples first, first + stride, … up to `last` that one batch can hold.
int Marcher::count_in_piece(std::int64_t first, int stride, std::int64_t last) const {
  const std::int64_t in_piece = (kPieceSamples - 1 - first % kPieceSamples) / stride + 1;
  const std::int64_t wanted = (last - first) / stride + 1;
  return int(std::min({in_piece, wanted, std::int64_t(SampleBatch::kLanes)}));
}

void Marcher::read(std::int64_t first, int stride, int count, SampleBatch& batch) {
  const std::int64_t number = first / kPieceSamples;
  if (number != m_piece_number) {
    m_piece_number = number;
    const Vec3d start = m_ray.at(time_of(number * kPieceSamples));
    m_piece.base = floor_voxel(start);
    m_piece.first = Vec3f(start - Vec3d(m_piece.base));
    m_piece.per_sample = Vec3f(m_ray.direction * m_context.step_mm);
  }
  m_piece.above = m_maximum;
  sample_batch(m_context.tables, m_piece, int(first - number * kPieceSamples), stride, count,
               batch);
  m_samples += __builtin_popcount(batch.read);
  if (!m_context.settings.clips.empty()) leave_out_clipped(first, stride, batch);
}

void Marcher::leave_out_clipped(std::int64_t first, int stride, SampleBatch& batch) const {
  const RaySamples samples = samples_of(batch, first, stride);
  for (std::uint32_t rest = batch.inside; rest != 0; rest &= rest - 1) {
    const int lane = __builtin_ctz(rest);
    bool clipped = m_clips.is_clipped(samples.t_of(lane));
    for (const IndexClip& clip : m_context.source_clips) {
      clipped = clipped || !clip.keeps(samples.read_at(lane));
    }
    if (!clipped) continue;
    batch.inside &= ~(1u << lane);
    batch.visible &= ~(1u << lane);
  }
}

/// Raises the maximum to that of the samples first … last.
void Marcher::find_maximum(std::int64_t first, std::int64_t last) {
  last = std::min(last, m_last_sample);
  for (std::int64_t n = first; n <= last;) {
    const int count = count_in_piece(n, 1, last);
    read(n, 1, count, m_ends);
    for (std::uint32_t rest = m_ends.inside; rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      if (time_of(n + lane) >= m_crossings.opaque_t()) return;
      if (m_ends.encoded[lane] <= m_maximum) continue;
      m_maximum = m_ends.encoded[lane];
      m_surface = n + lane;
      m_surface_t = time_of(m_surface);
    }
    n += count;
  }
}

void Marcher::march_blocks(std::int64_t first, std::int64_t last) {
  const int stride = m_context.settings.stride;
  if (stride == 1) return composite_samples(first, last);
  bool visible_before = false;
  float before = kNoDensity;
  for (std::int64_t block = std::max(first - 1, std::int64_t(0)); block <= last;) {
    const int count = count_in_piece(block * stride, stride, last * stride);
    const std::int64_t readable = (m_last_sample - block * stride) / stride + 1;
    m_ends.visible = m_ends.inside = 0;
    if (block * stride <= m_last_sample) {
      read(block * stride, stride, int(std::min(std::int64_t(count), readable)), m_ends);
    }
    const std::uint32_t visible = m_ends.visible;
    const std::uint32_t crossed = m_is_integrated ? seen_between(m_ends, before) : 0;
    before = density_of(m_ends, count - 1);
    std::uint32_t contributing =
        (crossed | visible | visible << 1 | std::uint32_t(visible_before)) & ((1u << count) - 1);
    if (block < first) contributing &= ~1u;
    visible_before = visible >> (count - 1) & 1;
    while (contributing != 0) {
      const int begin = __builtin_ctz(contributing);
      const int length = __builtin_ctz(~(contributing >> begin));
      composite_samples(std::max((block + begin - 1) * stride + 1, std::int64_t(0)),
                        (block + begin + length - 1) * stride);
      if (opaque()) return;
      contributing &= ~(((1u << length) - 1) << begin);
    }
    block += count;
  }
}

/// Lanes that hold or end a way through densities that are not transparent, each from the lane
/// before it; `before` is the density ahead of the first.
std::uint32_t Marcher::seen_between(const SampleBatch& batch, float before) const {
  std::uint32_t seen = batch.visible;
  for (std::uint32_t rest = batch.inside & ~batch.visible; rest != 0; rest &= rest - 1) {
    const int lane = __builtin_ctz(rest);
    const float front = lane > 0 ? density_of(batch, lane - 1) : before;
    if (!(front == front)) continue;
    const auto [lo, hi] = std::minmax(front, batch.encoded[lane]);
    seen |= std::uint32_t(m_context.classifier.may_be_visible({lo, hi})) << lane;
  }
  return seen;
}

void Marcher::composite_samples(std::int64_t first, std::int64_t last) {
  last = std::min(last, m_last_sample);
  SampleBatch& batch = m_samples_between;
  for (std::int64_t next = first; next <= last;) {
    // The sample before, from which the way to the first leads, in the same batch where it can be.
    const bool has_before = m_is_integrated && next > 0;
    const bool is_with_it = has_before && next % kPieceSamples != 0;
    float before = kNoDensity;
    if (has_before && !is_with_it) {
      read(next - 1, 1, 1, m_before);
      before = density_of(m_before, 0);
    }
    const std::int64_t n = is_with_it ? next - 1 : next;
    const int count = count_in_piece(n, 1, last);
    read(n, 1, count, batch);
    if (m_is_integrated) batch.visible = seen_between(batch, before);
    if (is_with_it) batch.visible &= ~1u;
    if (batch.visible != 0 && m_needs_gradient) find_gradients(batch.visible, before == before);
    std::uint32_t unlit = m_needs_gradient ? batch.visible : 0;
    for (std::uint32_t rest = batch.visible; rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      if (unlit >> lane & 1) unlit &= ~light(unlit, n);
      composite(lane, n + lane, lane > 0 ? density_of(batch, lane - 1) : before);
      if (opaque()) {
        // The end of the sample's block was read, too.
        m_opaque_from = time_of(n + lane + m_context.settings.stride);
        return;
      }
    }
    next = n + count;
  }
}

/// `has_before`: the sample before lane 0 is in m_before.
void Marcher::find_gradients(std::uint32_t lanes, bool has_before) {
  SampleBatch& batch = m_samples_between;
  const std::uint32_t fronts = m_is_integrated ? lanes >> 1 & batch.inside : 0;
  sample_gradients(m_context.tables, batch, lanes | fronts);
  if (m_is_integrated) average_gradients(lanes);
  if (!has_before || !(lanes & 1)) return;
  sample_gradients(m_context.tables, m_before, 1);
  batch.gx[0] = (batch.gx[0] + m_before.gx[0]) / 2;
  batch.gy[0] = (batch.gy[0] + m_before.gy[0]) / 2;
  batch.gz[0] = (batch.gz[0] + m_before.gz[0]) / 2;
}

/// Finds how the first of these lanes lie to the light; sample `first` is in lane 0. Returns those
/// lanes: all, or, where faces have to be searched for lane by lane, so few that most are seen
/// before the ray is opaque.
std::uint32_t Marcher::light(std::uint32_t lanes, std::int64_t first) {
  constexpr int kFew = 4;
  SampleBatch& batch = m_samples_between;
  const RaySamples samples = samples_of(batch, first);
  if (!m_context.settings.clips.empty() || ((batch.pointwise | batch.split) & lanes) != 0) {
    std::uint32_t later = lanes;
    for (int n = 0; n < kFew; ++n) later &= later - 1;
    lanes &= ~later;
  }
  if (m_context.settings.transform_gradient) {
    for (std::uint32_t rest = lanes & (batch.bent | batch.pointwise); rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      const Vec3f gradient(batch.gx[lane], batch.gy[lane], batch.gz[lane]);
      const Vec3f pulled_back =
          m_context.pull_back(batch, lane, samples.seen_at(lane), samples.read_at(lane), gradient);
      batch.gx[lane] = pulled_back.x;
      batch.gy[lane] = pulled_back.y;
      batch.gz[lane] = pulled_back.z;
    }
  }
  find_faces(m_context, samples, m_view.towards_eye, lanes, m_lit);
  light_lanes(m_context.shading, m_view, m_context.gradient_columns, batch, lanes, m_lit);
  return lanes;
}

/// Averages gradients to those in the middle of the way from the lane before, the last lane first,
/// so that each finds the one before as it was sampled.
void Marcher::average_gradients(std::uint32_t lanes) {
  SampleBatch& batch = m_samples_between;
  for (std::uint32_t rest = lanes & batch.inside << 1; rest != 0;) {
    const int lane = 31 - __builtin_clz(rest);
    for (float* along : {batch.gx, batch.gy, batch.gz}) {
      along[lane] = (along[lane] + along[lane - 1]) / 2;
    }
    rest &= ~(1u << lane);
  }
}

/// Composites a sample; `before`: density of the one before, not a number when that was empty.
void Marcher::composite(int lane, std::int64_t n, float before) {
  const float encoded = m_samples_between.encoded[lane];
  Float4 colour = m_is_integrated && before == before
                      ? m_context.classifier.integrate(before, encoded)
                      : m_context.classifier.classify(encoded);
  float alpha = colour[3];
  if (m_context.classifier.has_gradient_opacity()) {
    alpha = m_context.classifier.with_gradient(alpha, m_lit.magnitude[lane]);
  }
  if (m_is_shaded) {
    const LightReached* light_reached =
        m_paths != nullptr ? &reach_at(time_of(n), m_lit.facing(lane)) : nullptr;
    colour = m_context.shading.lit(
        colour, [&](int light) { return m_lit.terms(light, lane); }, light_reached);
  }
  colour[3] = 1;
  const float before_it = m_sum[3];
  if (m_crossings.next_t() < time_of(n + 1)) {
    composite_between_crossings(time_of(n), colour, alpha);
  } else {
    add(colour, alpha);
  }
  if (has_met_surface() || m_sum[3] < kSurfaceOpacity) return;
  m_surface = n;
  m_surface_t = time_of(n) + (part_to_surface(before_it, alpha) - 0.5) * m_context.step_mm;
}

/// The part of a sample's step, 0 … 1, after which opacity reaches that of a surface: within the
/// step transparency falls exponentially.
double Marcher::part_to_surface(float before, float alpha) {
  const double wanted = (1 - double(kSurfaceOpacity)) / (1 - double(before));
  if (!(alpha < 1)) return 0;
  return std::clamp(std::log(wanted) / std::log(1 - double(alpha)), 0.0, 1.0);
}

const LightReached& Marcher::reach_at(double t, const Facing& facing) {
  const Vec3d pos = m_world_ray.origin_lps_mm + m_world_ray.direction_lps * t;
  return m_paths->reach_of_sample(t, pos, facing, m_view.towards_eye);
}

/// A sample stands for half a step before and behind it: surfaces divide it.
void Marcher::composite_between_crossings(double t, const Float4& colour, float alpha) {
  const double begin = t - 0.5 * m_context.step_mm, end = t + 0.5 * m_context.step_mm;
  const auto add_part = [&](double from, double to) {
    const double share = std::max(to - from, 0.0) / m_context.step_mm;
    add(colour, float(corrected_opacity(alpha, share, 1)));
  };
  double done = begin;
  while (m_crossings.next_t() < end && !opaque()) {
    add_part(done, m_crossings.next_t());
    done = std::max(done, m_crossings.next_t());
    composite_crossing();
  }
  add_part(done, end);
}

/// The next surface of the ray.
void Marcher::composite_crossing() {
  const TriangleHit& hit = m_crossings.hit(m_crossings.next());
  const SurfacePoint point = m_context.surfaces->point(m_world_ray, hit);
  Float4 colour = point.colour;
  if (m_context.settings.lighting.model != ShadingModel::none) {
    const LightReached light_reached =
        m_paths != nullptr ? m_paths->reach_of_surface(point) : LightReached();
    colour = m_context.shading.shaded(colour, {point.normal, 1}, m_view, &light_reached);
    colour[3] = 1;
  }
  add(colour, m_context.surfaces->opacity(hit));
  if (!has_met_surface() && m_sum[3] >= kSurfaceOpacity) m_surface_crossing = m_crossings.next();
  m_crossings.pass();
}

bool Marcher::surface(SeenSurface& seen) {
  if (m_surface_crossing >= 0) {
    const TriangleHit& hit = m_crossings.hit(m_surface_crossing);
    seen = {hit.t, m_context.surfaces->point(m_world_ray, hit).normal, 0,
            m_context.surfaces->surface(hit)};
    return true;
  }
  if (m_surface < 0 || m_sum[3] < kSurfaceOpacity) return false;
  m_maximum = kNothingYet;  // or the sample would not be read again
  SampleBatch& batch = m_samples_between;
  read(m_surface, 1, 1, batch);
  find_gradients(1, false);
  light(1, m_surface);
  const RaySamples samples = samples_of(batch, m_surface);
  const Vec3d offset = samples.read_at(0) - samples.seen_at(0);
  const bool is_bent = (batch.bent | batch.pointwise) & 1;
  seen.distance_mm = m_surface_t;
  seen.surface = -1;
  seen.normal_lps = m_lit.normal.at(0);
  seen.offset_mm =
      is_bent ? float(m_context.geometry.world_vector_from_index(offset).length()) : 0.0f;
  return true;
}

}  // namespace supple

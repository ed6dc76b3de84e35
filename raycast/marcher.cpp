#include "raycast/marcher.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "raycast/light_paths.h"

namespace supple {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Voxels behind the face of a clip that are shaded as the face; one more fades to the tissue's own
/// gradients.
constexpr double kFaceVoxels = 2;

/// Accumulated opacity at which a ray has met a surface.
constexpr float kSurfaceOpacity = 0.5f;

int floor_to_int(double x) {
  const int truncated = int(x);
  return truncated - (x < truncated ? 1 : 0);
}
Vec3i floor_to_voxel(const Vec3d& p) {
  return {floor_to_int(p.x), floor_to_int(p.y), floor_to_int(p.z)};
}

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
      source_visible(visible_bricks(source_, classifier)),
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
  if (settings.lighting.has_paths()) medium = std::make_unique<LightMedium>(*this);
}

Frame::~Frame() = default;

Vec3f Frame::to_world(const Vec3f& g) const {
  return gradient_columns[0] * g.x + gradient_columns[1] * g.y + gradient_columns[2] * g.z;
}

Marcher::Marcher(const Frame& frame)
    : m_frame(frame),
      m_output_cursor(frame.output.topology()),
      m_source_cursor(frame.source.topology()),
      m_opaque(float(frame.settings.early_termination)),
      m_is_maximum(frame.function.blend == Blend::maximum),
      m_paths(frame.medium != nullptr ? std::make_unique<LightPaths>(*frame.medium) : nullptr) {}

Marcher::~Marcher() = default;

Float4 Marcher::march(const Ray& ray) {
  m_ray = {m_frame.geometry.index_from_world(ray.origin_lps_mm),
           m_frame.geometry.index_vector_from_world(ray.direction_lps)};
  m_world_ray = ray;
  m_view = m_frame.shading.view(ray);
  m_sum = Float4{0, 0, 0, 0};
  m_surface = m_surface_crossing = -1;
  if (m_paths != nullptr) m_paths->begin_ray();
  clip_ray();
  find_crossings(ray);
  march_volume();
  while (m_next_crossing_t < kInfinity && !opaque()) composite_crossing();
  return m_sum;
}

void Marcher::march_volume() {
  const Interval span = clip_to_box(m_ray, m_frame.box_lo, m_frame.box_hi, {0, kInfinity});
  if (!(span.begin <= span.end)) return;
  m_entry = span.begin;
  m_last_sample = std::int64_t((span.end - span.begin) / m_frame.step_mm);

  // The block in which an opaque surface lies is judged as ever.
  const double last_block_end = m_end + m_frame.settings.stride * m_frame.step_mm;
  const Interval kept{std::max(span.begin, m_kept.begin),
                      std::min({span.end, m_kept.end, last_block_end})};
  if (!(kept.begin <= kept.end)) return;

  if (m_frame.settings.skip_empty_space) {
    m_frame.bounds.intervals(m_ray, kept, m_intervals);
  } else {
    m_intervals.assign(1, kept);
  }
  m_maximum = -std::numeric_limits<float>::infinity();

  // Blocks that an interval touches, each once.
  const std::int64_t stride = m_frame.settings.stride;
  std::int64_t next_block = 0;
  for (const Interval& interval : m_intervals) {
    const double begin = (interval.begin - m_entry) / m_frame.step_mm;
    const double end = (interval.end - m_entry) / m_frame.step_mm;
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
  if (m_is_maximum && m_maximum > -std::numeric_limits<float>::infinity()) {
    const Float4 colour = m_frame.classifier.classify(m_maximum);
    m_sum = colour * colour[3];
    m_sum[3] = colour[3];
    if (m_sum[3] < kSurfaceOpacity) m_surface = -1;
  }
}

void Marcher::clip_ray() {
  m_kept = {-kInfinity, kInfinity};
  m_removed.clear();
  for (const IndexClip& clip : m_frame.deformed_clips) {
    const Interval part = clip.along(m_ray);
    if (clip.keep() == ClipKeep::outside) {
      if (part.begin <= part.end) m_removed.push_back(part);
      continue;
    }
    m_kept = {std::max(m_kept.begin, part.begin), std::min(m_kept.end, part.end)};
  }
}

bool Marcher::is_clipped(double t) const {
  if (t < m_kept.begin || t > m_kept.end) return true;
  return std::any_of(m_removed.begin(), m_removed.end(), [t](const Interval& removed) {
    return t >= removed.begin && t <= removed.end;
  });
}

/// Samples just behind a clip are shaded as its face: their own gradients belong to the inside of
/// the tissue and would leave what the clip opens dark and rough.
void Marcher::find_face(const IndexClip& clip, const Vec3d& pos, Probe& probe) const {
  const bool is_bent = clip.space() == ClipSpace::source;
  const auto as_seen = [&](const Vec3d& normal) {
    return is_bent ? pull_back(probe, Vec3f(normal)) : Vec3f(normal);
  };
  double mm_ago = 0;
  const IndexClip::Plane* plane = clip.face_behind(
      pos, [&](const Vec3d& normal) { return Vec3d(as_seen(normal)).dot(m_ray.direction); },
      mm_ago);
  if (plane != nullptr) set_face(as_seen(plane->normal), mm_ago, probe);
}

/// A ray that came to the sample out of a gap sees the face of the piece as it does that of a clip.
void Marcher::find_piece_face(Probe& probe) const {
  const SplitOffsets& split = m_frame.output.split();
  const Vec3d x = m_ray.at(probe.t);
  const Vec3d normal = split.face_normal(probe.piece, x);
  const double gain = normal.dot(m_ray.direction);  // mm deeper per mm
  if (gain > 0) set_face(Vec3f(normal), split.depth_mm(probe.piece, x) / gain, probe);
}

/// `normal`: index space, of a face that the ray crossed some mm ago.
void Marcher::set_face(const Vec3f& normal, double mm_ago, Probe& probe) const {
  const double voxels = mm_ago / m_frame.step_mm * m_frame.settings.step_voxels;
  const float share = float(std::clamp(kFaceVoxels + 1 - voxels, 0.0, 1.0));
  if (share <= probe.face_share) return;
  probe.face = m_frame.to_world(normal).normalized();
  if (probe.face.dot(m_view.towards_eye) < 0) probe.face = -probe.face;
  probe.face_share = share;
}

/// Raises the maximum to that of the samples first … last.
void Marcher::find_maximum(std::int64_t first, std::int64_t last) {
  for (std::int64_t n = first; n <= last && time_of(n) < m_end; ++n) {
    const Probe sample = probe(n);
    if (!sample.is_inside || sample.encoded <= m_maximum) continue;
    m_maximum = sample.encoded;
    m_surface = n;
  }
}

void Marcher::march_blocks(std::int64_t first, std::int64_t last) {
  const std::int64_t stride = m_frame.settings.stride;
  bool visible_before = first > 0 && probe((first - 1) * stride).visible();
  for (std::int64_t block = first; block <= last; ++block) {
    const Probe end = probe(block * stride);
    if (visible_before || end.visible()) {
      for (std::int64_t n = std::max((block - 1) * stride + 1, std::int64_t(0)); n < block * stride;
           ++n) {
        composite(n, probe(n));
        if (opaque()) return;
      }
      composite(block * stride, end);
      if (opaque()) return;
    }
    visible_before = end.visible();
  }
}

Marcher::Probe Marcher::probe(std::int64_t n) {
  Probe result;
  if (n > m_last_sample) return result;
  const double t = time_of(n);
  if (is_clipped(t)) return result;
  result.t = t;
  const Vec3d seen_at = m_ray.at(t);
  Vec3d pos = seen_at;
  Vec3i base = floor_to_voxel(pos);
  const std::int32_t out = m_output_cursor.find(base);
  if (out < 0 || !m_frame.output_visible[out]) return result;
  if (m_is_maximum && m_frame.output.range(out).hi <= m_maximum) return result;
  if (!m_frame.output.is_identity(out)) {
    const bool found = m_frame.output.is_split(out) ? follow_split(out, pos, result.piece)
                                                    : follow_offset(out, base, pos, result.offset);
    if (!found) return result;
    base = floor_to_voxel(pos);
  }
  for (const IndexClip& clip : m_frame.source_clips) {
    if (!clip.keeps(pos)) return result;
  }
  const std::int32_t in = m_source_cursor.find(base);
  if (in < 0 || !m_frame.source_visible[in]) return result;

  const Vec3i local = base - m_frame.source.topology().origin(in);
  result.source = {m_frame.source.node(in, local), float(pos.x - base.x), float(pos.y - base.y),
                   float(pos.z - base.z)};
  ++m_samples;
  result.is_inside = sample_cell(result.source, result.encoded);
  if (!result.is_inside) return result;
  result.colour = m_frame.classifier.classify(result.encoded);
  if (!result.visible()) return result;
  for (const IndexClip& clip : m_frame.deformed_clips) find_face(clip, seen_at, result);
  for (const IndexClip& clip : m_frame.source_clips) find_face(clip, pos, result);
  if (result.piece >= 0) find_piece_face(result);
  return result;
}

/// x + o(x); false where there is no offset.
bool Marcher::follow_offset(std::size_t brick, const Vec3i& base, Vec3d& pos,
                            OffsetCell& cell) const {
  const Vec3i local = base - m_frame.output.topology().origin(brick);
  cell = {m_frame.output.node(brick, local), float(pos.x - base.x), float(pos.y - base.y),
          float(pos.z - base.z)};
  const Float4 offset = sample_offset(cell);
  if (!(offset[0] == offset[0])) return false;
  pos += Vec3d(offset[0], offset[1], offset[2]);
  return true;
}

/// The same in a split brick, with the offset of the sample's own piece.
bool Marcher::follow_split(std::size_t brick, Vec3d& pos, std::int32_t& piece) const {
  SplitOffsets::Sample found;
  if (!m_frame.output.split().sample(m_frame.output.split_brick(brick), pos, found)) return false;
  pos += found.offset;
  piece = found.piece;
  return true;
}

/// (I + grad o)^T g where the probe is.
Vec3f Marcher::pull_back(const Probe& probe, const Vec3f& gradient) const {
  if (probe.piece >= 0) {
    const Vec3d x = m_ray.at(probe.t);
    return Vec3f(m_frame.output.split().pull_back(probe.piece, x, Vec3d(gradient)));
  }
  return probe.offset.node != nullptr ? pull_back_gradient(probe.offset, gradient) : gradient;
}

Vec3f Marcher::world_gradient(const Probe& probe) const {
  Vec3f g = sample_gradient(probe.source, probe.encoded);
  if (m_frame.settings.transform_gradient) g = pull_back(probe, g);
  return m_frame.to_world(g);
}

void Marcher::composite(std::int64_t n, const Probe& probe) {
  if (!probe.visible()) return;
  Float4 colour = probe.colour;
  float alpha = colour[3];
  const bool is_shaded = m_frame.settings.lighting.model != ShadingModel::none;
  if (is_shaded || m_frame.classifier.has_gradient_opacity()) {
    const Vec3f gradient = world_gradient(probe);
    const float magnitude = gradient.length();
    if (m_frame.classifier.has_gradient_opacity()) {
      alpha = m_frame.classifier.with_gradient(alpha, magnitude);
    }
    if (is_shaded) {
      const Shading& shading = m_frame.shading;
      const Facing facing =
          shading.facing(gradient, magnitude, probe.face, probe.face_share, m_view);
      colour = m_paths != nullptr
                   ? shading.shaded(colour, facing, m_view, reach_at(time_of(n), facing))
                   : shading.shaded(colour, facing, m_view);
    }
  }
  colour[3] = 1;
  if (m_next_crossing_t < time_of(n + 1)) {
    composite_between_crossings(time_of(n), colour, alpha);
  } else {
    add(colour, alpha);
  }
  if (!has_met_surface() && m_sum[3] >= kSurfaceOpacity) m_surface = n;
}

const Reach& Marcher::reach_at(double t, const Facing& facing) {
  const Vec3d pos = m_world_ray.origin_lps_mm + m_world_ray.direction_lps * t;
  return m_paths->reach_of_sample(t, pos, facing, m_view.towards_eye);
}

/// A sample stands for half a step before and behind it: surfaces divide it.
void Marcher::composite_between_crossings(double t, const Float4& colour, float alpha) {
  const double begin = t - 0.5 * m_frame.step_mm, end = t + 0.5 * m_frame.step_mm;
  const auto add_part = [&](double from, double to) {
    const double share = std::max(to - from, 0.0) / m_frame.step_mm;
    add(colour, float(corrected_opacity(alpha, share, 1)));
  };
  double done = begin;
  while (m_next_crossing_t < end && !opaque()) {
    add_part(done, m_next_crossing_t);
    done = std::max(done, m_next_crossing_t);
    composite_crossing();
  }
  add_part(done, end);
}

/// Where the ray crosses surfaces, up to the first opaque one.
void Marcher::find_crossings(const Ray& ray) {
  m_next_crossing = 0;
  m_next_crossing_t = m_end = kInfinity;
  if (m_frame.surfaces == nullptr) return;
  m_frame.surfaces->crossings(ray, {0, kInfinity}, m_crossings);
  if (m_frame.settings.clip_surfaces) {
    m_crossings.erase(std::remove_if(m_crossings.begin(), m_crossings.end(),
                                     [&](const TriangleHit& hit) { return is_clipped(hit.t); }),
                      m_crossings.end());
  }
  if (m_crossings.empty()) return;
  m_next_crossing_t = m_crossings.front().t;
  for (const TriangleHit& hit : m_crossings) {
    if (m_frame.surfaces->opacity(hit) < 1) continue;
    m_end = hit.t;
    break;
  }
}

/// The next surface of the ray.
void Marcher::composite_crossing() {
  const TriangleHit& hit = m_crossings[m_next_crossing];
  const SurfacePoint point = m_frame.surfaces->point(m_world_ray, hit);
  Float4 colour = point.colour;
  if (m_frame.settings.lighting.model != ShadingModel::none) {
    const Reach reach = m_paths != nullptr ? m_paths->reach_of_surface(point) : Reach();
    colour = m_frame.shading.shaded(colour, {point.normal, 1}, m_view, reach);
    colour[3] = 1;
  }
  add(colour, m_frame.surfaces->opacity(hit));
  if (!has_met_surface() && m_sum[3] >= kSurfaceOpacity) m_surface_crossing = m_next_crossing;
  ++m_next_crossing;
  m_next_crossing_t =
      m_next_crossing < m_crossings.size() ? m_crossings[m_next_crossing].t : kInfinity;
}

bool Marcher::surface(SeenSurface& seen) {
  if (m_surface_crossing >= 0) {
    const TriangleHit& hit = m_crossings[m_surface_crossing];
    seen = {hit.t, m_frame.surfaces->point(m_world_ray, hit).normal, 0};
    return true;
  }
  if (m_surface < 0 || m_sum[3] < kSurfaceOpacity) return false;
  m_maximum = -std::numeric_limits<float>::infinity();  // or the sample would not be read again
  const Probe at = probe(m_surface);
  const Vec3f gradient = world_gradient(at);
  seen.distance_mm = time_of(m_surface);
  seen.normal_lps =
      m_frame.shading.facing(gradient, gradient.length(), at.face, at.face_share, m_view).normal;
  seen.offset_mm = 0;
  if (at.offset.node != nullptr) {
    const Float4 o = sample_offset(at.offset);
    seen.offset_mm =
        float(m_frame.geometry.world_vector_from_index(Vec3d(o[0], o[1], o[2])).length());
  }
  Vec3d o;
  if (at.piece >= 0 && m_frame.output.split().offset_of(at.piece, m_ray.at(at.t), o)) {
    seen.offset_mm = float(m_frame.geometry.world_vector_from_index(o).length());
  }
  return true;
}

}  // namespace supple

#include "raycast/march/light_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {

namespace {

constexpr int kEntries = 4096;
constexpr double kMostOpaque = 1 - 1e-9;  // what lets nothing through has no optical depth
constexpr float kDark = 7;                // optical depth of 1/1000
constexpr double kVolumeBias = 2;         // voxels
constexpr double kShadowReuse = 1, kOpennessReuse = 2;  // voxels
constexpr int kDirections = 32;                         // of ambient occlusion
constexpr double kWidening = 0.25;  // its steps are this share of the way, at least a voxel
constexpr float kSpent = 1e-2f;     // of ambient light on its way

/// Direction n of a set that is evenly spread over the sphere (Fibonacci lattice).
Vec3d direction_around(int n) {
  constexpr double kGoldenAngle = 2.39996322972865332;
  const double z = 1 - (2 * n + 1.0) / kDirections, radius = std::sqrt(1 - z * z);
  return {radius * std::cos(n * kGoldenAngle), radius * std::sin(n * kGoldenAngle), z};
}

bool is_kept(const std::vector<IndexClip>& clips, const Vec3d& pos_index) {
  return std::all_of(clips.begin(), clips.end(),
                     [&](const IndexClip& clip) { return clip.keeps(pos_index); });
}

/// The t at which the ray leaves the brick.
double end_of_brick(const IndexRay& ray, const Vec3i& voxel) {
  double end = kEndless;
  for (int a = 0; a < 3; ++a) {
    const int low = voxel[a] & ~(kBrickDim - 1);
    if (ray.direction[a] > 0)
      end = std::min(end, (low + kBrickDim - ray.origin[a]) / ray.direction[a]);
    if (ray.direction[a] < 0) end = std::min(end, (low - ray.origin[a]) / ray.direction[a]);
  }
  return end;
}

}  // namespace

LightMedium::LightMedium(const RenderContext& context_) : context(context_) {
  const auto direction = [&](const Vec3f& world) {
    return Direction{world, context.geometry.index_vector_from_world(Vec3d(world))};
  };
  for (int n = 0; n < context.shading.light_count(); ++n) {
    lights.push_back(direction(context.shading.towards_light(n)));
  }
  for (int n = 0; n < kDirections; ++n) around.push_back(direction(Vec3f(direction_around(n))));
  const Vec3d spacing = context.geometry.spacing_mm();
  voxel_mm = std::min({spacing.x, spacing.y, spacing.z});

  const TransferFunction& f = context.function;
  const double first = context.source.encoded(f.opacity.front().density);
  const double last = context.source.encoded(f.opacity.back().density);
  m_lo = float(first);
  m_entries_per_code = last > first ? float((kEntries - 1) / (last - first)) : 0;
  m_extinction.resize(kEntries + 1);
  for (int n = 0; n <= kEntries; ++n) {
    const double code = first + std::min(n, kEntries - 1) * (last - first) / (kEntries - 1);
    const double opacity = std::min(f.opacity_at(context.source.density(code)), kMostOpaque);
    m_extinction[n] = float(-std::log1p(-opacity) / f.unit_distance_mm);
  }
  const double apart_mm = context.settings.lighting.volume_mm;
  if (apart_mm > 0) {
    volume = std::make_unique<LightVolume>(context.geometry, context.box_lo, context.box_hi,
                                           apart_mm, int(lights.size()));
  }
}

float LightMedium::with_gradient(float extinction, float gradient_per_mm) const {
  const double unit = context.function.unit_distance_mm;
  const double opacity = -std::expm1(-double(extinction) * unit);
  const double share = context.function.gradient_opacity_at(gradient_per_mm);
  return float(-std::log1p(-opacity * share) / unit);
}

float LightMedium::extinction(float encoded) const {
  const float entry = std::clamp((encoded - m_lo) * m_entries_per_code, 0.0f, float(kEntries - 1));
  const int n = int(entry);
  return m_extinction[n] + (entry - float(n)) * (m_extinction[n + 1] - m_extinction[n]);
}

LightPaths::LightPaths(const LightMedium& medium) : m_medium(medium), m_context(medium.context) {}

void LightPaths::begin_ray() {
  const Lighting& lighting = m_context.settings.lighting;
  m_reach = LightReached();
  m_shadows_until = lighting.shadows ? -kEndless : kEndless;
  m_openness_until = lighting.occlusion_radius_mm > 0 ? -kEndless : kEndless;
}

const LightReached& LightPaths::reach_of_sample(double t_mm, const Vec3d& pos_lps_mm,
                                                const Facing& facing, const Vec3f& towards_eye) {
  const bool shadows_are_due = t_mm >= m_shadows_until;
  const bool openness_is_due = t_mm >= m_openness_until;
  if (!shadows_are_due && !openness_is_due) return m_reach;
  const Vec3f before = facing.normal * facing.trust + towards_eye * (1 - facing.trust);
  const Vec3d step = m_context.geometry.index_vector_from_world(Vec3d(before)).normalized();
  const Vec3d pos_index = m_context.geometry.index_from_world(pos_lps_mm);
  const PathStart place{pos_index + step * kVolumeBias, pos_lps_mm, facing};
  if (m_medium.volume != nullptr) {
    m_reach = interpolated(place);
    m_shadows_until = m_openness_until = t_mm + kShadowReuse * m_medium.voxel_mm;
    return m_reach;
  }
  if (shadows_are_due) {
    find_shadows(place, m_reach);
    m_shadows_until = t_mm + kShadowReuse * m_medium.voxel_mm;
  }
  if (openness_is_due) {
    m_reach.openness = openness(place);
    m_openness_until = t_mm + kOpennessReuse * m_medium.voxel_mm;
  }
  return m_reach;
}

LightReached LightPaths::interpolated(const PathStart& place) {
  const Lighting& lighting = m_context.settings.lighting;
  const LightVolume::Light light = m_medium.volume->at(
      place.volume_start, [this](const Vec3d& node) { return light_of_node(node); });
  LightReached reached;
  if (lighting.shadows) std::copy(light.lights.begin(), light.lights.end(), reached.lights.begin());
  if (lighting.occlusion_radius_mm > 0) reached.openness = light.openness(place.facing);
  return reached;
}

/// Light at a node, which faces all around: its paths begin without a bias.
LightVolume::Light LightPaths::light_of_node(const Vec3d& node) {
  const Lighting& lighting = m_context.settings.lighting;
  const PathStart place{node, m_context.geometry.world_from_index(node), {}};
  LightVolume::Light light;
  PathSamples own;
  own.count = 1;
  own.t[0] = 0;
  find_extinctions({node, Vec3d(0)}, own);
  light.clear = std::exp(-own.extinction[0] * float(m_medium.volume->spacing_mm()));
  for (std::size_t n = 0; lighting.shadows && n < m_medium.lights.size(); ++n) {
    light.lights[n] = transmittance(place, m_medium.lights[n]);
  }
  if (lighting.occlusion_radius_mm == 0) return light;
  for (const LightMedium::Direction& direction : m_medium.around) {
    light.add_around(direction.world, ambient_along(place, direction), 1.0f / kDirections);
  }
  return light;
}

LightReached LightPaths::reach_of_surface(const SurfacePoint& point) {
  const PathStart place{
      m_context.geometry.index_from_world(point.light_start), point.light_start, {point.normal, 1}};
  LightReached light_reached;
  if (m_context.settings.lighting.shadows) find_shadows(place, light_reached);
  if (m_context.settings.lighting.occlusion_radius_mm > 0) light_reached.openness = openness(place);
  return light_reached;
}

void LightPaths::find_shadows(const PathStart& place, LightReached& light_reached) {
  for (std::size_t n = 0; n < m_medium.lights.size(); ++n) {
    light_reached.lights[n] = transmittance(place, m_medium.lights[n]);
  }
}

void LightPaths::find_crossings(const Vec3d& start, const Vec3f& direction, double length_mm) {
  m_crossings.clear();
  if (m_context.surfaces == nullptr) return;
  const Ray ray{start, Vec3d(direction)};
  m_context.surfaces->crossings(ray, {0, length_mm}, m_crossings);
  if (!m_context.settings.clip_surfaces) return;
  const auto is_cut = [&](const TriangleHit& hit) {
    const Vec3d pos = m_context.geometry.index_from_world(start + ray.direction_lps * hit.t);
    return !is_kept(m_context.deformed_clips, pos);
  };
  m_crossings.erase(std::remove_if(m_crossings.begin(), m_crossings.end(), is_cut),
                    m_crossings.end());
}

float LightPaths::surface_transmittance(const Vec3d& start, const Vec3f& direction) {
  find_crossings(start, direction, kEndless);
  float passed = 1;
  for (const TriangleHit& crossing : m_crossings)
    passed *= 1 - m_context.surfaces->opacity(crossing);
  return passed;
}

float LightPaths::transmittance(const PathStart& place, const LightMedium::Direction& towards) {
  // A surface that faces away from the light is not lit anyway.
  if (place.facing.trust >= 1 && place.facing.normal.dot(towards.world) <= 0) return 0;
  const float passed = surface_transmittance(place.surface_start, towards.world);
  if (passed == 0) return 0;
  const IndexRay ray{place.volume_start, towards.index};
  const Interval span = clip_to_box(ray, m_context.box_lo, m_context.box_hi, {0, kEndless});
  const double step = m_medium.voxel_mm;
  float depth = 0;
  PathSamples stretch;
  for (double t = span.begin + 0.5 * step; t <= span.end;) {
    for (stretch.count = 0; stretch.count < PathSamples::kMost && t <= span.end;) {
      const double end = end_of_emptiness(ray, t);
      if (end > t) {
        t += step * std::max(1.0, std::ceil((end - t) / step));
        continue;
      }
      stretch.t[stretch.count++] = t;
      t += step;
    }
    find_extinctions(ray, stretch);
    for (int n = 0; n < stretch.count; ++n) depth += stretch.extinction[n] * float(step);
    if (depth > kDark) return 0;
  }
  return passed * std::exp(-depth);
}

float LightPaths::openness(const PathStart& place) {
  const float trust = place.facing.trust;
  float sum = 0, weights = 0;
  for (const LightMedium::Direction& direction : m_medium.around) {
    const float cosine = std::max(place.facing.normal.dot(direction.world), 0.0f);
    const float weight = 0.5f * (1 - trust) + trust * cosine;
    if (weight <= 0) continue;
    sum += weight * ambient_along(place, direction);
    weights += weight;
  }
  return sum / weights;
}

/// Share of the light emitted along a path as long as the radius that arrives at its start.
float LightPaths::ambient_along(const PathStart& place, const LightMedium::Direction& direction) {
  const double radius = m_context.settings.lighting.occlusion_radius_mm;
  find_crossings(place.surface_start, direction.world, radius);
  auto crossing = m_crossings.begin();
  const IndexRay ray{place.volume_start, direction.index};
  float left = 1;
  double arrived = 0;
  PathSamples stretch;
  std::array<double, PathSamples::kMost> steps;
  for (double t = 0; t < radius && left > kSpent;) {
    for (stretch.count = 0; stretch.count < PathSamples::kMost && t < radius; ++stretch.count) {
      const double step = std::min(std::max(m_medium.voxel_mm, kWidening * t), radius - t);
      steps[stretch.count] = step;
      stretch.t[stretch.count] = t + 0.5 * step;
      t += step;
    }
    find_extinctions(ray, stretch);
    for (int n = 0; n < stretch.count; ++n) {
      for (; crossing != m_crossings.end() && crossing->t < stretch.t[n]; ++crossing) {
        left *= 1 - m_context.surfaces->opacity(*crossing);
      }
      const float extinction = stretch.extinction[n];
      const float half = extinction > 0 ? std::exp(-0.5f * extinction * float(steps[n])) : 1;
      arrived += steps[n] * double(left * half);
      left *= half * half;
    }
  }
  return float(arrived / radius);
}

double LightPaths::end_of_emptiness(const IndexRay& ray, double t) {
  const Vec3i voxel = floor_voxel(ray.at(t));
  const std::int32_t out = m_context.output.find(voxel);
  return out < 0 || !m_context.output_visible[out] ? end_of_brick(ray, voxel) : t;
}

/// Finds the extinctions of the deformed volume as the marcher samples it.
void LightPaths::find_extinctions(const IndexRay& ray, PathSamples& stretch) {
  if (stretch.count == 0) return;
  m_places.base = floor_voxel(ray.at(stretch.t[0]));
  for (int n = 0; n < stretch.count; ++n) {
    const Vec3f place(ray.at(stretch.t[n]) - Vec3d(m_places.base));
    m_places.x[n] = place.x, m_places.y[n] = place.y, m_places.z[n] = place.z;
  }
  sample_places(m_context.tables, m_places, stretch.count, m_batch);
  if (m_context.classifier.has_gradient_opacity()) {
    sample_gradients(m_context.tables, m_batch, m_batch.visible);
  }
  for (int n = 0; n < stretch.count; ++n) {
    const bool is_visible = (m_batch.visible >> n & 1) &&
                            is_kept(m_context.deformed_clips, ray.at(stretch.t[n])) &&
                            is_kept(m_context.source_clips, read_at(n));
    stretch.extinction[n] = is_visible ? extinction_of(n, ray.at(stretch.t[n])) : 0;
  }
}

/// The place at which a lane of the batch read the source, index space.
Vec3d LightPaths::read_at(int lane) const {
  return Vec3d(m_places.base) + Vec3d(m_batch.px[lane], m_batch.py[lane], m_batch.pz[lane]);
}

float LightPaths::extinction_of(int lane, const Vec3d& seen_at) const {
  const float extinction = m_medium.extinction(m_batch.encoded[lane]);
  if (!m_context.classifier.has_gradient_opacity()) return extinction;
  const Vec3f gradient(m_batch.gx[lane], m_batch.gy[lane], m_batch.gz[lane]);
  const Vec3f pulled = m_context.pull_back(m_batch, lane, seen_at, read_at(lane), gradient);
  return m_medium.with_gradient(extinction, m_context.to_world(pulled).length());
}

}  // namespace supple

#include "raycast/march/light_volume.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace supple {

namespace {

// A node that lets nothing through counts as little as this beside one in the open.
constexpr float kBuried = 1e-3f;

/// Real spherical harmonics of a direction, times sqrt(4 pi): the first is 1.
std::array<float, LightVolume::kHarmonics> harmonics(const Vec3f& d) {
  constexpr float kFirst = 1.7320508f, kSecond = 3.8729833f;  // sqrt(3), sqrt(15)
  constexpr float kZonal = 1.1180340f;                        // sqrt(5) / 2
  return {1,
          kFirst * d.y,
          kFirst * d.z,
          kFirst * d.x,
          kSecond * d.x * d.y,
          kSecond * d.y * d.z,
          kZonal * (3 * d.z * d.z - 1),
          kSecond * d.x * d.z,
          kSecond / 2 * (d.x * d.x - d.y * d.y)};
}

}  // namespace

void LightVolume::Light::add_around(const Vec3f& from, float light, float part) {
  const std::array<float, kHarmonics> basis = harmonics(from);
  for (std::size_t n = 0; n < around.size(); ++n) around[n] += part * light * basis[n];
}

/// A cosine lobe multiplies the harmonics of the orders 0, 1 and 2 by 1, 2/3 and 1/4. The shares of
/// both means are those that paths around have: over half of the directions the cosine is 1/2.
float LightVolume::Light::openness(const Facing& facing) const {
  const std::array<float, kHarmonics> basis = harmonics(facing.normal);
  float faced = around[0];
  for (std::size_t n = 1; n < 4; ++n) faced += around[n] * basis[n] * (2.0f / 3);
  for (std::size_t n = 4; n < around.size(); ++n) faced += around[n] * basis[n] * 0.25f;
  const float of_all = 2 * (1 - facing.trust);
  const float light = (of_all * around[0] + facing.trust * faced) / (of_all + facing.trust);
  return std::clamp(light, 0.0f, 1.0f);
}

LightVolume::LightVolume(const Geometry& geometry, const Vec3d& lo, const Vec3d& hi,
                         double spacing_mm, int lights)
    : m_spacing_mm(spacing_mm), m_low(lo), m_lights(lights), m_values(1 + lights + kHarmonics) {
  for (int a = 0; a < 3; ++a) {
    m_step[a] = std::max(spacing_mm / geometry.spacing_mm()[a], 1.0);
    m_counts[a] = int(std::ceil((hi[a] - lo[a]) / m_step[a])) + 1;
    m_counts[a] = std::max(m_counts[a], 2);
  }
  const std::size_t count = number_of(m_counts - Vec3i(1)) + 1;
  m_nodes.reset(new float[count * std::size_t(m_values)]);
  m_states = std::make_unique<std::atomic<std::uint8_t>[]>(count);
}

/// A place in steps of nodes, held within their cells.
Vec3d LightVolume::in_nodes(const Vec3d& place) const {
  Vec3d at;
  for (int a = 0; a < 3; ++a) {
    const double last = m_counts[a] - 1;
    at[a] = std::clamp((place[a] - m_low[a]) / m_step[a], 0.0, last - 1e-6);
  }
  return at;
}

/// Claims an empty node for the caller to fill; false where the node is filled by now.
bool LightVolume::begins_to_fill(std::size_t node) const {
  std::atomic<std::uint8_t>& state = m_states[node];
  if (state.load(std::memory_order_acquire) == kFilled) return false;
  std::uint8_t empty = kEmpty;
  if (state.compare_exchange_strong(empty, kFilling)) return true;
  while (state.load(std::memory_order_acquire) != kFilled) std::this_thread::yield();
  return false;
}

void LightVolume::store(std::size_t node, const Light& light) const {
  float* to = &m_nodes[node * std::size_t(m_values)];
  *to++ = light.clear;
  to = std::copy_n(light.lights.begin(), m_lights, to);
  std::copy(light.around.begin(), light.around.end(), to);
  m_states[node].store(kFilled, std::memory_order_release);
}

void LightVolume::add(std::size_t node, float weight, Light& sum) const {
  const float* from = &m_nodes[node * std::size_t(m_values)];
  weight *= std::max(*from, kBuried);
  sum.clear += weight;
  ++from;
  for (int n = 0; n < m_lights; ++n) sum.lights[std::size_t(n)] += weight * *from++;
  for (float& harmonic : sum.around) harmonic += weight * *from++;
}

std::size_t LightVolume::bytes() const {
  const std::size_t count = number_of(m_counts - Vec3i(1)) + 1;
  return count * (std::size_t(m_values) * sizeof(float) + 1);
}

}  // namespace supple

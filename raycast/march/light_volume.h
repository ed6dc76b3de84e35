// Light on a lattice: what reaches its nodes from each light and from all around, interpolated for
// the samples between, which would otherwise each send out paths of their own (light_paths.h).
//
// The light from all around is kept as spherical harmonics up to the second order, which hold the
// light on a surface of any orientation to about 1 % (R. Ramamoorthi, P. Hanrahan, An efficient
// representation for irradiance environment maps, SIGGRAPH 2001). Nodes inside opaque tissue, which
// no light reaches, hardly count between those before it.
//
// For translucent tissue, through which rays go far: there it changes slowly, and many samples
// share a node. Light is blurred over the spacing. Cost: a node is filled when a sample first asks
// for it, for one path to each light and 32 around, about 10 µs; then 0.1 µs per sample. Memory: 4
// bytes per value of every node, of which there are 1 + lights + 9.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include "raycast/march/shading.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/cell.h"

namespace supple {

class LightVolume {
 public:
  static constexpr int kHarmonics = 9;
  /// Light at a node, or interpolated between nodes.
  struct Light {
    float clear = 1;  // share of the light that passes the node's own tissue
    std::array<float, Lighting::kMaxLights> lights{};
    std::array<float, kHarmonics> around{};  // mean of the light times each harmonic
    /// Adds the light from a direction (unit, LPS); `part` of all that come.
    void add_around(const Vec3f& from, float light, float part);
    /// Mean of light, cosine-weighted over the normal's side by trust, over all sides for the rest.
    float openness(const Facing& facing) const;
  };

  /// Covers a box of the index space for `lights` lights; nodes lie about `spacing_mm` apart, but
  /// not nearer than voxels.
  LightVolume(const Geometry& geometry, const Vec3d& lo, const Vec3d& hi, double spacing_mm,
              int lights);

  /// Light at a place of the index space, held within the box. Calls fill(place of the node) ->
  /// Light for nodes that are missing, once each, from any thread.
  template <class Fill>
  Light at(const Vec3d& place, Fill&& fill) const;

  double spacing_mm() const { return m_spacing_mm; }
  std::size_t bytes() const;

 private:
  enum State : std::uint8_t { kEmpty, kFilling, kFilled };

  std::size_t number_of(const Vec3i& node) const {
    return (std::size_t(node.x) * std::size_t(m_counts.y) + std::size_t(node.y)) *
               std::size_t(m_counts.z) +
           std::size_t(node.z);
  }
  Vec3d place_of(const Vec3i& node) const { return m_low + Vec3d(node) * m_step; }
  bool begins_to_fill(std::size_t node) const;
  void store(std::size_t node, const Light& light) const;
  void add(std::size_t node, float weight, Light& sum) const;
  Vec3d in_nodes(const Vec3d& place) const;

  double m_spacing_mm;
  Vec3d m_low, m_step;  // index space
  Vec3i m_counts;
  int m_lights, m_values;
  std::unique_ptr<float[]> m_nodes;  // memory is taken where they are written
  std::unique_ptr<std::atomic<std::uint8_t>[]> m_states;
};

template <class Fill>
LightVolume::Light LightVolume::at(const Vec3d& place, Fill&& fill) const {
  const Vec3d at = in_nodes(place);
  const Vec3i low(at);
  const Vec3d part = at - Vec3d(low);
  Light sum;
  sum.clear = 0;
  for (int n = 0; n < 8; ++n) {
    const Vec3i corner = cell_corner(n), node = low + corner;
    double weight = 1;
    for (int a = 0; a < 3; ++a) weight *= corner[a] ? part[a] : 1 - part[a];
    if (weight == 0) continue;
    const std::size_t number = number_of(node);
    if (begins_to_fill(number)) store(number, fill(place_of(node)));
    add(number, float(weight), sum);
  }
  for (float& light : sum.lights) light /= sum.clear;
  for (float& harmonic : sum.around) harmonic /= sum.clear;
  return sum;
}

}  // namespace supple

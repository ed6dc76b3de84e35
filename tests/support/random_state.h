// Random but valid states: sparse bodies with holes, sheared and left-handed geometries, offsets up
// to the limit, coordinates that never moved.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "lib/state/state.h"
#include "volumes/grid/labels.h"

namespace supple::test {

inline Geometry random_geometry(std::mt19937& random, const Vec3i& dims) {
  std::uniform_real_distribution<double> value(-1, 1);
  const auto vector = [&] { return Vec3d(value(random), value(random), value(random)); };
  const Vec3d origin = vector() * 300.0;
  for (;;) {
    const std::array<Vec3d, 3> axes = {vector(), vector(), vector()};
    const double volume =
        axes[0].normalized().dot(axes[1].normalized().cross(axes[2].normalized()));
    if (std::abs(volume) > 0.1) return {dims, origin, axes};
  }
}

/// The voxels of a box for which `keep` says so.
template <class Keep>
BrickTopology bricks_where(const Vec3i& dims, Keep&& keep) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (int x = 0; x < dims.x; x += kBrickDim) {
    for (int y = 0; y < dims.y; y += kBrickDim) {
      for (int z = 0; z < dims.z; z += kBrickDim) {
        BrickMask mask{};
        for (int offset = 0; offset < kBrickVoxels; ++offset) {
          const Vec3i voxel = Vec3i(x, y, z) + brick_local(offset);
          const bool inside = voxel.x < dims.x && voxel.y < dims.y && voxel.z < dims.z;
          if (inside && keep(voxel)) mask_set(mask, offset);
        }
        origins.push_back({x, y, z});
        masks.push_back(mask);
      }
    }
  }
  return {std::move(origins), std::move(masks)};
}

inline std::int32_t random_offset(std::mt19937& random) {
  switch (random() % 5) {
    case 0:
      return 0;
    case 1:
      return random() % 2 == 0 ? kMaxOffset : -kMaxOffset;
    case 2:
      return std::int32_t(random() % 7) - 3;
    default:
      return std::int32_t(random() % (2u * kMaxOffset + 1)) - kMaxOffset;
  }
}

/// Every link is cut with a probability that is drawn first.
inline LinkCuts random_cuts(std::mt19937& random, const BrickTopology& elements) {
  LinkCuts cuts;
  const auto cut_part = random() % 2 == 0 ? 0 : random() % 101;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      for (int axis = 0; axis < 3; ++axis) {
        Vec3i next = elements.origin(b) + brick_local(offset);
        ++next[axis];
        if (elements.is_active(next) && random() % 100 < cut_part) cuts.cut(b, offset, axis);
      }
    });
  }
  return cuts;
}

/// A label at some of the elements, drawn apart from the rest of the state.
inline BrickValues random_labels(unsigned seed, const BrickTopology& elements) {
  std::mt19937 random(seed);
  BrickValues labels;
  if (random() % 3 == 0) return labels;
  labels.resize(elements.brick_count());
  const auto part = random() % 101;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    for_each_active(elements.mask(b), [&](int offset) {
      if (random() % 100 >= part) return;
      labels.touch(b)[offset] = random() % 2 == 0 ? std::int32_t(random() % 4) : kMaxLabel;
    });
  }
  return labels;
}

/// Rest stretches of some axes and velocities along some coordinates, of some elements.
inline void add_motion(std::mt19937& random, State& state) {
  std::normal_distribution<double> speed(0, 100);
  const auto fill = [&](auto& values, auto&& value) {
    if (random() % 3 == 0) return;
    values.resize(state.elements.brick_count());
    for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
      if (random() % 2 == 0) continue;
      for_each_active(state.elements.mask(b), [&](int offset) {
        if (random() % 2 == 0) values.touch(b)[offset] = value();
      });
    }
  };
  for (auto& axis : state.rest) {
    for (auto& rest : axis) fill(rest, [&] { return random_offset(random); });
  }
  for (auto& velocity : state.velocity_mm_s) fill(velocity, [&] { return speed(random); });
}

inline State random_state(unsigned seed, int max_dim = 28) {
  std::mt19937 random(seed);
  const auto dim = [&] { return 1 + int(random() % unsigned(max_dim)); };
  const Vec3i dims(dim(), dim(), dim());
  State state;
  state.geometry = random_geometry(random, dims);

  // Densities on a random part of the box, elements on a part of those.
  const auto density_part = random() % 101, element_part = random() % 101;
  const BrickTopology bricks =
      bricks_where(dims, [&](const Vec3i&) { return random() % 100 < density_part; });
  std::uniform_real_distribution<float> value(-2000, 4000);
  std::vector<float> densities(bricks.brick_count() * kBrickVoxels, -1024);
  for (float& density : densities) density = value(random);
  state.density = make_density_grid(bricks, densities, -1024);
  state.elements = bricks_where(dims, [&](const Vec3i& voxel) {
    return bricks.is_active(voxel) && random() % 100 < element_part;
  });

  for (auto& q : state.q) {
    if (random() % 3 == 0) continue;
    q.resize(state.elements.brick_count());
    for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
      for_each_active(state.elements.mask(b),
                      [&](int offset) { q.touch(b)[offset] = random_offset(random); });
    }
  }
  for (unsigned n = random() % 4; n > 0; --n) {
    const Vec3i lo(dim(), -dim(), dim());
    state.anchors.push_back({lo, lo + Vec3i(dim(), dim(), dim())});
  }
  state.material_toml = "domain = [0, 255]\n# \xC3\xA4 \"quoted\"\n";
  state.configuration = std::string("{\"binary\": \"\0\xFF\"}", 17);
  state.source_name = "head " + std::to_string(seed) + ".nhdr";
  state.source_type = "int16";
  state.cuts = random_cuts(random, state.elements);
  state.labels = random_labels(seed + 1, state.elements);
  for (const auto& [label, count] : label_counts(state.labels)) {
    if (count % 2 == 0) state.anchor_labels.push_back(label);
  }
  if (seed % 2 == 0)
    state.anchor_selections = {Value{{"grab_density", {300, 3100}}}, Value{{"radius", 2.5}}};
  add_motion(random, state);
  return state;
}

inline bool same_densities(const DensityGrid& a, const DensityGrid& b) {
  if (!(a.bricks() == b.bricks()) || a.background() != b.background()) return false;
  for (std::size_t n = 0; n < a.bricks().brick_count(); ++n) {
    if (!std::equal(a.values(n), a.values(n) + kBrickVoxels, b.values(n))) return false;
  }
  return true;
}

/// True if the states are equal bit for bit.
inline bool same_state(const State& a, const State& b) {
  return a.geometry == b.geometry && same_densities(a.density, b.density) &&
         a.elements == b.elements && a.q == b.q && a.rest == b.rest &&
         a.velocity_mm_s == b.velocity_mm_s && a.cuts == b.cuts && a.anchors == b.anchors &&
         a.labels == b.labels && a.anchor_labels == b.anchor_labels &&
         a.anchor_selections == b.anchor_selections && a.material_toml == b.material_toml &&
         a.configuration == b.configuration && a.source_name == b.source_name &&
         a.source_type == b.source_type;
}

}  // namespace supple::test

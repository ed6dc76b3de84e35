#include "lib/body/body.h"

#include <algorithm>
#include <cstdlib>

#include "lib/body/slot_set.h"

namespace supple {

std::int32_t Body::offset(const Vec3i& voxel, int c) const {
  Slot slot;
  return slot_of(elements, voxel, slot) ? q[c].at(slot) : 0;
}

std::size_t Body::bytes() const {
  std::size_t total = elements.bytes() + classes.capacity() + slacks.bytes() + cuts.bytes();
  for (std::size_t c = 0; c < 3; ++c) {
    total += q[c].bytes() + fraction[c].bytes() + velocity_mm_s[c].bytes();
  }
  if (beyond) {
    for (const BrickValues& coordinate : *beyond) total += coordinate.bytes();
  }
  for (const auto& axis : rest) {
    for (const BrickValues& coordinate : axis) total += coordinate.bytes();
  }
  return total;
}

void Body::drop_fractions(int c, std::size_t brick, const std::int32_t* before) {
  if (fraction[std::size_t(c)].brick(brick) == nullptr) return;
  std::int16_t* fractions = fraction[std::size_t(c)].touch(brick);
  const std::int32_t* now = q[std::size_t(c)].brick_or_zero(brick);
  for (int n = 0; n < kBrickVoxels; ++n) {
    if (now[n] != before[n]) fractions[n] = 0;
  }
}

Body make_body(const Geometry& geometry, const DensityGrid& density, const BrickTopology& elements,
               const MaterialTable& material, const BrickValues& labels) {
  Body body;
  body.geometry = geometry;
  body.elements = elements;
  body.material = material;
  body.slacks = SlackTable(material, geometry.spacing_mm());
  body.links_known_valid = true;
  body.classes.assign(slot_count(elements), 0);
  const MaterialClasses classes(material);
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    const std::int32_t source = density.bricks().find(elements.origin(b));
    const std::int32_t* brick_labels = labels.brick_or_zero(b);
    for_each_active(elements.mask(b), [&](int offset) {
      const float value = source < 0 ? density.background() : density.values(source)[offset];
      body.classes[b * kBrickVoxels + offset] =
          classes.class_of(double(value), brick_labels[offset]);
    });
  }
  return body;
}

Body make_body(const State& state, const MaterialTable& material) {
  Body body = make_body(state.geometry, state.density, state.elements, material, state.labels);
  body.q = state.q;
  body.cuts = state.cuts;
  body.rest = state.rest;
  body.velocity_mm_s = state.velocity_mm_s;
  body.beyond = state.beyond;
  for (const BrickValues& coordinate : body.q) body.links_known_valid &= coordinate.empty();
  return body;
}

bool nearest_element(const Body& body, const Vec3i& voxel, Vec3i& nearest) {
  const BrickTopology& elements = body.elements;
  const auto square = [](const Vec3i& d) {
    return std::int64_t(d.x) * d.x + std::int64_t(d.y) * d.y + std::int64_t(d.z) * d.z;
  };
  std::int64_t best = INT64_MAX;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    // A brick whose box is no nearer than the best voxel so far cannot win.
    Vec3i to_box(0);
    for (int a = 0; a < 3; ++a) {
      const int lo = elements.origin(b)[a], hi = lo + kBrickDim - 1;
      to_box[a] = std::clamp(voxel[a], lo, hi) - voxel[a];
    }
    if (square(to_box) >= best) continue;
    for_each_active(elements.mask(b), [&](int offset) {
      const Vec3i candidate = elements.origin(b) + brick_local(offset);
      const std::int64_t distance = square(candidate - voxel);
      if (distance >= best) return;
      best = distance;
      nearest = candidate;
    });
  }
  return best != INT64_MAX;
}

}  // namespace supple

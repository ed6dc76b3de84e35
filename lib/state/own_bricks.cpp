#include "lib/state/own_bricks.h"

#include <algorithm>

namespace supple {

namespace {

template <class T>
bool has_values(const BrickArray<T>& values, std::size_t b) {
  return values.brick(b) != nullptr && !are_zeros(values.brick(b));
}

template <class T>
bool has_values(const std::array<BrickArray<T>, 3>& values, std::size_t b) {
  return std::any_of(values.begin(), values.end(),
                     [&](const BrickArray<T>& of_axis) { return has_values(of_axis, b); });
}

/// True if a brick of elements stores offsets, rest stretches, velocities or cut links.
bool is_changed(const State& state, std::size_t b) {
  return has_values(state.q, b) || (state.beyond && has_values(*state.beyond, b)) ||
         std::any_of(state.rest.begin(), state.rest.end(),
                     [&](const auto& axis) { return has_values(axis, b); }) ||
         has_values(state.velocity_mm_s, b) || state.cuts.brick(b) != nullptr;
}

/// The mask of the brick with this origin; empty where there is none.
BrickMask mask_at(const BrickTopology& bricks, const Vec3i& origin) {
  const std::int32_t b = bricks.find(origin);
  return b < 0 ? BrickMask{} : bricks.mask(std::size_t(b));
}

bool have_same_brick(const DensityGrid& a, const DensityGrid& b, const Vec3i& origin) {
  const std::int32_t in_a = a.bricks().find(origin), in_b = b.bricks().find(origin);
  if (in_a < 0 || in_b < 0) return in_a == in_b;
  const float *const of_a = a.values(std::size_t(in_a)), *const of_b = b.values(std::size_t(in_b));
  if (of_a == of_b) return true;
  return a.bricks().mask(std::size_t(in_a)) == b.bricks().mask(std::size_t(in_b)) &&
         std::equal(of_a, of_a + kBrickVoxels, of_b);
}

void add_all(BrickIndex& own, const VectorBricks& field) {
  for (std::size_t b = 0; b < field.topology.brick_count(); ++b) {
    if (has_values(field.vectors, b)) own.add(field.topology.origin(b));
  }
}

/// Adds the bricks that the source gives otherwise than they are.
void add_differing(BrickIndex& own, const State& state, const StateSource& source) {
  const auto differs = [&](const Vec3i& origin) {
    return !have_same_brick(state.density, source.density, origin) ||
           mask_at(state.elements, origin) != mask_at(source.elements, origin);
  };
  for (const BrickTopology* bricks : {&state.density.bricks(), &source.density.bricks()}) {
    for (std::size_t b = 0; b < bricks->brick_count(); ++b) {
      if (differs(bricks->origin(b))) own.add(bricks->origin(b));
    }
  }
}

/// The bricks of the source that are not the state's own, and all of the state.
BrickTopology joined(const BrickTopology& source, const BrickTopology& state,
                     const BrickIndex& own) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  const auto add = [&](const BrickTopology& bricks, bool are_own) {
    for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
      if ((own.find(bricks.origin(b)) >= 0) != are_own) continue;
      origins.push_back(bricks.origin(b));
      masks.push_back(bricks.mask(b));
    }
  };
  add(source, false);
  add(state, true);
  return {std::move(origins), std::move(masks)};
}

/// The bricks of `bricks` for which `is_kept` says so.
template <class Keep>
BrickTopology bricks_that(const BrickTopology& bricks, const Keep& is_kept) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    if (!is_kept(b)) continue;
    origins.push_back(bricks.origin(b));
    masks.push_back(bricks.mask(b));
  }
  return {std::move(origins), std::move(masks)};
}

}  // namespace

BrickIndex own_bricks(const State& state, const VectorBricks& displacement,
                      const VectorBricks* offsets) {
  BrickIndex changed;
  for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
    if (is_changed(state, b)) changed.add(state.elements.origin(b));
  }
  add_all(changed, displacement);
  if (offsets != nullptr) add_all(changed, *offsets);
  add_differing(changed, state, *state.source);

  BrickIndex own;
  for (const Vec3i& origin : changed.origins()) {
    for (int n = 0; n < 27; ++n) {
      const Vec3i near = origin + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1) * kBrickDim;
      const bool is_there =
          state.density.bricks().find(near) >= 0 || state.source->density.bricks().find(near) >= 0;
      if (is_there) own.add(near);
    }
  }
  return own;
}

BrickTopology part_of(const BrickTopology& bricks, const BrickIndex& own) {
  return bricks_that(bricks, [&](std::size_t b) { return own.find(bricks.origin(b)) >= 0; });
}

DensityGrid part_of(const DensityGrid& density, const BrickIndex& own) {
  return restrict_to(density, part_of(density.bricks(), own));
}

VectorBricks part_of(const VectorBricks& field, const BrickIndex& own) {
  VectorBricks part;
  part.topology = bricks_that(field.topology, [&](std::size_t b) {
    return own.find(field.topology.origin(b)) >= 0 || has_values(field.vectors, b);
  });
  part.vectors.resize(part.topology.brick_count());
  for (std::size_t b = 0; b < part.topology.brick_count(); ++b) {
    const Vec3f* const vectors =
        field.vectors.brick(std::size_t(field.topology.find(part.topology.origin(b))));
    if (vectors != nullptr) std::copy_n(vectors, kBrickVoxels, part.vectors.touch(b));
  }
  return part;
}

void complete(State& state, const StateSource& source, const BrickIndex& own) {
  const auto is_as_given = [&](const Vec3i& origin) {
    return have_same_brick(state.density, source.density, origin) &&
           mask_at(state.elements, origin) == mask_at(source.elements, origin);
  };
  if (std::all_of(own.origins().begin(), own.origins().end(), is_as_given)) {
    state.density = source.density;
    state.elements = source.elements;
    return;
  }
  state.elements = joined(source.elements, state.elements, own);
  const DensityGrid part = state.density;
  const BrickTopology bricks = joined(source.density.bricks(), part.bricks(), own);
  state.density = fill_density_grid(
      bricks,
      [&](std::size_t b, float* out) {
        const Vec3i& origin = bricks.origin(b);
        const DensityGrid& from = own.find(origin) >= 0 ? part : source.density;
        std::copy_n(from.values(std::size_t(from.bricks().find(origin))), kBrickVoxels, out);
      },
      source.density.background());
}

}  // namespace supple

#include "lib/state/state.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/base/text.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/grid/labels.h"

namespace supple {

namespace {

void check_densities(const State& state, const std::string& file) {
  const BrickTopology& bricks = state.density.bricks();
  const IndexBox box{{0, 0, 0}, state.geometry.dims() - Vec3i(1)};
  const IndexBox& bounds = bricks.active_bounds();
  if (!bounds.empty() && !(box.contains(bounds.lo) && box.contains(bounds.hi))) {
    throw InputError({file, "density", "voxels " + to_text(bounds.lo) + " to " + to_text(bounds.hi),
                      "voxels inside 0,0,0 to " + to_text(box.hi)});
  }
  if (!std::isfinite(state.density.background())) {
    throw InputError({file, "density", "a background that is not finite", "a finite density"});
  }
  for (std::size_t b = 0; b < bricks.brick_count(); ++b) {
    const float* values = state.density.values(b);
    for_each_active(bricks.mask(b), [&](int offset) {
      if (std::isfinite(values[offset])) return;
      throw InputError({file, "density at " + to_text(bricks.origin(b) + brick_local(offset)),
                        "a value that is not finite", "a finite density"});
    });
  }
}

void check_elements(const State& state, const std::string& file) {
  const BrickTopology& bricks = state.density.bricks();
  for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
    const std::int32_t other = bricks.find(state.elements.origin(b));
    for_each_active(state.elements.mask(b), [&](int offset) {
      if (other >= 0 && mask_test(bricks.mask(other), offset)) return;
      throw InputError({file,
                        "element at " + to_text(state.elements.origin(b) + brick_local(offset)),
                        "no density", "a density for every element"});
    });
  }
}

void check_fixed_of_brick(const State& state, std::size_t b, const std::int32_t* values,
                          std::int32_t largest, const std::string& field, const std::string& file) {
  for (int offset = 0; offset < kBrickVoxels; ++offset) {
    const std::int32_t value = values[offset];
    if (value == 0) continue;
    const bool active = mask_test(state.elements.mask(b), offset);
    if (active && value >= -largest && value <= largest) continue;
    const Vec3i voxel = state.elements.origin(b) + brick_local(offset);
    throw InputError(
        {file, field + " at " + to_text(voxel), std::to_string(value),
         active ? "within +-" + std::to_string(largest) : "0 where there is no element"});
  }
}

/// Checks the three coordinates of q, of what is beyond limits, or of rest stretches.
void check_fixed(const State& state, const std::array<BrickValues, 3>& values, std::int32_t largest,
                 const std::string& name, const std::string& file) {
  const std::size_t bricks = state.elements.brick_count();
  for (std::size_t c = 0; c < 3; ++c) {
    const BrickValues& q = values[c];
    const std::string field = name + "." + "xyz"[c];
    if (q.brick_count() != 0 && q.brick_count() != bricks) {
      throw InputError({file, field, std::to_string(q.brick_count()) + " bricks",
                        "0 or " + std::to_string(bricks)});
    }
    for (std::size_t b = 0; b < q.brick_count(); ++b) {
      if (q.brick(b) != nullptr) check_fixed_of_brick(state, b, q.brick(b), largest, field, file);
    }
  }
}

void check_velocities(const State& state, const std::string& file) {
  const std::size_t bricks = state.elements.brick_count();
  for (std::size_t c = 0; c < 3; ++c) {
    const BrickArray<double>& velocity = state.velocity_mm_s[c];
    const std::string field = std::string("velocity.") + "xyz"[c];
    if (velocity.brick_count() != 0 && velocity.brick_count() != bricks) {
      throw InputError({file, field, std::to_string(velocity.brick_count()) + " bricks",
                        "0 or " + std::to_string(bricks)});
    }
    for (std::size_t b = 0; b < velocity.brick_count(); ++b) {
      const double* values = velocity.brick_or_zero(b);
      for (int offset = 0; offset < kBrickVoxels; ++offset) {
        const bool active = mask_test(state.elements.mask(b), offset);
        if (active ? std::isfinite(values[offset]) : values[offset] == 0) continue;
        throw InputError({file,
                          field + " at " + to_text(state.elements.origin(b) + brick_local(offset)),
                          number_text(values[offset]) + " mm/s",
                          active ? "a finite velocity" : "0 where there is no element"});
      }
    }
  }
}

void check_cuts(const State& state, const std::string& file) {
  if (state.cuts.brick_end() > state.elements.brick_count()) {
    throw InputError(
        {file, "cut_links", "more bricks than the elements have", "links of elements"});
  }
  for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
    const LinkCuts::BrickCuts* cuts = state.cuts.brick(b);
    for (int axis = 0; cuts != nullptr && axis < 3; ++axis) {
      for_each_active((*cuts)[axis], [&](int offset) {
        const Vec3i voxel = state.elements.origin(b) + brick_local(offset);
        Vec3i next = voxel;
        ++next[axis];
        if (state.elements.is_active(voxel) && state.elements.is_active(next)) return;
        throw InputError({file, "cut_links at " + to_text(voxel),
                          std::string("a cut along ") + "ijk"[axis] + " where there is no link",
                          "cuts between two elements only"});
      });
    }
  }
}

void check_labels(const State& state, const std::string& file) {
  const std::size_t bricks = state.elements.brick_count();
  if (state.labels.brick_count() != 0 && state.labels.brick_count() != bricks) {
    throw InputError({file, "label", std::to_string(state.labels.brick_count()) + " bricks",
                      "0 or " + std::to_string(bricks)});
  }
  for (std::size_t b = 0; b < state.labels.brick_count(); ++b) {
    const std::int32_t* labels = state.labels.brick_or_zero(b);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      const bool is_element = mask_test(state.elements.mask(b), offset);
      if (labels[offset] >= 0 && labels[offset] <= (is_element ? kMaxLabel : 0)) continue;
      throw InputError(
          {file, "label at " + to_text(state.elements.origin(b) + brick_local(offset)),
           std::to_string(labels[offset]),
           is_element ? "0 to " + std::to_string(kMaxLabel) : "0 where there is no element"});
    }
  }
}

void check_pieces(const State& state, const std::string& file) {
  const auto count = std::int32_t(state.piece_records.size());
  const std::size_t bricks = state.elements.brick_count();
  if (state.pieces.brick_count() != 0 && state.pieces.brick_count() != bricks) {
    throw InputError({file, "piece", std::to_string(state.pieces.brick_count()) + " bricks",
                      "0 or " + std::to_string(bricks)});
  }
  for (std::size_t b = 0; b < state.pieces.brick_count(); ++b) {
    const std::int32_t* pieces = state.pieces.brick_or_zero(b);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      const bool is_element = mask_test(state.elements.mask(b), offset);
      if (pieces[offset] >= 0 && pieces[offset] <= (is_element ? count : 0)) continue;
      throw InputError(
          {file, "piece at " + to_text(state.elements.origin(b) + brick_local(offset)),
           std::to_string(pieces[offset]),
           is_element ? "0 to " + std::to_string(count) : "0 where there is no element"});
    }
  }
}

void check_anchors(const State& state, const std::string& file) {
  for (const IndexBox& box : state.anchors) {
    if (!box.empty()) continue;
    throw InputError({file, "anchors", "box " + to_text(box.lo) + " to " + to_text(box.hi),
                      "a box with at least one voxel"});
  }
  if (state.anchor_labels.empty()) return;
  const auto counts = label_counts(state.labels);
  for (const std::int32_t label : state.anchor_labels) {
    if (counts.count(label) != 0) continue;
    throw InputError({file, "anchors", "label " + std::to_string(label) + " without elements",
                      "a label of the state"});
  }
}

}  // namespace

void check_state(const State& state, const std::string& file) {
  check_densities(state, file);
  check_elements(state, file);
  check_fixed(state, state.q, kMaxOffset, "q", file);
  if (state.beyond) check_fixed(state, *state.beyond, kMaxOffset, "beyond_limits", file);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    check_fixed(state, state.rest[axis], 2 * kMaxOffset, rest_name(int(axis)), file);
  }
  check_velocities(state, file);
  check_cuts(state, file);
  check_labels(state, file);
  check_pieces(state, file);
  check_anchors(state, file);
}

std::string rest_name(int axis) {
  return std::string("rest_") + "ijk"[axis];
}

Displacement displacement_of(const State& state) {
  Displacement displacement{state.geometry, {state.elements, {}}};
  BrickVectors& vectors = displacement.u.vectors;
  vectors.resize(state.elements.brick_count());
  std::vector<std::size_t> moved;
  for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
    const auto is_stored = [&](const BrickValues& q) { return q.brick(b) != nullptr; };
    if (std::any_of(state.q.begin(), state.q.end(), is_stored)) moved.push_back(b);
  }
  vectors.reserve(moved.size());
  for (const std::size_t b : moved) vectors.touch(b);
  parallel_for(moved.size(), [&](std::size_t n) {
    Vec3f* const u = vectors.touch(moved[n]);
    for (int c = 0; c < 3; ++c) {
      const std::int32_t* const values = state.q[c].brick_or_zero(moved[n]);
      for (int offset = 0; offset < kBrickVoxels; ++offset) {
        u[offset][c] = float(values[offset] / kFixedOne);
      }
    }
  });
  return displacement;
}

Displacement extended_displacement_of(const State& state) {
  return extend_past_cuts(displacement_of(state), state.density.bricks(),
                          {state.elements, state.cuts});
}

}  // namespace supple

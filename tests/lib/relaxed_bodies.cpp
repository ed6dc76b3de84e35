#include "tests/lib/relaxed_bodies.h"

#include <cmath>

#include <gtest/gtest.h>

#include "lib/body/diagonals.h"
#include "lib/body/slot_set.h"
#include "lib/chainmail/ecm.h"
#include "volumes/base/parallel.h"

namespace supple::test {

namespace {

double energy_of_link(double stiffness, double stretch_mm, double yield_mm) {
  const double stretch = std::abs(stretch_mm);
  if (stretch <= yield_mm) return stiffness * stretch * stretch / 2;
  return stiffness * yield_mm * (stretch - yield_mm / 2);
}

/// Slots of the cell with that lowest corner; false where it is none.
bool corners_of(const Body& body, Slot low, std::array<Slot, 8>& slots) {
  for (std::size_t n = 0; n < 8; ++n) {
    const Vec3i step(int(n) >> 2, int(n) >> 1 & 1, int(n) & 1);
    if (!slot_of(body.elements, voxel_of(body.elements, low) + step, slots[n])) return false;
  }
  for (std::size_t n = 0; n < 8; ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      Slot next;
      if ((n >> (2 - axis) & 1) == 0 &&
          !neighbour_slot(body.elements, body.cuts, slots[n], axis, true, next)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

double spring_share(const Vec3d& h, int links, int direction) {
  const double volume = h.x * h.y * h.z;
  const auto diagonal = [&](const LinkStep& step) {
    double longest = 0;
    int axes = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (step[a] == 0) continue;
      ++axes;
      longest = std::max(longest, h[int(a)]);
    }
    const double weight = axes == 3 ? 1.0 / 36 : links == 18 ? 1.0 / 6 : 1.0 / 9;
    return weight * volume / (longest * longest);
  };
  const LinkStep step = step_of_direction(direction);
  if (is_diagonal(direction)) return diagonal(step);
  const std::size_t axis = std::size_t(axis_of_direction(direction));
  // The rest of E V / h^2 that the diagonals along the axis do not carry.
  double left = volume / (h[int(axis)] * h[int(axis)]);
  for (int other = 0; other < kDirections; ++other) {
    const LinkStep way = step_of_direction(other);
    if (is_diagonal(other) && has_direction(links, other) && way[axis] > 0) left -= diagonal(way);
  }
  return left;
}

Dragged dragged(std::mt19937& random, const Vec3i& max_dims, int links) {
  Block block = random_block(random, max_dims);
  block.table.links = links;
  if (random() % 3 == 0) cut_randomly(random, block);
  Dragged result{body_of(block), {}, {}};
  if (random() % 2 == 0) {
    result.anchors.push_back(Region(block.voxel(random_element(random, block))));
  }
  for (int n = 0; n < 2; ++n) {
    const Vec3i voxel = block.voxel(random_element(random, block));
    if (!result.anchors.empty() && *result.anchors[0].box() == IndexBox{voxel, voxel}) continue;
    std::array<std::int32_t, 3> by;
    for (auto& way : by) way = std::int32_t(random() % (12u * kVoxel)) - 6 * kVoxel;
    const HandleKind kind = random() % 4 == 0 ? HandleKind::push : HandleKind::two_sided;
    drag(result.body, {{voxel, by, kind}}, result.anchors, result.holds);
  }
  return result;
}

RelaxParams to_rest(double kpa) {
  RelaxParams params;
  params.passes = 20000;
  params.tolerance_voxels = 1e-9;
  params.bulk_modulus_kpa = kpa;
  return params;
}

Relaxation relaxation_of(Dragged& dragged, const RelaxParams& params) {
  return Relaxation(dragged.body, anchored_elements(dragged.body, dragged.anchors, dragged.holds),
                    dragged.holds, params);
}

int expect_held_through(Dragged dragged, const RelaxParams& params) {
  const Body before = dragged.body;
  const Body& after = dragged.body;
  relax(dragged.body, dragged.anchors, dragged.holds, params);
  const SlotSet anchored = anchored_elements(before, dragged.anchors, dragged.holds);
  int at_bound = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    anchored.for_each([&](Slot slot) { EXPECT_EQ(after.q[c].at(slot), before.q[c].at(slot)); });
    for (const Bound& bound : dragged.holds.at_least[c]) {
      EXPECT_GE(after.q[c].at(bound.slot), bound.value) << name_of(params.method);
      at_bound += after.q[c].at(bound.slot) == bound.value;
    }
    for (const Bound& bound : dragged.holds.at_most[c]) {
      EXPECT_LE(after.q[c].at(bound.slot), bound.value) << name_of(params.method);
    }
  }
  return at_bound;
}

void expect_same_on_any_threads(const Dragged& dragged, const RelaxParams& params) {
  Dragged one = dragged, many = dragged;
  const auto relax_on = [&](int threads, Dragged& copy) {
    return on_threads(threads, [&] { return relax(copy.body, copy.anchors, copy.holds, params); });
  };
  const RelaxReport first = relax_on(1, one), second = relax_on(4, many);
  EXPECT_EQ(one.body.q, many.body.q);
  EXPECT_EQ(first.energy_after, second.energy_after);
  ASSERT_EQ(first.volumes_after.has_value(), second.volumes_after.has_value());
  if (first.volumes_after) {
    EXPECT_EQ(first.volumes_after->total_mm3, second.volumes_after->total_mm3);
  }
}

double spring_energy(const Body& body) {
  const MaterialClasses classes(body.material);
  const Vec3d h = body.geometry.spacing_mm();
  double sum = 0;
  const int links = body.slacks.links();
  for_each_element(body.elements, [&](Slot low) {
    for_each_linked(body.elements, body.cuts, links, low, [&](int direction, Slot high) {
      if (direction < kNoStep) return;
      const LinkPhysics physics = classes.physics(body.classes[low], body.classes[high]);
      const double stiffness = physics.stiffness_kpa * spring_share(h, links, direction);
      const int axis = axis_of_direction(direction);
      for (std::size_t c = 0; c < 3; ++c) {
        double stretch = double(body.q[c].at(high)) - body.q[c].at(low);
        if (!is_diagonal(direction)) stretch -= body.rest[std::size_t(axis)][c].at(low);
        sum += energy_of_link(stiffness, stretch / kFixedOne * h[int(c)],
                              physics.yield_strain * h[axis]);
      }
    });
  });
  return sum;
}

double cell_energy(const Body& body, std::optional<double> kpa) {
  const MaterialClasses classes(body.material);
  const Vec3d h = body.geometry.spacing_mm();
  const double rest = h.x * h.y * h.z;
  double sum = 0;
  for_each_element(body.elements, [&](Slot low) {
    std::array<Slot, 8> slots;
    if (!corners_of(body, low, slots)) return;
    std::array<Vec3d, 8> corners;
    double compliance = 0;
    for (std::size_t n = 0; n < 8; ++n) {
      const int of = body.classes[slots[n]];
      compliance += (1 - 2 * classes.poisson_of_class(of)) / classes.physics(of, of).stiffness_kpa;
      for (int c = 0; c < 3; ++c) {
        const double voxels =
            (int(n) >> (2 - c) & 1) + body.q[std::size_t(c)].at(slots[n]) / kFixedOne;
        corners[n][c] = voxels * h[c];
      }
    }
    const double excess = integrated_volume(corners) - rest;
    sum += kpa.value_or(8 / compliance) / 2 * excess * excess / rest;
  });
  return sum;
}

double integrated_volume(const std::array<Vec3d, 8>& corners) {
  // Two Gauss points per axis are exact: the Jacobian is of degree 2 in each.
  double sum = 0;
  for (int point = 0; point < 8; ++point) {
    double at[3];
    for (int c = 0; c < 3; ++c) at[c] = 0.5 + ((point >> c & 1) - 0.5) / std::sqrt(3.0);
    Vec3d tangents[3] = {Vec3d(0), Vec3d(0), Vec3d(0)};
    for (int n = 0; n < 8; ++n) {
      for (int along = 0; along < 3; ++along) {
        double slope = 1;
        for (int c = 0; c < 3; ++c) {
          const bool is_high = (n >> (2 - c) & 1) != 0;
          slope *= c == along ? (is_high ? 1 : -1) : (is_high ? at[c] : 1 - at[c]);
        }
        tangents[along] += corners[std::size_t(n)] * slope;
      }
    }
    sum += tangents[0].dot(tangents[1].cross(tangents[2])) / 8;
  }
  return sum;
}

}  // namespace supple::test

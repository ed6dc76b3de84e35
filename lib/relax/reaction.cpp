#include "lib/relax/reaction.h"

#include <algorithm>

#include "lib/body/slot_set.h"
#include "lib/relax/brick_springs.h"
#include "lib/relax/cell_brick.h"
#include "lib/relax/cell_volume.h"
#include "lib/relax/link_table.h"
#include "lib/relax/movable.h"
#include "lib/relax/relaxation.h"
#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"

namespace supple {

namespace {

/// True where a link is at a limit: its ends can come no farther apart, or no nearer. A link
/// without slack is at both.
bool is_tight(const Body& body, int c, int kind, Slot low, Slot high) {
  const BrickValues& q = body.q[std::size_t(c)];
  const std::uint8_t a = body.classes[low], b = body.classes[high];
  const std::int64_t apart = std::int64_t(q.at(high)) - q.at(low);
  const int direction = kDirectionOfKind[std::size_t(kind)];
  const std::int64_t upper = body.slacks.fall(opposite_direction(direction), c, a, b);
  const std::int64_t lower = body.slacks.fall(direction, c, a, b);
  return (upper < kUnlimitedSlack && upper - apart <= kTightSlack) ||
         (lower < kUnlimitedSlack && lower + apart <= kTightSlack);
}

/// All elements that are held in coordinate c.
SlotSet held_in(const Body& body, int c, const SlotSet& fixed, const Holds& held) {
  const BrickValues& q = body.q[std::size_t(c)];
  std::vector<Slot> at_bound;
  for (const Bound& bound : held.at_least[std::size_t(c)]) {
    if (q.at(bound.slot) <= std::int64_t(bound.value) + kTightSlack) at_bound.push_back(bound.slot);
  }
  for (const Bound& bound : held.at_most[std::size_t(c)]) {
    if (q.at(bound.slot) >= std::int64_t(bound.value) - kTightSlack) at_bound.push_back(bound.slot);
  }
  SlotSet result(std::move(at_bound));
  result.add(fixed);
  result.add(held.anchored);
  return result;
}

/// Holders that bear the forces of elements in one coordinate, numbered as the handles; all other
/// held elements are the last holder.
struct Bearers {
  BrickValues holder;      // per element, one more than its number; 0: nobody
  std::vector<char> taut;  // per holder
};

/// Floods breadth first from all holders at once. A queue that starts in the order of the holders
/// stays so among elements equally far, so that the first of several gets an element.
Bearers find_bearers(const Body& body, int c, const std::vector<SlotSet>& handles,
                     const SlotSet& held, bool from_others) {
  const auto others = std::int32_t(handles.size() + 1);
  Bearers bearers{BrickValues(body.elements.brick_count()),
                  std::vector<char>(handles.size() + 1, 0)};
  std::vector<Slot> queue;
  const auto give = [&](Slot slot, std::int32_t holder) {
    bearers.holder.set(slot, holder);
    queue.push_back(slot);
  };
  for (std::size_t n = 0; n < handles.size(); ++n) {
    handles[n].for_each([&](Slot slot) {
      if (bearers.holder.at(slot) == 0 && held.contains(slot)) give(slot, std::int32_t(n + 1));
    });
  }
  if (from_others) {
    held.for_each([&](Slot slot) {
      if (bearers.holder.at(slot) == 0) give(slot, others);
    });
  }
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const Slot slot = queue[next];
    const std::int32_t holder = bearers.holder.at(slot);
    for_each_neighbour(body, body.slacks.links(), slot, [&](int kind, bool upwards, Slot other) {
      if (!is_tight(body, c, kind, upwards ? slot : other, upwards ? other : slot)) return;
      std::int32_t there = bearers.holder.at(other);
      if (there == 0 && held.contains(other)) there = others;
      if (there == 0) return give(other, holder);
      // This holder's turn comes with the link's other end.
      if (there != holder) bearers.taut[std::size_t(there - 1)] = 1;
    });
  }
  return bearers;
}

/// Floods from held elements of no handle, often most of the body, only where a handle meets them.
Bearers find_bearers(const Body& body, int c, const std::vector<SlotSet>& handles,
                     const SlotSet& held) {
  Bearers bearers = find_bearers(body, c, handles, held, false);
  return bearers.taut.back() ? find_bearers(body, c, handles, held, true) : bearers;
}

/// True where part of the brick moved in the coordinate, or a spring from there rests elsewhere.
bool has_strain(const Body& body, std::size_t c, std::size_t b) {
  return body.q[c].brick(b) != nullptr ||
         std::any_of(body.rest.begin(), body.rest.end(),
                     [&](const auto& axis) { return axis[c].brick(b) != nullptr; });
}

/// Forces on the elements of a brick, mN.
using BrickForces = std::array<double, kBrickVoxels>;

/// Adds the forces of springs on the elements that have a holder.
void add_springs(const Body& body, const LinkTable& table, std::size_t b,
                 const std::int32_t* holder, BrickForces& forces) {
  const auto c = std::size_t(table.coordinate());
  bool is_strained = has_strain(body, c, b);
  for (int face = 0; face < 6 && !is_strained; ++face) {
    const std::int32_t other = body.elements.neighbour(b, face);
    is_strained = other >= 0 && has_strain(body, c, std::size_t(other));
  }
  if (!is_strained && table.links() != 6) {
    for (const std::int32_t other : neighbours_of(body.elements, b)) {
      is_strained = is_strained || (other >= 0 && has_strain(body, c, std::size_t(other)));
    }
  }
  if (!is_strained) return;
  const double mm = body.geometry.spacing_mm()[int(c)] / (kFinePerUnit * kFixedOne);
  for_each_active(body.elements.mask(b), [&](int offset) {
    if (holder[offset] == 0) return;
    const Slot slot = Slot(b * kBrickVoxels) + Slot(offset);
    for_each_neighbour(body, table.links(), slot, [&](int kind, bool upwards, Slot other) {
      const LinkValues& link = table.values(kind, body.classes[slot], body.classes[other]);
      const std::int32_t rest = rest_of_link(body, kind, int(c), upwards ? slot : other);
      const double stretch =
          double(body.q[c].at(other)) - body.q[c].at(slot) - (upwards ? rest : -rest);
      forces[std::size_t(offset)] +=
          link.stiffness * pulled_stretch(link, stretch * kFinePerUnit) * mm;
    });
  });
}

/// Adds the forces of the cells around: -dE/dx with E = kpa (V - V0)^2 / (2 V0).
void add_cells(const Body& body, int c, const CellModuli& moduli, std::size_t b,
               BrickForces& forces) {
  const BricksAround around = bricks_around(body.elements, b);
  const bool moved = std::any_of(around.begin(), around.end(), [&](std::int32_t other) {
    return other >= 0 && std::any_of(body.q.begin(), body.q.end(), [&](const BrickValues& q) {
             return q.brick(std::size_t(other)) != nullptr;
           });
  });
  if (!moved) return;
  const Vec3d spacing = body.geometry.spacing_mm();
  const double face_mm2 = spacing[(c + 1) % 3] * spacing[(c + 2) % 3];
  const auto push_corners = [&](const Vec3i& low) {
    Hexahedron corners;
    std::array<Slot, 8> slots;
    for (std::size_t n = 0; n < 8; ++n) {
      const Vec3i step = cell_corner(int(n));
      slots[n] = slot_around(around, low.x + step.x, low.y + step.y, low.z + step.z);
      for (int d = 0; d < 3; ++d) {
        corners[n][d] = step[d] + body.q[std::size_t(d)].at(slots[n]) / kFixedOne;
      }
    }
    const double pull = moduli.kpa * share_of_cell(body, moduli, slots) * face_mm2 *
                        (hexahedron_volume(corners) - 1);
    for (std::size_t n = 0; n < 8; ++n) {
      if (slots[n] / kBrickVoxels != b) continue;
      forces[slots[n] % kBrickVoxels] -= pull * hexahedron_gradient(corners, int(n))[c];
    }
  };
  const CellRows cells = find_cells(body, around);
  for (int i = -1; i < 8; ++i) {
    for (int j = -1; j < 8; ++j) {
      for (unsigned bits = cells.rows[i + 1][j + 1]; bits != 0; bits &= bits - 1) {
        push_corners({i, j, __builtin_ctz(bits) - 1});
      }
    }
  }
}

/// A force that a brick adds to a holder's.
struct Share {
  std::int32_t holder;
  double force_mn;
};

/// Sums the forces per handle, mN. Bricks are summed one by one, then together in their order: the
/// same bits for any number of threads.
std::vector<double> forces_mn(const Body& body, int c, const Bearers& bearers, std::size_t handles,
                              const CellModuli& moduli) {
  const LinkTable table(body, c, RigidLinks::absent, spring_links(body, moduli.any()));
  std::vector<std::vector<Share>> shares(body.elements.brick_count());
  parallel_for(shares.size(), Grain{4}, [&](std::size_t b) {
    const std::int32_t* holder = bearers.holder.brick(b);
    if (holder == nullptr) return;
    BrickForces forces{};
    add_springs(body, table, b, holder, forces);
    if (moduli.any()) add_cells(body, c, moduli, b, forces);
    for (std::size_t n = 0; n < kBrickVoxels; ++n) {
      if (forces[n] == 0 || holder[n] == 0 || std::size_t(holder[n]) > handles) continue;
      if (shares[b].empty() || shares[b].back().holder != holder[n]) {
        shares[b].push_back({holder[n], 0});
      }
      shares[b].back().force_mn += forces[n];
    }
  });
  std::vector<double> sums(handles, 0);
  for (const auto& of_brick : shares) {
    for (const Share& share : of_brick) sums[std::size_t(share.holder - 1)] += share.force_mn;
  }
  return sums;
}

}  // namespace

std::vector<Reaction> reactions(const Body& body, const std::vector<SlotSet>& handles,
                                const SlotSet& fixed, const Holds& held, const CellModuli& moduli) {
  check_bulk_modulus(moduli.kpa);
  const bool any_moved =
      std::any_of(body.q.begin(), body.q.end(), [](const BrickValues& q) { return !q.empty(); });
  const bool has_pressure = moduli.any() && any_moved;
  std::vector<Vec3d> along_axes(handles.size(), Vec3d(0));  // mN
  std::vector<Reaction> result(handles.size());
  for (int c = 0; c < 3; ++c) {
    if (body.q[std::size_t(c)].empty() && !has_rest(body, c) && !has_pressure) continue;
    const Bearers bearers = find_bearers(body, c, handles, held_in(body, c, fixed, held));
    const std::vector<double> forces = forces_mn(body, c, bearers, handles.size(), moduli);
    for (std::size_t n = 0; n < handles.size(); ++n) {
      along_axes[n][c] = forces[n];
      result[n].taut[std::size_t(c)] = bearers.taut[n] != 0;
    }
  }
  // The forces are a covector: work per mm along each axis.
  const Vec3d spacing = body.geometry.spacing_mm();
  for (std::size_t n = 0; n < handles.size(); ++n) {
    result[n].force_n = body.geometry.world_gradient_from_index(along_axes[n] * spacing) / 1000;
  }
  return result;
}

}  // namespace supple

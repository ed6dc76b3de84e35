#include "lib/body/rigid_links.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <tuple>

namespace supple {

namespace {

/// Calls visit(brick, axis, low, high, piece of low, piece of high) for links between pieces.
template <class Visit>
void for_each_link_of_pieces(const Body& body, const LinkCuts& cuts, Visit&& visit) {
  if (body.rigid.empty()) return;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    if (body.rigid.number_of->brick(b) == nullptr) continue;
    for_each_link(body.elements, cuts, b, [&](int axis, Slot low, Slot high) {
      const int piece = body.rigid.at(low), other = body.rigid.at(high);
      if (piece >= 0 && other >= 0) visit(axis, low, piece, other);
    });
  }
}

void cut_link(LinkCuts& cuts, Slot low, int axis) {
  cuts.cut(low / kBrickVoxels, int(low % kBrickVoxels), axis);
}

template <class Visit>
void for_each_neighbour(const BrickTopology& elements, const LinkCuts& cuts, Slot slot,
                        Visit&& visit) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool positive : {false, true}) {
      Slot other;
      if (neighbour_slot(elements, cuts, slot, axis, positive, other)) visit(axis, other);
    }
  }
}

}  // namespace

LinkCuts cuts_with_pieces(const Body& body, const LinkCuts& cuts) {
  LinkCuts all = cuts;
  for_each_link_of_pieces(body, cuts,
                          [&](int axis, Slot low, int, int) { cut_link(all, low, axis); });
  return all;
}

std::int64_t cut_joints(const Body& body, LinkCuts& cuts) {
  std::vector<std::pair<Slot, int>> joints;
  for_each_link_of_pieces(body, cuts, [&](int axis, Slot low, int piece, int other) {
    if (piece != other) joints.emplace_back(low, axis);
  });
  for (const auto& [low, axis] : joints) cut_link(cuts, low, axis);
  return std::int64_t(joints.size());
}

std::int64_t cut_joint_spaces(const Body& body, LinkCuts& cuts, double gap_mm,
                              const std::function<bool(std::size_t, std::size_t)>& is_joint) {
  using Entry = std::tuple<double, std::int32_t, Slot>;  // way from a piece in mm, piece, element
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  BrickValues nearest(body.elements.brick_count());  // number of the piece
  BrickArray<double> way_to(body.elements.brick_count());
  const Vec3d spacing = body.geometry.spacing_mm();
  const auto reach = [&](double way, std::int32_t piece, Slot from) {
    for_each_neighbour(body.elements, cuts, from, [&](int axis, Slot to) {
      const double further = way + spacing[axis];
      if (nearest.at(to) == 0 && body.rigid.at(to) < 0 && further <= gap_mm) {
        queue.push({further, piece, to});
      }
    });
  };
  for (std::size_t n = 0; n < body.rigid.list.size(); ++n) {
    body.rigid.list[n].elements->for_each([&](Slot slot) { reach(0, std::int32_t(n) + 1, slot); });
  }
  while (!queue.empty()) {
    const auto [way, piece, slot] = queue.top();
    queue.pop();
    if (nearest.at(slot) != 0) continue;
    nearest.set(slot, piece);
    way_to.touch(slot / kBrickVoxels)[slot % kBrickVoxels] = way;
    reach(way, piece, slot);
  }
  const auto piece_of = [&](Slot slot) {
    return body.rigid.at(slot) >= 0 ? body.rigid.at(slot) + 1 : nearest.at(slot);
  };
  std::vector<std::pair<Slot, int>> parted;
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    for_each_link(body.elements, cuts, b, [&](int axis, Slot low, Slot high) {
      const std::int32_t a = piece_of(low), z = piece_of(high);
      if (a == 0 || z == 0 || a == z) return;
      if (!is_joint(std::size_t(a - 1), std::size_t(z - 1))) return;
      if (way_to.at(low) + spacing[axis] + way_to.at(high) > gap_mm) return;
      parted.emplace_back(low, axis);
    });
  }
  for (const auto& [low, axis] : parted) cut_link(cuts, low, axis);
  return std::int64_t(parted.size());
}

std::vector<std::int64_t> cut_links_inside(const Body& body, const LinkCuts& cuts) {
  std::vector<std::int64_t> counts(body.rigid.list.size(), 0);
  const auto count = [&](const LinkCuts& seen, int sign) {
    for_each_link_of_pieces(body, seen, [&](int, Slot, int piece, int other) {
      if (piece == other) counts[std::size_t(piece)] += sign;
    });
  };
  count({}, 1);
  count(cuts, -1);
  return counts;
}

std::vector<SlotSet> connected_parts(const BrickTopology& elements, const LinkCuts& cuts,
                                     const SlotSet& set) {
  std::vector<SlotSet> parts;
  BrickArray<std::int16_t> waits(elements.brick_count());  // 1: in the set and in no part yet
  set.for_each([&](Slot slot) { waits.touch(slot / kBrickVoxels)[slot % kBrickVoxels] = 1; });
  set.for_each([&](Slot first) {
    if (waits.at(first) == 0) return;
    std::vector<Slot> part = {first};
    waits.set(first, 0);
    for (std::size_t n = 0; n < part.size(); ++n) {
      for_each_neighbour(elements, cuts, part[n], [&](int, Slot other) {
        if (waits.at(other) == 0) return;
        waits.set(other, 0);
        part.push_back(other);
      });
    }
    parts.emplace_back(std::move(part));
  });
  return parts;
}

std::vector<SlotSet> flooded_parts(const Body& body, const DensityGrid& density,
                                   const LinkCuts& cuts, const SlotSet& set,
                                   const std::vector<Slot>& seeds) {
  // Least density on the way here, negative; way at that density in mm, seed, element.
  using Entry = std::tuple<float, double, std::int32_t, Slot>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  BrickValues owner(body.elements.brick_count());  // -1: in the set, owned by none
  set.for_each([&](Slot slot) { owner.set(slot, -1); });
  for (std::size_t n = 0; n < seeds.size(); ++n) {
    queue.push({-std::numeric_limits<float>::infinity(), 0, std::int32_t(n) + 1, seeds[n]});
  }
  const Vec3d spacing = body.geometry.spacing_mm();
  std::vector<std::vector<Slot>> parts(seeds.size());
  while (!queue.empty()) {
    const auto [level, way, seed, slot] = queue.top();
    queue.pop();
    if (owner.at(slot) != -1) continue;
    owner.set(slot, seed);
    parts[std::size_t(seed - 1)].push_back(slot);
    const auto reach = [&, level = level, way = way, seed = seed](int axis, Slot to) {
      if (owner.at(to) != -1) return;
      const float lower = std::max(level, -density.at(voxel_of(body.elements, to)));
      queue.push({lower, lower > level ? spacing[axis] : way + spacing[axis], seed, to});
    };
    for_each_neighbour(body.elements, cuts, slot, reach);
  }
  std::vector<SlotSet> sets;
  for (std::vector<Slot>& part : parts) sets.emplace_back(std::move(part));
  return sets;
}

RigidPieces numbered(std::vector<RigidPiece> pieces, const BrickTopology& elements) {
  pieces.erase(std::remove_if(pieces.begin(), pieces.end(),
                              [](const RigidPiece& piece) { return piece.elements->empty(); }),
               pieces.end());
  if (pieces.empty()) return {};
  auto numbers = std::make_shared<BrickValues>(elements.brick_count());
  for (std::size_t n = 0; n < pieces.size(); ++n) {
    pieces[n].elements->for_each([&](Slot slot) { numbers->set(slot, std::int32_t(n) + 1); });
  }
  return {std::move(pieces), std::move(numbers)};
}

}  // namespace supple

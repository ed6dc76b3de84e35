// Cuts in the air around a body: which of its voxels belong to which element, and which links
// between them are cut.
#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"
#include "volumes/field/cuts/cut_body.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/padded_rows.h"

namespace supple {

namespace {

constexpr int kShellRings = 2;
// Tissue joins two elements beside the air where it leads from one to the other within the box
// around them and as many voxels more.
constexpr int kDetour = 2;
// Elements that no tissue joins are parted where they have moved apart by more, in voxels.
constexpr double kMovedApart = 1;
// Nearer to a surface than this, in voxels, an element is on the side that its cut links say.
constexpr double kUndecided = 0.05;

Vec3i unit_along(int axis) {
  Vec3i step(0);
  step[axis] = 1;
  return step;
}

/// Visits the 26 voxels around one.
template <class Visit>
void for_neighbours(const Vec3i& voxel, Visit&& visit) {
  for (int n = 0; n < 27; ++n) {
    if (n != 13) visit(voxel + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
  }
}

/// Distance of `other` from the surface, with its sign along the normal of `one`.
double same_way(const CutPlanes::Side& one, const CutPlanes::Side& other) {
  return one.normal.dot(other.normal) < 0 ? -other.distance : other.distance;
}

/// True if both are on one side of the surface, or it is not known at one of them.
bool is_same_side(const CutPlanes::Side& a, const CutPlanes::Side& b) {
  return !a.is_known || !b.is_known || std::signbit(a.distance) == std::signbit(same_way(a, b));
}

/// The place where the surface crosses the link from one to the other; 0: unknown.
LinkCuts::Place place_between(const CutPlanes::Side& low, const CutPlanes::Side& high) {
  if (!low.is_known || !high.is_known || is_same_side(low, high)) return 0;
  const double apart = low.distance - same_way(low, high);
  return LinkCuts::place_of(apart == 0 ? 0.5 : low.distance / apart);
}

bool have_moved_apart(const VectorBricks& u, const Vec3i& a, const Vec3i& b) {
  Vec3f of_a(0), of_b(0);
  return u.at(a, of_a) && u.at(b, of_b) && (of_a - of_b).length() > kMovedApart;
}

/// The elements in a brick of voxels and around it, and how they have moved.
class NearElements {
 public:
  NearElements(const BrickTopology& voxels, const BrickTopology& elements, const VectorBricks& u,
               std::size_t b) {
    const Surroundings around = surroundings_of(voxels, b);
    for (std::size_t n = 0; n < around.size(); ++n) {
      const std::int32_t own =
          elements.find(voxels.origin(b) + surrounding_step(int(n)) * kBrickDim);
      if (around[n] < 0 || own < 0) continue;
      m_masks[n] = &elements.mask(std::size_t(own));
      m_vectors[n] = u.vectors.brick_or_zero(std::size_t(around[n]));
    }
  }
  /// Displacement of a voxel by its place in the brick, -8 to 15 along each axis; null: no element.
  const Vec3f* move_at(const Vec3i& local) const {
    const SurroundingVoxel voxel = surrounding_voxel(local);
    const auto n = std::size_t(voxel.brick);
    const bool is_element = m_masks[n] != nullptr && mask_test(*m_masks[n], voxel.offset);
    return is_element ? m_vectors[n] + voxel.offset : nullptr;
  }

 private:
  std::array<const BrickMask*, 27> m_masks{};
  std::array<const Vec3f*, 27> m_vectors{};
};

}  // namespace

void CutBody::MoveBox::add(const MoveBox& other) {
  for (int a = 0; a < 3; ++a) {
    lo[a] = std::min(lo[a], other.lo[a]);
    hi[a] = std::max(hi[a], other.hi[a]);
  }
}

bool CutBody::MoveBox::is_apart() const {
  return lo.x <= hi.x && (hi - lo).length() > kMovedApart;
}

BrickMask air_in(const BrickTopology& voxels, const BrickTopology& elements, std::size_t b) {
  BrickMask air = voxels.mask(b);
  const std::int32_t own = elements.find(voxels.origin(b));
  if (own >= 0) take_out(elements.mask(std::size_t(own)), air);
  return air;
}

/// The owner of a voxel, which is the voxel itself where no element is in reach.
CutBody::Owner CutBody::owner_of(const Vec3i& voxel) const {
  Owner owner{in_slice(voxel), side_of(voxel)};
  if (is_element(voxel)) return owner;
  int shortest = 3 * kShellRings * kShellRings + 1, shortest_of_any = shortest;
  Vec3i nearest = owner.element;
  for (int x = -kShellRings; x <= kShellRings; ++x) {
    for (int y = -kShellRings; y <= kShellRings; ++y) {
      for (int z = -kShellRings; z <= kShellRings; ++z) {
        const Vec3i step(x, y, z);
        const int length2 = step.dot(step);
        if (length2 >= shortest || !is_element(voxel + step)) continue;
        if (length2 < shortest_of_any) {
          shortest_of_any = length2;
          nearest = voxel + step;
        }
        if (!is_same_side(owner.side, side_of(voxel + step))) continue;
        shortest = length2;
        owner.element = in_slice(voxel + step);
      }
    }
  }
  if (shortest > 3 * kShellRings * kShellRings) owner.element = in_slice(nearest);
  return owner;
}

/// True if links within a box lead from one element to another; `over_cuts`: cut ones, too.
bool CutBody::joins(const IndexBox& box, const Vec3i& from, const Vec3i& to, bool over_cuts) const {
  const Vec3i size = box.hi - box.lo + Vec3i(1);
  std::vector<bool> is_reached(std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z));
  std::vector<Vec3i> reached;
  const auto reach = [&](const Vec3i& voxel) {
    const Vec3i at = voxel - box.lo;
    auto is_known = is_reached[(std::size_t(at.x) * std::size_t(size.y) + std::size_t(at.y)) *
                                   std::size_t(size.z) +
                               std::size_t(at.z)];
    if (!is_known) reached.push_back(voxel);
    is_known = true;
  };
  reach(from);
  for (std::size_t n = 0; n < reached.size(); ++n) {
    if (reached[n] == to) return true;
    for (int face = 0; face < 6; ++face) {
      const Vec3i here = reached[n], next = here + unit_along(face / 2) * (face % 2 ? 1 : -1);
      if (!box.contains(next) || !is_element(next)) continue;
      if (over_cuts || !is_element_cut(face % 2 ? here : next, face / 2)) reach(next);
    }
  }
  return false;
}

/// Tells how two elements are parted: by cuts in the smallest box around them in which tissue had
/// joined them, or only when they have moved apart, where no box does.
CutBody::Parting CutBody::parting_of(const Vec3i& a, const Vec3i& b) const {
  if (a == b || !is_element(a) || !is_element(b)) return Parting::none;
  IndexBox box{a, a};
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = std::min(a[axis], b[axis]);
    box.hi[axis] = std::max(a[axis], b[axis]);
  }
  for (int margin = 0; margin <= kDetour; ++margin) {
    if (joins(box, a, b, true)) return joins(box, a, b, false) ? Parting::none : Parting::always;
    box.lo -= Vec3i(1);
    box.hi += Vec3i(1);
  }
  return Parting::when_apart;
}

/// Voxels of the air that touch elements which have moved apart.
BrickMask CutBody::contested_in(const VectorBricks& u, std::size_t b) const {
  BrickMask contested{};
  const BrickMask air = air_in(m_voxels, m_elements, b);
  if (mask_count(air) == 0) return contested;
  MoveBox around;
  for (const std::int32_t n : surroundings_of(m_voxels, b)) {
    if (n >= 0) around.add(m_moves[std::size_t(n)]);
  }
  if (!around.is_apart()) return contested;
  const NearElements near(m_voxels, m_elements, u, b);
  for_each_active(air, [&](int offset) {
    MoveBox touching;
    for_neighbours(brick_local(offset), [&](const Vec3i& beside) {
      if (const Vec3f* const move = near.move_at(beside)) touching.add(*move);
    });
    if (touching.is_apart()) mask_set(contested, offset);
  });
  return contested;
}

/// The air of a brick that is beside cut links or within a voxel of contested air.
BrickMask CutBody::air_beside(std::size_t b) const {
  static constexpr BrickMask kNone{};
  const auto contested_of = [&](std::int32_t n) -> const BrickMask& {
    const OfBrick* const brick = m_bricks[std::size_t(n)].get();
    return brick == nullptr ? kNone : brick->contested;
  };
  BrickMask beside = dilated(masks_around(surroundings_of(m_voxels, b), contested_of));
  keep(air_in(m_voxels, m_elements, b), beside);
  if (m_bricks[b]) add(m_bricks[b]->beside_cuts, beside);
  return beside;
}

/// Links between voxels of which one is in the air where links may be cut, by their lower ends.
CutBody::AxisMasks CutBody::links_in_air(std::size_t b) const {
  static constexpr BrickMask kNone{};
  const auto air_in = [&](std::int32_t n) -> const BrickMask& {
    return n < 0 || !m_bricks[std::size_t(n)] ? kNone : m_bricks[std::size_t(n)]->air;
  };
  AxisMasks links;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int32_t above = m_voxels.find(m_voxels.origin(b) + unit_along(axis) * kBrickDim);
    const BrickMask& own = m_voxels.mask(b);
    BrickMask both = shifted_down(own, above < 0 ? kNone : m_voxels.mask(std::size_t(above)), axis);
    keep(own, both);
    BrickMask& wanted = links[std::size_t(axis)];
    wanted = shifted_down(air_in(std::int32_t(b)), air_in(above), axis);
    add(air_in(std::int32_t(b)), wanted);
    keep(both, wanted);
  }
  return links;
}

void CutBody::find_candidates(std::size_t b, const AxisMasks& links) {
  OfBrick& brick = *m_bricks[b];
  std::unordered_map<Vec3i, Owner, VoxelHash> owners;
  const auto known_owner_of = [&](const Vec3i& voxel) -> const Owner& {
    const auto found = owners.find(voxel);
    return found != owners.end() ? found->second
                                 : owners.emplace(voxel, owner_of(voxel)).first->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    BrickMask missing = links[std::size_t(axis)];
    take_out(brick.known[std::size_t(axis)], missing);
    add(missing, brick.known[std::size_t(axis)]);
    for_each_active(missing, [&](int offset) {
      const Vec3i voxel = m_voxels.origin(b) + brick_local(offset);
      const Owner low = known_owner_of(voxel);
      const Owner high = known_owner_of(voxel + unit_along(axis));
      const Parting parting = parting_of(low.element, high.element);
      if (parting == Parting::none) return;
      brick.candidates.push_back({std::int16_t(offset), std::int8_t(axis), parting,
                                  place_between(low.side, high.side), low.element, high.element});
    });
  }
}

/// Finds the cut links of the brick; true if any of them or its place is another than before.
bool CutBody::cut_links_in(const VectorBricks& u, std::size_t b) {
  OfBrick& brick = *m_bricks[b];
  const AxisMasks links = links_in_air(b);
  find_candidates(b, links);
  AxisMasks cut = brick.of_elements;
  std::vector<LinkCuts::Place> places = brick.element_places;
  for (const Candidate& link : brick.candidates) {
    if (!mask_test(links[std::size_t(link.axis)], link.offset)) continue;
    if (link.parting == Parting::when_apart && !have_moved_apart(u, link.low, link.high)) continue;
    mask_set(cut[std::size_t(link.axis)], link.offset);
    if (link.place == 0) continue;
    places.resize(3 * kBrickVoxels, 0);
    places[std::size_t(link.axis * kBrickVoxels + link.offset)] = link.place;
  }
  if (cut == brick.cut && places == brick.places) return false;
  brick.cut = cut;
  brick.places = std::move(places);
  return true;
}

/// The side of a voxel; for an element beside the surface cut links decide, as planes are rounded.
CutPlanes::Side CutBody::side_of(const Vec3i& voxel) const {
  CutPlanes::Side side = m_planes.side_of(Vec3d(voxel));
  if (!side.is_known || std::abs(side.distance) > kUndecided || !is_element(voxel)) return side;
  for (int axis = 0; axis < 3; ++axis) {
    const double slope = side.normal[axis];
    if (std::abs(slope) < 0.1) continue;
    const bool is_low = is_element_cut(voxel, axis) && is_element(voxel + unit_along(axis));
    const bool is_high =
        is_element_cut(voxel - unit_along(axis), axis) && is_element(voxel - unit_along(axis));
    if (is_low == is_high) continue;
    side.distance = std::copysign(std::abs(side.distance), is_low ? -slope : slope);
    return side;
  }
  return side;
}

}  // namespace supple

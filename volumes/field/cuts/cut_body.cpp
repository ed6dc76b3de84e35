#include "volumes/field/cuts/cut_body.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/padded_rows.h"
#include "volumes/grid/voxel_sets.h"

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

Vec3i unit(int axis) {
  Vec3i step(0);
  step[axis] = 1;
  return step;
}

/// Voxels of the 27 around one, itself left out.
template <class Visit>
void for_neighbours(const Vec3i& voxel, Visit&& visit) {
  for (int n = 0; n < 27; ++n) {
    if (n != 13) visit(voxel + Vec3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1));
  }
}

/// Along the normal of the one, of the other.
double same_way(const CutPlanes::Side& one, const CutPlanes::Side& other) {
  return one.normal.dot(other.normal) < 0 ? -other.distance : other.distance;
}

/// Where a surface is not known nothing is on another side.
bool is_same_side(const CutPlanes::Side& a, const CutPlanes::Side& b) {
  return !a.is_known || !b.is_known || std::signbit(a.distance) == std::signbit(same_way(a, b));
}

/// Where the surface crosses the link from one to the other; 0: unknown.
LinkCuts::Place place_between(const CutPlanes::Side& low, const CutPlanes::Side& high) {
  if (!low.is_known || !high.is_known || is_same_side(low, high)) return 0;
  const double apart = low.distance - same_way(low, high);
  return LinkCuts::place_of(apart == 0 ? 0.5 : low.distance / apart);
}

/// Of displacements.
struct MoveBox {
  Vec3f lo{HUGE_VALF, HUGE_VALF, HUGE_VALF}, hi{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

  void add(const Vec3f& move) { add({move, move}); }
  void add(const MoveBox& other) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], other.lo[a]);
      hi[a] = std::max(hi[a], other.hi[a]);
    }
  }
  bool is_apart() const { return lo.x <= hi.x && (hi - lo).length() > kMovedApart; }
};

}  // namespace

CutBody::CutBody(const VectorBricks& u, const BrickTopology& elements, const LinkCuts& cuts,
                 const Vec3i& dims)
    : m_voxels(u.topology), m_elements(elements), m_dims(dims) {
  std::vector<Link> links;
  for (std::size_t b = 0; b < cuts.brick_end(); ++b) {
    const LinkCuts::BrickCuts* brick = cuts.brick(b);
    for (int axis = 0; brick != nullptr && axis < 3; ++axis) {
      for_each_active((*brick)[axis], [&](int offset) {
        links.push_back({elements.origin(b) + brick_local(offset), axis});
        const LinkCuts::Place place = cuts.place(b, offset, axis);
        mark(links.back(), place);
        if (place == 0) return;
        Vec3d at(links.back().low);
        at[axis] += LinkCuts::fraction_of(place);
        m_planes.add(at, axis);
      });
    }
  }
  m_planes.fit();
  cut_shell(u, links);
  find_parted_cells();
}

Vec3i CutBody::in_slice(Vec3i voxel) const {
  for (int a = 0; a < 3; ++a) {
    if (m_dims[a] == 1 && std::abs(voxel[a]) == 1) voxel[a] = 0;
  }
  return voxel;
}

bool CutBody::is_voxel(const Vec3i& voxel) const {
  return m_voxels.is_active(in_slice(voxel));
}

void CutBody::mark(const Link& link, LinkCuts::Place place) {
  CutAxes& axes = m_cut[link.low];
  axes.bits |= std::uint8_t(1 << link.axis);
  if (place != 0) axes.places[std::size_t(link.axis)] = place;
}

bool CutBody::is_cut(const Vec3i& low, int axis) const {
  const auto found = m_cut.find(in_slice(low));
  return found != m_cut.end() && (found->second.bits >> axis & 1);
}

LinkCuts::Place CutBody::place(const Link& link) const {
  const auto found = m_cut.find(in_slice(link.low));
  return found == m_cut.end() ? LinkCuts::Place(0) : found->second.places[std::size_t(link.axis)];
}

/// The voxel itself where none is in reach.
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

/// Whether elements within a box lead from one to another, over links that are cut or not.
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
      const Vec3i here = reached[n], next = here + unit(face / 2) * (face % 2 ? 1 : -1);
      if (!box.contains(next) || !is_element(next)) continue;
      if (over_cuts || !is_cut(face % 2 ? here : next, face / 2)) reach(next);
    }
  }
  return false;
}

/// Whether two elements are on different sides: parted by cuts in the smallest box around them in
/// which tissue had joined them, or apart where none does.
bool CutBody::separates(const VectorBricks& u, const Vec3i& a, const Vec3i& b) const {
  if (a == b || !is_element(a) || !is_element(b)) return false;
  IndexBox box{a, a};
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[axis] = std::min(a[axis], b[axis]);
    box.hi[axis] = std::max(a[axis], b[axis]);
  }
  for (int margin = 0; margin <= kDetour; ++margin) {
    if (joins(box, a, b, true)) return !joins(box, a, b, false);
    box.lo -= Vec3i(1);
    box.hi += Vec3i(1);
  }
  Vec3f of_a(0), of_b(0);
  return u.at(a, of_a) && u.at(b, of_b) && (of_a - of_b).length() > kMovedApart;
}

/// Voxels of the shell that touch elements which have moved apart.
std::vector<Vec3i> CutBody::contested_voxels(const VectorBricks& u) const {
  const BrickTopology& voxels = m_voxels;
  std::vector<MoveBox> moves(voxels.brick_count());
  tbb::parallel_for(std::size_t(0), moves.size(), [&](std::size_t b) {
    const std::int32_t own = m_elements.find(voxels.origin(b));
    if (own < 0) return;
    for_each_active(m_elements.mask(std::size_t(own)),
                    [&](int offset) { moves[b].add(u.vectors.brick_or_zero(b)[offset]); });
  });
  std::vector<std::vector<Vec3i>> found(moves.size());
  tbb::parallel_for(std::size_t(0), moves.size(), [&](std::size_t b) {
    MoveBox around;
    for (const std::int32_t n : surroundings_of(voxels, b)) {
      if (n >= 0) around.add(moves[std::size_t(n)]);
    }
    if (!around.is_apart()) return;
    for_each_active(voxels.mask(b), [&](int offset) {
      const Vec3i voxel = voxels.origin(b) + brick_local(offset);
      if (is_element(voxel)) return;
      MoveBox touching;
      for_neighbours(voxel, [&](const Vec3i& beside) {
        Vec3f move;
        if (is_element(beside) && u.at(in_slice(beside), move)) touching.add(move);
      });
      if (touching.is_apart()) found[b].push_back(voxel);
    });
  });
  std::vector<Vec3i> contested;
  for (const auto& part : found) contested.insert(contested.end(), part.begin(), part.end());
  return contested;
}

/// Within three voxels of a cut link, and within one of a contested voxel.
BrickTopology CutBody::shell_beside_cuts(const VectorBricks& u,
                                         const std::vector<Link>& links) const {
  std::vector<Vec3i> low;
  for (const Link& link : links) low.push_back(link.low);
  const BrickTopology near =
      unite(dilate(topology_of(low), 3), dilate(topology_of(contested_voxels(u)), 1));
  return subtract(intersect(near, m_voxels), m_elements);
}

void CutBody::cut_shell(const VectorBricks& u, const std::vector<Link>& links) {
  const BrickTopology shell = shell_beside_cuts(u, links);
  const BrickTopology around = intersect(dilate(shell, 1), m_voxels);
  std::vector<std::vector<Owner>> owners(around.brick_count());
  tbb::parallel_for(std::size_t(0), owners.size(), [&](std::size_t b) {
    owners[b].resize(kBrickVoxels);
    for_each_active(around.mask(b), [&](int offset) {
      owners[b][std::size_t(offset)] = owner_of(around.origin(b) + brick_local(offset));
    });
  });
  const auto owner_at = [&](const Vec3i& voxel) -> const Owner& {
    return owners[std::size_t(around.find(voxel))][std::size_t(brick_offset(voxel))];
  };
  using Added = std::vector<std::pair<Link, LinkCuts::Place>>;
  std::vector<Added> added(shell.brick_count());
  tbb::parallel_for(std::size_t(0), added.size(), [&](std::size_t b) {
    for_each_active(shell.mask(b), [&](int offset) {
      const Vec3i voxel = shell.origin(b) + brick_local(offset);
      for (int face = 0; face < 6; ++face) {
        const Vec3i next = voxel + unit(face / 2) * (face % 2 ? 1 : -1);
        if (!m_voxels.is_active(next)) continue;
        const Link link{face % 2 ? voxel : next, face / 2};
        const Owner& low = owner_at(link.low);
        const Owner& high = owner_at(face % 2 ? next : voxel);
        if (separates(u, low.element, high.element)) {
          added[b].emplace_back(link, place_between(low.side, high.side));
        }
      }
    });
  });
  for (const Added& of_brick : added) {
    for (const auto& [link, place] : of_brick) mark(link, place);
  }
}

/// Of an element beside the surface what its cut links say, since rounding has a say in planes.
CutPlanes::Side CutBody::side_of(const Vec3i& voxel) const {
  CutPlanes::Side side = m_planes.side_of(Vec3d(voxel));
  if (!side.is_known || std::abs(side.distance) > kUndecided || !is_element(voxel)) return side;
  for (int axis = 0; axis < 3; ++axis) {
    const double slope = side.normal[axis];
    if (std::abs(slope) < 0.1) continue;
    const bool is_low = is_cut(voxel, axis) && is_element(voxel + unit(axis));
    const bool is_high = is_cut(voxel - unit(axis), axis) && is_element(voxel - unit(axis));
    if (is_low == is_high) continue;
    side.distance = std::copysign(std::abs(side.distance), is_low ? -slope : slope);
    return side;
  }
  return side;
}

bool CutBody::connects(const Vec3i& from, const Vec3i& to) const {
  // Depth first over the corners of the box between them.
  const Vec3i step = to - from;
  const auto at = [&](int n) {
    return from + Vec3i(n & 4 ? step.x : 0, n & 2 ? step.y : 0, n & 1 ? step.z : 0);
  };
  const int last = (step.x != 0 ? 4 : 0) | (step.y != 0 ? 2 : 0) | (step.z != 0 ? 1 : 0);
  int reached = 1, open = 1;
  bool any_cut = false;
  while (open != 0) {
    const int n = __builtin_ctz(unsigned(open));
    open &= open - 1;
    const Vec3i here = at(n);
    for (int axis = 0; axis < 3; ++axis) {
      const int bit = 4 >> axis;
      if (!(last & bit)) continue;
      const Vec3i there = at(n ^ bit);
      if (!is_voxel(there)) continue;
      if (is_cut(here[axis] < there[axis] ? here : there, axis)) {
        any_cut = true;
      } else if (!(reached >> (n ^ bit) & 1)) {
        reached |= 1 << (n ^ bit);
        open |= 1 << (n ^ bit);
      }
    }
  }
  return (reached >> last & 1) || !any_cut;
}

CellSides CutBody::sides(const Vec3i& cell) const {
  CellSides sides;
  sides.of.fill(255);
  sides.count = 0;
  for (int first = 0; first < 8; ++first) {
    if (sides.of[std::size_t(first)] != 255) continue;
    const std::uint8_t side = std::uint8_t(sides.count++);
    sides.of[std::size_t(first)] = side;
    for (int open = 1 << first; open != 0;) {
      const int n = __builtin_ctz(unsigned(open));
      open &= open - 1;
      for (int axis = 0; axis < 3; ++axis) {
        const int bit = 4 >> axis, next = n ^ bit, low = n & ~bit;
        if (sides.of[std::size_t(next)] != 255) continue;
        if (is_cut(cell + Vec3i(low >> 2, low >> 1 & 1, low & 1), axis)) continue;
        sides.of[std::size_t(next)] = side;
        open |= 1 << next;
      }
    }
  }
  if (sides.count > 2) join_around(cell, sides);
  return sides;
}

/// A bent surface may part a cell in three, though two of the parts hold together beside the cell:
/// these are one side. Where a surface is not known, what it parted stays apart.
void CutBody::join_around(const Vec3i& cell, CellSides& sides) const {
  const IndexBox box{cell - Vec3i(1), cell + Vec3i(2)};
  for (int a = 0; a < 8; ++a) {
    for (int b = a + 1; b < 8; ++b) {
      const std::uint8_t one = sides.of[std::size_t(a)], other = sides.of[std::size_t(b)];
      const Vec3i from = cell + cell_corner(a), to = cell + cell_corner(b);
      if (one == other || !is_element(from) || !is_element(to)) continue;
      if (!m_planes.side_of(Vec3d(from)).is_known || !joins(box, from, to, false)) continue;
      const std::uint8_t kept = std::min(one, other), gone = std::max(one, other);
      for (std::uint8_t& side : sides.of) {
        if (side == gone) side = kept;
        if (side > gone) --side;
      }
      --sides.count;
    }
  }
}

void CutBody::find_parted_cells() {
  std::vector<Vec3i> cells;
  for (const auto& [low, axes] : m_cut) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(axes.bits >> axis & 1)) continue;
      const Vec3i u = unit((axis + 1) % 3), v = unit((axis + 2) % 3);
      for (const Vec3i& cell : {low, low - u, low - v, low - u - v}) cells.push_back(cell);
    }
  }
  sort_unique(cells);
  for (const Vec3i& cell : cells) {
    bool complete = true;
    for (int n = 0; n < 8 && complete; ++n) {
      complete = is_voxel(cell + Vec3i(n >> 2, n >> 1 & 1, n & 1));
    }
    if (complete && sides(cell).count > 1) m_parted.push_back(cell);
  }
}

}  // namespace supple

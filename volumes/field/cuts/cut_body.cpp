#include "volumes/field/cuts/cut_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volumes/base/parallel.h"
#include "volumes/field/inversion/source_cells.h"
#include "volumes/grid/cell.h"
#include "volumes/grid/mask_steps.h"
#include "volumes/grid/padded_rows.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

// How far a cut link can be seen, in bricks: the side of a voxel follows from crossings within the
// blocks of planes around it, whose normals follow from those around them, and an owner is two
// voxels away.
constexpr int kSeenBricks = 3;
// Links of the shell may be cut so near to a cut link, in voxels.
constexpr int kBesideCut = 3;

Vec3i unit_step(int axis) {
  Vec3i step(0);
  step[axis] = 1;
  return step;
}

}  // namespace

CutBody::CutBody(const BrickTopology& voxels, const BrickTopology& elements, const Vec3i& dims)
    : m_voxels(voxels),
      m_elements(elements),
      m_cells(thickened(voxels, dims)),
      m_dims(dims),
      m_bricks(voxels.brick_count()),
      m_moves(voxels.brick_count()),
      m_parted(m_cells.brick_count()) {}

CutBody::CutBody(const VectorBricks& u, const BrickTopology& elements, const LinkCuts& cuts,
                 const Vec3i& dims)
    : CutBody(u.topology, elements, dims) {
  set_cuts(cuts);
  follow(u, all_bricks(m_voxels));
}

Vec3i CutBody::in_slice(Vec3i voxel) const {
  for (int a = 0; a < 3; ++a) {
    if (m_dims[a] == 1 && std::abs(voxel[a]) == 1) voxel[a] = 0;
  }
  return voxel;
}

CutBody::OfBrick& CutBody::touch(std::size_t b) {
  if (!m_bricks[b]) m_bricks[b] = std::make_unique<OfBrick>();
  return *m_bricks[b];
}

/// The brick of a voxel; null where nothing is known of it.
const CutBody::OfBrick* CutBody::brick_of(const Vec3i& voxel, int& offset) const {
  const Vec3i at = in_slice(voxel);
  const std::int32_t b = m_voxels.find(at);
  if (b < 0 || !m_bricks[std::size_t(b)]) return nullptr;
  offset = brick_offset(at);
  return m_bricks[std::size_t(b)].get();
}

bool CutBody::is_cut(const Vec3i& low, int axis) const {
  int offset;
  const OfBrick* const brick = brick_of(low, offset);
  return brick != nullptr && mask_test(brick->cut[std::size_t(axis)], offset);
}

bool CutBody::is_element_cut(const Vec3i& low, int axis) const {
  int offset;
  const OfBrick* const brick = brick_of(low, offset);
  return brick != nullptr && mask_test(brick->of_elements[std::size_t(axis)], offset);
}

LinkCuts::Place CutBody::place(const Link& link) const {
  int offset;
  const OfBrick* const brick = brick_of(link.low, offset);
  if (brick == nullptr || brick->places.empty()) return 0;
  return brick->places[std::size_t(link.axis * kBrickVoxels + offset)];
}

/// Takes over the links of one brick; true if any of them is another.
bool CutBody::take_over(const LinkCuts& cuts, std::size_t element_brick) {
  const LinkCuts::BrickCuts* const given = cuts.brick(element_brick);
  const auto b = std::size_t(m_voxels.find(m_elements.origin(element_brick)));
  if (given == nullptr && !m_bricks[b]) return false;
  AxisMasks links{};
  std::vector<LinkCuts::Place> places;
  for (int axis = 0; given != nullptr && axis < 3; ++axis) {
    links[std::size_t(axis)] = (*given)[std::size_t(axis)];
    for_each_active(links[std::size_t(axis)], [&](int offset) {
      const LinkCuts::Place place = cuts.place(element_brick, offset, axis);
      if (place == 0) return;
      places.resize(3 * kBrickVoxels, 0);
      places[std::size_t(axis * kBrickVoxels + offset)] = place;
    });
  }
  OfBrick& brick = touch(b);
  if (brick.of_elements == links && brick.element_places == places) return false;
  brick.of_elements = links;
  brick.element_places = std::move(places);
  return true;
}

void CutBody::set_cuts(const LinkCuts& cuts) {
  BrickList changed;
  for (std::size_t b = 0; b < m_elements.brick_count(); ++b) {
    if (take_over(cuts, b)) changed.push_back(m_voxels.find(m_elements.origin(b)));
  }
  if (changed.empty()) return;
  m_cut_links = cuts.count();
  fit_planes();
  BrickList seen = changed;
  for (int ring = 0; ring < kSeenBricks; ++ring) seen = with_neighbours(m_voxels, seen);
  for (const std::int32_t b : seen) {
    if (!m_bricks[std::size_t(b)]) continue;
    m_bricks[std::size_t(b)]->known = {};
    m_bricks[std::size_t(b)]->candidates.clear();
  }
  mark_beside_cuts(with_neighbours(m_voxels, changed));
  m_newly_cut = unite(m_newly_cut, seen);
}

void CutBody::fit_planes() {
  const CutPlanes known = std::exchange(m_planes, {});
  for (std::size_t b = 0; b < m_bricks.size(); ++b) {
    const OfBrick* const brick = m_bricks[b].get();
    if (brick == nullptr || brick->element_places.empty()) continue;
    for (int axis = 0; axis < 3; ++axis) {
      for_each_active(brick->of_elements[std::size_t(axis)], [&](int offset) {
        const LinkCuts::Place place =
            brick->element_places[std::size_t(axis * kBrickVoxels + offset)];
        if (place == 0) return;
        Vec3d at(m_voxels.origin(b) + brick_local(offset));
        at[axis] += LinkCuts::fraction_of(place);
        m_planes.add(at, axis);
      });
    }
  }
  m_planes.fit(known);
}

/// Marks the air within three voxels of a cut link, in these bricks.
void CutBody::mark_beside_cuts(const BrickList& bricks) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  for (const std::int32_t b : with_neighbours(m_voxels, bricks)) {
    const OfBrick* const brick = m_bricks[std::size_t(b)].get();
    if (brick == nullptr) continue;
    BrickMask low{};
    for (const BrickMask& links : brick->of_elements) add(links, low);
    origins.push_back(m_voxels.origin(std::size_t(b)));
    masks.push_back(low);
  }
  const BrickTopology near = dilate(BrickTopology(origins, masks), kBesideCut);
  for (const std::int32_t b : bricks) {
    BrickMask beside = air_in(m_voxels, m_elements, std::size_t(b));
    const std::int32_t n = near.find(m_voxels.origin(std::size_t(b)));
    keep(n < 0 ? BrickMask{} : near.mask(std::size_t(n)), beside);
    if (m_bricks[std::size_t(b)] || mask_count(beside) > 0) {
      touch(std::size_t(b)).beside_cuts = beside;
    }
  }
}

/// Finds a mask of these bricks again; returns those of them in which it has changed.
template <class Find>
BrickList CutBody::renew(BrickMask OfBrick::*mask, const BrickList& bricks, Find&& find) {
  std::vector<BrickMask> found(bricks.size());
  parallel_for(bricks.size(), [&](std::size_t n) { found[n] = find(std::size_t(bricks[n])); });
  BrickList changed;
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    const auto b = std::size_t(bricks[n]);
    const BrickMask before = m_bricks[b] ? *m_bricks[b].*mask : BrickMask{};
    if (found[n] == before) continue;
    touch(b).*mask = found[n];
    changed.push_back(bricks[n]);
  }
  return changed;
}

CutBody::Changes CutBody::follow(const VectorBricks& u, const BrickList& changed) {
  const BrickList newly_cut = std::exchange(m_newly_cut, {});
  const BrickList around = with_neighbours(m_voxels, changed);
  parallel_for(changed.size(), [&](std::size_t n) {
    const auto b = std::size_t(changed[n]);
    m_moves[b] = {};
    const std::int32_t own = m_elements.find(m_voxels.origin(b));
    if (own < 0) return;
    for_each_active(m_elements.mask(std::size_t(own)),
                    [&](int offset) { m_moves[b].add(u.vectors.brick_or_zero(b)[offset]); });
  });
  const BrickList contested =
      renew(&OfBrick::contested, around, [&](std::size_t b) { return contested_in(u, b); });
  const BrickList aired =
      renew(&OfBrick::air, unite(with_neighbours(m_voxels, contested), newly_cut),
            [&](std::size_t b) { return air_beside(b); });
  BrickList linked = unite(with_lower_neighbours(m_voxels, aired), newly_cut);
  linked = unite(linked, bricks_where(around, [&](std::size_t b) {
                   return m_bricks[b] && !m_bricks[b]->candidates.empty();
                 }));
  linked = bricks_where(linked, [&](std::size_t b) {
    if (!m_bricks[b] && links_in_air(b) != AxisMasks{}) touch(b);
    return m_bricks[b] != nullptr;
  });
  std::vector<std::uint8_t> is_other(linked.size());
  parallel_for(linked.size(),
               [&](std::size_t n) { is_other[n] = cut_links_in(u, std::size_t(linked[n])); });
  Changes changes;
  for (std::size_t n = 0; n < linked.size(); ++n) {
    if (is_other[n]) changes.links.push_back(linked[n]);
  }
  BrickList beside;  // of cells()
  for (const std::int32_t b : unite(changes.links, newly_cut)) {
    for (int n = 0; n < kCellCorners; ++n) {
      const Vec3i origin = m_voxels.origin(std::size_t(b)) - cell_corner(n) * kBrickDim;
      if (const std::int32_t c = m_cells.find(origin); c >= 0) beside.push_back(c);
    }
  }
  std::sort(beside.begin(), beside.end());
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  is_other.assign(beside.size(), 0);
  parallel_for(beside.size(), [&](std::size_t n) {
    std::vector<PartedCell> parted = find_parted(std::size_t(beside[n]));
    is_other[n] = parted != m_parted[std::size_t(beside[n])];
    m_parted[std::size_t(beside[n])] = std::move(parted);
  });
  for (std::size_t n = 0; n < beside.size(); ++n) {
    if (is_other[n]) changes.parted.push_back(beside[n]);
  }
  return changes;
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
        if (is_cut(cell + cell_corner(low), axis)) continue;
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

/// The cells that begin in a brick, beside its cut links and those of the bricks above.
std::vector<PartedCell> CutBody::find_parted(std::size_t b) const {
  const Vec3i& origin = m_cells.origin(b);
  BrickMask beside{};
  const auto add_cell = [&](const Vec3i& cell) {
    if (Vec3i(cell.x & ~7, cell.y & ~7, cell.z & ~7) == origin) {
      mask_set(beside, brick_offset(cell));
    }
  };
  for (int n = 0; n < kCellCorners; ++n) {
    const std::int32_t above = m_voxels.find(origin + cell_corner(n) * kBrickDim);
    if (above < 0 || !m_bricks[std::size_t(above)]) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3i v = unit_step((axis + 1) % 3), w = unit_step((axis + 2) % 3);
      for_each_active(m_bricks[std::size_t(above)]->cut[std::size_t(axis)], [&](int offset) {
        const Vec3i low = m_voxels.origin(std::size_t(above)) + brick_local(offset);
        for (const Vec3i& cell : {low, low - v, low - w, low - v - w}) add_cell(cell);
      });
    }
  }
  std::vector<PartedCell> parted;
  for_each_active(beside, [&](int offset) {
    const Vec3i cell = origin + brick_local(offset);
    for (int n = 0; n < kCellCorners; ++n) {
      if (!is_voxel(cell + cell_corner(n))) return;
    }
    const CellSides of_cell = sides(cell);
    if (of_cell.count > 1) parted.push_back({cell, of_cell});
  });
  return parted;
}

}  // namespace supple

#include "lib/chainmail/diagonal_visit.h"

#include <algorithm>

#include "lib/body/brick_faces.h"

namespace supple {

namespace {

/// Values around the 64 of a face, so that those of a diagonal's other end can be read.
constexpr int kFaceHalo = 9;
template <class T>
struct HaloFace {
  T values[kFaceHalo + kFaceVoxels + kFaceHalo] = {};
  T* first() { return values + kFaceHalo; }
  const T* first() const { return values + kFaceHalo; }
};

/// The face towards a side that is one step along an axis; -1 for edges and corners.
int face_of_side(int side) {
  if (is_diagonal(side)) return -1;
  return 2 * axis_of_direction(side) + (side > kNoStep ? 1 : 0);
}

/// The bits of a face whose step along the face's two axes stays in it.
std::uint64_t steps_in_face(int u, int v) {
  std::uint64_t bits = ~std::uint64_t(0);
  if (u > 0) bits &= bits >> 8;
  if (u < 0) bits &= bits << 8;
  if (v > 0) bits &= 0x7f7f7f7f7f7f7f7fu;
  if (v < 0) bits &= 0xfefefefefefefefeu;
  return bits;
}

/// A link that may lead to the brick at one side, with the offsets of its ends in their bricks.
struct Crossing {
  std::uint8_t direction;
  std::uint16_t own, other;
};
/// All crossings of each edge and corner: up to 22.
using CrossingsOfSides = std::array<std::vector<Crossing>, kDirections>;

CrossingsOfSides find_crossings() {
  CrossingsOfSides crossings;
  for (int direction = 0; direction < kDirections; ++direction) {
    const LinkStep step = step_of_direction(direction);
    for (int own = 0; own < kBrickVoxels; ++own) {
      const Vec3i end = brick_local(own) + Vec3i(step[0], step[1], step[2]);
      const int side = direction_of_step(end.x >> 3, end.y >> 3, end.z >> 3);
      if (!is_diagonal(side)) continue;
      crossings[std::size_t(side)].push_back(
          {std::uint8_t(direction), std::uint16_t(own), std::uint16_t(brick_offset(end))});
    }
  }
  return crossings;
}
const CrossingsOfSides kCrossings = find_crossings();

/// True where a level of one end lies above that of the other; else no cost need be looked up.
bool any_above(const std::int32_t* levels, const std::int32_t* others) {
  std::int32_t any = 0;
  for (int n = 0; n < kFaceVoxels; ++n) any |= levels[n] > others[n] ? -1 : 0;
  return any != 0;
}

/// Calls `visit(direction, shift, bits)` for links from the voxels of a face into the neighbour
/// across it, where the other end of voxel n is value n + shift of the neighbour's face.
template <class Visit>
void for_each_diagonal_across(const LinkMasks& links, int side, int face, Visit&& visit) {
  const int axis = axis_of_face(face);
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  for (int u = -1; u <= 1; ++u) {
    for (int v = -1; v <= 1; ++v) {
      const int direction = side + u * (direction_along(first, true) - kNoStep) +
                            v * (direction_along(second, true) - kNoStep);
      const std::uint64_t bits =
          face_bits(links[std::size_t(direction)], face) & steps_in_face(u, v);
      if (bits != 0) visit(direction, 8 * u + v, bits);
    }
  }
}

}  // namespace

DiagonalVisit::DiagonalVisit(const VisitContext& context, std::size_t brick)
    : m_body(context.body),
      m_costs(context.costs),
      m_values(context.task.values),
      m_direction(context.task.direction),
      m_brick(brick),
      m_neighbours(context.neighbours[brick]) {
  find_links(m_body.elements, m_body.cuts, m_costs.links(), m_neighbours, m_links);
  load_levels(offsets(brick), m_direction, m_levels);
}

/// Visits links across an edge or corner: `visit(direction, own, other)`, the offsets of both ends.
template <class Visit>
void DiagonalVisit::for_each_link_to(int side, Visit&& visit) const {
  for (const Crossing& link : kCrossings[std::size_t(side)]) {
    if (mask_test(m_links[link.direction], link.own)) visit(link.direction, link.own, link.other);
  }
}

void DiagonalVisit::draw(int side) {
  if (side == kSeeded) return;
  const auto other = std::size_t(m_neighbours[std::size_t(side)]);
  if (const int face = face_of_side(side); face >= 0) return draw_face(side, face, other);
  const std::int32_t* sent = offsets(other);
  for_each_link_to(side, [&](int direction, int own, int there) {
    const Level from = level_of(sent[there], m_direction);
    if (from <= m_levels[own]) return;
    const std::vector<Level>& costs = m_costs.along(opposite_direction(direction)).levels;
    const Level level = from - costs[entry_of(own, other, there)];
    m_levels[own] = Level(std::max(std::int32_t(level), std::int32_t(m_levels[own])));
  });
}

void DiagonalVisit::draw_face(int side, int face, std::size_t other) {
  alignas(64) std::int32_t own[kFaceVoxels];
  alignas(64) Level costs[kFaceVoxels];
  alignas(64) std::uint8_t own_classes[kFaceVoxels];
  HaloFace<std::int32_t> sent;
  HaloFace<std::uint8_t> other_classes;
  take_levels(other, face, sent.first());
  take_face(signed_levels(), face, own);
  take_face(classes(m_brick), face, own_classes);
  take_face(classes(other), opposite_face(face), other_classes.first());
  for_each_diagonal_across(m_links, side, face, [&](int direction, int shift, std::uint64_t bits) {
    const std::int32_t* from = sent.first() + shift;
    if (!any_above(from, own)) return;
    look_up_face_costs(m_costs.along(opposite_direction(direction)), m_costs.stride(), own_classes,
                       other_classes.first() + shift, bits, costs);
    for (int n = 0; n < kFaceVoxels; ++n) {
      own[n] = std::max(std::int32_t(Level(from[n]) - costs[n]), own[n]);
    }
  });
  put_face(own, face, reinterpret_cast<std::int32_t*>(m_levels));
}

/// Takes the levels of the face of a neighbour that lies across a face.
void DiagonalVisit::take_levels(std::size_t other, int face, std::int32_t* levels) const {
  take_face(offsets(other), opposite_face(face), levels);
  for (int n = 0; n < kFaceVoxels; ++n) levels[n] = std::int32_t(level_of(levels[n], m_direction));
}

void DiagonalVisit::close() {
  BrickCosts axes;
  DiagonalCosts diagonals;
  look_up_costs(m_costs, classes(m_brick), m_links, axes, diagonals);
  close_brick(axes, diagonals, m_levels);
}

unsigned DiagonalVisit::store(std::int32_t* q) const {
  const unsigned faces = store_levels(m_levels, m_direction, q);
  unsigned sides = 0;
  for (int side = 0; side < kDirections; ++side) {
    if (m_neighbours[std::size_t(side)] < 0) continue;
    const LinkStep step = step_of_direction(side);
    bool changed = true;
    for (int axis = 0; axis < 3; ++axis) {
      const int way = step[std::size_t(axis)];
      if (way != 0) changed &= (faces >> (2 * axis + (way > 0 ? 1 : 0)) & 1) != 0;
    }
    sides |= unsigned(changed) << side;
  }
  return sides;
}

Level DiagonalVisit::send(int side) const {
  if (side == kNoStep || m_neighbours[std::size_t(side)] < 0) return 0;
  const auto other = std::size_t(m_neighbours[std::size_t(side)]);
  if (const int face = face_of_side(side); face >= 0) return send_face(side, face, other);
  const std::int32_t* present = offsets(other);
  std::int32_t largest = 0;
  for_each_link_to(side, [&](int direction, int own, int there) {
    const auto now = std::int32_t(level_of(present[there], m_direction));
    if (std::int32_t(m_levels[own]) <= std::max(now, largest)) return;
    const std::vector<Level>& costs = m_costs.along(direction).levels;
    const Level cost = costs[entry_of(own, other, there)];
    const auto level = std::int32_t(m_levels[own] - cost);
    if (level > now) largest = std::max(largest, level);
  });
  return Level(largest);
}

Level DiagonalVisit::send_face(int side, int face, std::size_t other) const {
  alignas(64) std::int32_t own[kFaceVoxels];
  alignas(64) Level costs[kFaceVoxels];
  alignas(64) std::uint8_t own_classes[kFaceVoxels];
  HaloFace<std::int32_t> present;
  HaloFace<std::uint8_t> other_classes;
  take_face(signed_levels(), face, own);
  take_levels(other, face, present.first());
  take_face(classes(m_brick), face, own_classes);
  take_face(classes(other), opposite_face(face), other_classes.first());
  std::int32_t largest = 0;
  for_each_diagonal_across(m_links, side, face, [&](int direction, int shift, std::uint64_t bits) {
    const std::int32_t* there = present.first() + shift;
    if (!any_above(own, there)) return;
    look_up_face_costs(m_costs.along(direction), m_costs.stride(), own_classes,
                       other_classes.first() + shift, bits, costs);
    for (int n = 0; n < kFaceVoxels; ++n) {
      const std::int32_t level = std::int32_t(Level(own[n]) - costs[n]);
      largest = std::max(largest, level > there[n] ? level : 0);
    }
  });
  return Level(largest);
}

}  // namespace supple

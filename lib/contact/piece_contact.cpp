#include "lib/contact/piece_contact.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace supple {

namespace {

/// Places per voxel of the way, and the step between those that are looked at first.
constexpr int kPlaces = 256, kStride = 64;
/// Parts of a way along which its length is measured.
constexpr int kChords = 8;
/// Pieces that are turned against each other by this angle may overlap by kTurnedOverlap.
constexpr double kTurnedDegrees = 1;

/// An affine map of places in voxels.
struct Placing {
  std::array<Vec3d, 3> columns;
  Vec3d origin;

  Vec3d operator()(const Vec3d& x) const {
    return columns[0] * x.x + columns[1] * x.y + columns[2] * x.z + origin;
  }
};

Placing placing_of(const Geometry& geometry, const RigidPiece& piece, const RigidPose& pose) {
  Placing placing;
  placing.origin = piece.centre_index;
  for (int a = 0; a < 3; ++a) {
    Vec3d step(0.0);
    step[a] = 1;
    const Vec3d way = pose.turn.way_of(geometry.world_vector_from_index(step));
    placing.columns[std::size_t(a)] = step + geometry.index_vector_from_world(way);
    placing.origin[a] += double(pose.shift_q[std::size_t(a)]) / kFixedOne;
  }
  for (int a = 0; a < 3; ++a) {
    placing.origin -= placing.columns[std::size_t(a)] * piece.centre_index[a];
  }
  return placing;
}

/// Maps the rest of `piece` to that of `other`: by the pose of the one, then back by the pose of
/// the other. Turns that are alike cancel exactly.
Placing between_rests(const Body& body, const RigidPiece& piece, const RigidPose& pose,
                      const RigidPiece& other, const RigidPose& other_pose) {
  if (pose.turn == other_pose.turn) {
    // T(x - a) + a + s = T(y - b) + b + t, so y = x + T^-1 (a - b + s - t) - a + b.
    Vec3d shift = piece.centre_index - other.centre_index;
    for (int a = 0; a < 3; ++a) {
      const auto n = std::size_t(a);
      shift[a] += double(pose.shift_q[n] - other_pose.shift_q[n]) / kFixedOne;
    }
    const Vec3d apart = piece.centre_index - other.centre_index;
    const Vec3d back = pose.turn.turns()
                           ? body.geometry.index_vector_from_world(
                                 pose.turn.inverse()(body.geometry.world_vector_from_index(shift)))
                           : shift;
    return {{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}, back - apart};
  }
  // In the frame of `other` the piece has the turn that is left.
  RigidPiece seen = piece;
  seen.pose.turn = (other_pose.turn.inverse() * pose.turn).unit();
  const Geometry& geometry = body.geometry;
  Placing placing = placing_of(geometry, seen, {seen.pose.turn, {0, 0, 0}});
  Vec3d shift = piece.centre_index - other.centre_index;
  for (int a = 0; a < 3; ++a) {
    const auto n = std::size_t(a);
    shift[a] += double(pose.shift_q[n] - other_pose.shift_q[n]) / kFixedOne;
  }
  placing.origin += geometry.index_vector_from_world(
                        other_pose.turn.inverse()(geometry.world_vector_from_index(shift))) -
                    (piece.centre_index - other.centre_index);
  return placing;
}

/// The deepest overlap of a voxel at a place with voxels of a piece, at least `least`.
double overlap_at(const PieceShape& shape, const Vec3d& place, double least) {
  Vec3i base;
  std::array<double, 3> upper, lower;
  for (int a = 0; a < 3; ++a) {
    const double floor = std::floor(place[a]);
    base[a] = int(floor);
    upper[std::size_t(a)] = place[a] - floor;
    lower[std::size_t(a)] = 1 - upper[std::size_t(a)];
  }
  double deepest = least;
  for (int n = 0; n < 8; ++n) {
    const double overlap =
        std::min({(n & 1) != 0 ? upper[0] : lower[0], (n & 2) != 0 ? upper[1] : lower[1],
                  (n & 4) != 0 ? upper[2] : lower[2]});
    if (overlap > deepest && shape.contains(base + Vec3i(n & 1, n >> 1 & 1, n >> 2))) {
      deepest = overlap;
    }
  }
  return deepest;
}

}  // namespace

PieceShape::PieceShape(const BrickTopology& elements, std::shared_ptr<const SlotSet> piece)
    : m_piece(std::move(piece)) {
  Vec3i lo = voxel_of(elements, m_piece->first()), hi = lo;
  const auto for_each_voxel = [&](auto&& visit) {
    m_piece->for_each([&](Slot slot) { visit(voxel_of(elements, slot)); });
  };
  for_each_voxel([&](const Vec3i& voxel) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], voxel[a]);
      hi[a] = std::max(hi[a], voxel[a]);
    }
  });
  m_lo = lo;
  m_size = hi - lo + Vec3i(1);
  m_bits.assign((std::size_t(m_size.x) * m_size.y * m_size.z + 63) / 64, 0);
  for_each_voxel([&](const Vec3i& voxel) {
    const Vec3i at = voxel - m_lo;
    const std::size_t n = (std::size_t(at.z) * m_size.y + at.y) * m_size.x + at.x;
    m_bits[n >> 6] |= std::uint64_t(1) << (n & 63);
  });
  for_each_voxel([&](const Vec3i& voxel) {
    for (int a = 0; a < 3; ++a) {
      Vec3i step(0);
      step[a] = 1;
      if (contains(voxel + step) && contains(voxel - step)) continue;
      m_surface.push_back(voxel);
      return;
    }
  });
}

/// Two pieces on their way; the one with fewer voxels at its surface is seen from the other one.
class PieceContact::Pair {
 public:
  Pair(const Body& body, const PieceWay& way, std::size_t piece, const PieceShape& shape,
       std::size_t other, const PieceShape& other_shape)
      : m_body(body),
        m_way(way),
        m_piece(piece),
        m_other(other),
        m_shape(shape),
        m_other_shape(other_shape) {
    measure();
    if (m_length_voxels <= 0) return;
    choose();
    if (!m_near.empty() || !m_other_near.empty()) m_at_start = deepest(0).first;
  }

  bool may_meet() const { return !m_near.empty() || !m_other_near.empty(); }

  /// The meeting at the end of the way; none where these may lie there as they do.
  std::optional<PieceMeeting> meeting() {
    const auto [overlap, voxel] = deepest(1);
    if (overlap <= limit_at(1)) return std::nullopt;
    PieceStop stop;
    shorten(stop);
    return PieceMeeting{int(m_piece), int(m_other), voxel, overlap, stop.part};
  }

  /// Shortens `stop` to where these meet before; false where they do not. Places that were found
  /// free are not looked at again.
  bool shorten(PieceStop& stop) {
    const double voxels = stop.part * m_length_voxels;
    const auto last = std::int64_t(std::ceil(voxels * kPlaces));  // at `voxels`, at most
    std::int64_t free = std::min(m_free, last - 1), met = -1;
    for (std::int64_t at = free; at < last && met < 0;) {
      at = std::min((at / kStride + 1) * kStride, last);
      if (is_met(at, voxels)) {
        met = at;
      } else {
        free = at;
      }
    }
    m_free = std::max(m_free, free / kStride * kStride);
    if (met < 0) return false;
    while (met - free > 1) {
      const std::int64_t at = (free + met) / 2;
      (is_met(at, voxels) ? met : free) = at;
    }
    const double part = part_at(free, voxels);
    const Vec3i voxel = deepest(part_at(met, voxels)).second;
    const Vec3d way = seen_at(part)(Vec3d(voxel)) - seen_at(0)(Vec3d(voxel));
    stop = {part, int(m_piece), int(m_other), voxel,
            m_body.geometry.world_vector_from_index(way).length()};
    return true;
  }

 private:
  double part_at(std::int64_t place, double most_voxels) const {
    return std::min(double(place) / kPlaces, most_voxels) / m_length_voxels;
  }

  double limit_at(double part) const {
    const Turn turn = m_way(m_piece, part).turn * m_way(m_other, part).turn.inverse();
    const double turned = turn.turns() ? std::min(1.0, turn.angle_deg() / kTurnedDegrees) : 0;
    const double most = kShiftedOverlap + turned * (kTurnedOverlap - kShiftedOverlap);
    return std::max(most, m_at_start);
  }

  bool is_met(std::int64_t place, double most_voxels) const {
    const double part = part_at(place, most_voxels), limit = limit_at(part);
    return deepest(part, limit).first > limit;
  }

  Placing seen_at(double part) const {
    const auto& list = m_body.rigid.list;
    return between_rests(m_body, list[m_piece], m_way(m_piece, part), list[m_other],
                         m_way(m_other, part));
  }
  Placing seen_back_at(double part) const {
    const auto& list = m_body.rigid.list;
    return between_rests(m_body, list[m_other], m_way(m_other, part), list[m_piece],
                         m_way(m_piece, part));
  }

  /// Finds how far any corner of the piece goes, seen from the other one, and whether it turns.
  void measure() {
    const Vec3d lo(m_shape.lo()), hi(m_shape.hi());
    std::array<double, 8> lengths{};
    std::array<Vec3d, 8> before;
    for (int chord = 0; chord <= kChords; ++chord) {
      const double part = double(chord) / kChords;
      const Placing seen = seen_at(part);
      m_turns = m_turns || !(m_way(m_piece, part).turn == m_way(m_other, part).turn);
      for (std::size_t n = 0; n < 8; ++n) {
        const Vec3d corner((n & 1) != 0 ? hi.x : lo.x, (n & 2) != 0 ? hi.y : lo.y,
                           (n & 4) != 0 ? hi.z : lo.z);
        const Vec3d now = seen(corner);
        if (chord > 0) lengths[n] += (now - before[n]).length();
        before[n] = now;
      }
    }
    m_length_voxels = *std::max_element(lengths.begin(), lengths.end());
  }

  /// Chooses the voxels that may come near the other piece.
  void choose() {
    m_near = near(m_shape, seen_at(0), m_other_shape);
    if (m_turns) m_other_near = near(m_other_shape, seen_back_at(0), m_shape);
  }

  std::vector<Vec3i> near(const PieceShape& shape, const Placing& seen,
                          const PieceShape& other) const {
    // Voxels that meet the other piece come from within the way of the corners. Those of a turned
    // grid are longer in some directions than in others, at most twice in scans that are worth it.
    const Vec3d margin(2 + (m_turns ? 2 : 1) * m_length_voxels);
    const Vec3d lo = Vec3d(other.lo()) - margin, hi = Vec3d(other.hi()) + margin;
    std::vector<Vec3i> voxels;
    for (const Vec3i& voxel : shape.surface()) {
      const Vec3d at = seen(Vec3d(voxel));
      if (at.x < lo.x || at.y < lo.y || at.z < lo.z) continue;
      if (at.x > hi.x || at.y > hi.y || at.z > hi.z) continue;
      voxels.push_back(voxel);
    }
    return voxels;
  }

  /// The deepest overlap after a part of the way, beyond `enough` any, and its voxel of the piece.
  std::pair<double, Vec3i> deepest(double part, double enough = 1) const {
    std::pair<double, Vec3i> found{0, Vec3i(0)};
    const Placing seen = seen_at(part);
    for (const Vec3i& voxel : m_near) {
      const double overlap = overlap_at(m_other_shape, seen(Vec3d(voxel)), found.first);
      if (overlap <= found.first) continue;
      found = {overlap, voxel};
      if (overlap > enough) return found;
    }
    if (m_other_near.empty()) return found;
    const Placing back = seen_back_at(part);
    for (const Vec3i& voxel : m_other_near) {
      const Vec3d at = back(Vec3d(voxel));
      const double overlap = overlap_at(m_shape, at, found.first);
      if (overlap <= found.first) continue;
      found = {overlap,
               Vec3i(int(std::lround(at.x)), int(std::lround(at.y)), int(std::lround(at.z)))};
      if (overlap > enough) return found;
    }
    return found;
  }

  const Body& m_body;
  const PieceWay& m_way;
  std::size_t m_piece, m_other;
  const PieceShape& m_shape;
  const PieceShape& m_other_shape;
  bool m_turns = false;
  double m_length_voxels = 0, m_at_start = 0;
  std::vector<Vec3i> m_near, m_other_near;
  std::int64_t m_free = 0;  // places that have been looked at
};

const PieceShape& PieceContact::shape(const Body& body, std::size_t piece) {
  const std::shared_ptr<const SlotSet>& elements = body.rigid.list[piece].elements;
  std::unique_ptr<PieceShape>& shape = m_shapes[elements.get()];
  if (!shape) shape = std::make_unique<PieceShape>(body.elements, elements);
  return *shape;
}

/// The pairs of pieces that move against each other and may meet.
std::vector<PieceContact::Pair> PieceContact::pairs(const Body& body, const PieceWay& way) {
  const std::size_t count = body.rigid.list.size();
  std::vector<std::pair<RigidPose, RigidPose>> ends;
  for (std::size_t n = 0; n < count; ++n) ends.emplace_back(way(n, 0), way(n, 1));
  const auto moves = [&](std::size_t n) { return !(ends[n].first == ends[n].second); };
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (!moves(a) && !moves(b)) continue;
      const PieceShape &first = shape(body, a), &second = shape(body, b);
      const bool is_smaller = first.surface().size() < second.surface().size();
      Pair pair =
          is_smaller ? Pair(body, way, a, first, b, second) : Pair(body, way, b, second, a, first);
      if (pair.may_meet()) pairs.push_back(std::move(pair));
    }
  }
  return pairs;
}

PieceStop PieceContact::first_stop(const Body& body, const PieceWay& way) {
  std::vector<Pair> pairs = this->pairs(body, way);
  PieceStop stop;
  for (bool is_shortened = true; is_shortened;) {
    is_shortened = false;
    for (Pair& pair : pairs) is_shortened = pair.shorten(stop) || is_shortened;
  }
  return stop;
}

std::vector<PieceMeeting> PieceContact::meetings(const Body& body, const PieceWay& way) {
  std::vector<PieceMeeting> found;
  for (Pair& pair : pairs(body, way)) {
    if (const auto meeting = pair.meeting()) found.push_back(*meeting);
  }
  return found;
}

}  // namespace supple

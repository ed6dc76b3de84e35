// Rigid pieces: sets of elements that move as rigid bodies, such as the bones of a CT. Links inside
// a piece and between two pieces do not exist for the solvers. A piece keeps its shape by its pose,
// six numbers from which the offset of every element is rounded once. So thousands of moves do not
// bend it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/body/slot_set.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_values.h"

namespace supple {

/// A turn about a point and a shift, in LPS mm: x goes to about + turn (x - about) + shift.
struct RigidMotion {
  Turn turn;
  Vec3d about_lps_mm{0, 0, 0};
  Vec3d shift_lps_mm{0, 0, 0};

  bool turns() const { return turn.turns(); }
  Vec3d operator()(const Vec3d& place_lps_mm) const;
  /// The same turn by a part of its angle, and that part of the shift.
  RigidMotion part(double fraction) const;
};

/// Pose of a piece: it is turned about its centre at rest, then shifted along the grid in whole
/// units of q, so that shifts of the solver are kept exactly.
struct RigidPose {
  Turn turn;  // in LPS
  std::array<std::int64_t, 3> shift_q{0, 0, 0};

  bool operator==(const RigidPose& other) const {
    return turn == other.turn && shift_q == other.shift_q;
  }
};

struct RigidPiece {
  std::string name;
  std::shared_ptr<const SlotSet> elements;
  Vec3d centre_index{0, 0, 0};  // mean of its elements at rest
  RigidPose pose;
  /// Set while tissue has only shifted the piece: the pose before that, from which its smallest
  /// motion is to start (Step::shift_pieces).
  std::optional<RigidPose> shifted_from = {};

  const RigidPose& motion_starts_at() const { return shifted_from ? *shifted_from : pose; }
};

struct RigidPieces {
  std::vector<RigidPiece> list;
  /// 1 + the place in `list`, 0 at elements of none; null while there are no pieces.
  std::shared_ptr<const BrickValues> number_of;

  bool empty() const { return list.empty(); }
  /// Place in `list`, or -1.
  int at(Slot slot) const { return number_of ? number_of->at(slot) - 1 : -1; }
};

/// Offset q of a voxel of the piece by its pose. May lie beyond the range of offsets.
class PoseOffsets {
 public:
  PoseOffsets(const Geometry& geometry, const RigidPiece& piece);
  std::array<std::int64_t, 3> operator()(const Vec3i& voxel) const;

 private:
  Vec3d m_centre;
  std::array<Vec3d, 3> m_columns;  // of the turn without the identity, index to index
  std::array<std::int64_t, 3> m_shift;
};

/// The pose that a motion takes the piece to; its shift is rounded to the unit of q.
RigidPose moved_by(const RigidMotion& motion, const RigidPiece& piece, const Geometry& geometry);

/// The rigid motion that brings points nearest to their targets, by the sum of squares (Horn, J.
/// Opt. Soc. Am. A 4, 629-642, 1987); where the points leave a turn open (fewer than three, or on
/// a line) the smallest one.
class RigidFit {
 public:
  void add(const Vec3d& from_lps_mm, const Vec3d& to_lps_mm);
  /// The best motion for the points added so far, of which there must be one at least.
  RigidMotion motion() const;

 private:
  // Relative to the first point of each, so that sums of squares keep their digits.
  Vec3d m_first_from{0, 0, 0}, m_first_to{0, 0, 0}, m_sum_from{0, 0, 0}, m_sum_to{0, 0, 0};
  double m_products[3][3] = {};  // sums of from[a] to[b]
  double m_square = 0;           // of the lengths of from
  std::size_t m_count = 0;
};

}  // namespace supple

// Rigid pieces that meet on their way: bones do not pass through each other.
//
// Each piece is its voxels at rest, a bit each. A voxel of one piece, at the piece's pose and then
// taken back by the pose of another one, lies d from a voxel of the other at rest: as cubes they
// overlap by 1 - max |d_a| voxels, if that is positive. Where pieces have not turned against each
// other this is exact. The deepest overlap of the voxels at a piece's surface is looked at every
// quarter of a voxel of the way, and the first place where it is too deep is found to 1/256 voxel.
// These places are counted in voxels from the start of the way, so that a longer way that begins
// alike ends no earlier. Cost: about 10 ns per surface voxel of the smaller piece within the box of
// the larger one, and place.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "lib/body/body.h"

namespace supple {

/// Pieces may lie in each other by this much more than before, in voxels: unturned ones, and those
/// that are turned against each other by a degree or more, whose voxels no longer fit.
constexpr double kShiftedOverlap = 0.1, kTurnedOverlap = 0.5;

/// The pose of a piece (in Body::rigid) after a part of the way, 0 to 1.
using PieceWay = std::function<RigidPose(std::size_t piece, double part)>;

/// The end of a way.
struct PieceStop {
  double part = 1;  // of the way, that pieces leave free
  /// Pieces that meet there, in Body::rigid, and the voxel of `piece` at rest which lies deepest in
  /// `other`; -1: none does.
  int piece = -1, other = -1;
  Vec3i voxel{0, 0, 0};
  double way_mm = 0;  // of that voxel before the other piece
};

/// Two pieces that lie deeper in each other at the end of a way than they may.
struct PieceMeeting {
  int piece = -1, other = -1;  // in Body::rigid
  Vec3i voxel{0, 0, 0};        // of `piece` at rest, which lies deepest in `other`
  double overlap_voxels = 0;
  double part = 0;  // of the way, that these two leave each other
};

/// The voxels of a piece at rest.
class PieceShape {
 public:
  PieceShape(const BrickTopology& elements, std::shared_ptr<const SlotSet> piece);

  bool contains(const Vec3i& voxel) const {
    const Vec3i at = voxel - m_lo;
    if (std::uint32_t(at.x) >= std::uint32_t(m_size.x) ||
        std::uint32_t(at.y) >= std::uint32_t(m_size.y) ||
        std::uint32_t(at.z) >= std::uint32_t(m_size.z)) {
      return false;
    }
    const std::size_t n = (std::size_t(at.z) * m_size.y + at.y) * m_size.x + at.x;
    return (m_bits[n >> 6] >> (n & 63) & 1) != 0;
  }
  /// Voxels with a face towards something else.
  const std::vector<Vec3i>& surface() const { return m_surface; }
  const Vec3i& lo() const { return m_lo; }
  Vec3i hi() const { return m_lo + m_size - Vec3i(1); }

 private:
  std::shared_ptr<const SlotSet> m_piece;  // kept, so that its address stays its own
  Vec3i m_lo{0, 0, 0}, m_size{0, 0, 0};
  std::vector<std::uint64_t> m_bits;
  std::vector<Vec3i> m_surface;
};

class PieceContact {
 public:
  /// The largest part of a way from the present poses that no two pieces stop. Overlap that there
  /// is at its start stops nothing as long as it does not grow; beyond a voxel it cannot.
  PieceStop first_stop(const Body& body, const PieceWay& way);

  /// The pairs of pieces that the end of a way leaves too deep in each other.
  std::vector<PieceMeeting> meetings(const Body& body, const PieceWay& way);

 private:
  class Pair;
  std::vector<Pair> pairs(const Body& body, const PieceWay& way);
  const PieceShape& shape(const Body& body, std::size_t piece);

  std::map<const SlotSet*, std::unique_ptr<PieceShape>> m_shapes;
};

}  // namespace supple

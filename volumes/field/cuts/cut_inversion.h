// Which bricks of the output a cut splits, what reaches them, and how their offsets join those of
// the rest. All of it follows torn cells, faces and displacements brick by brick: a split brick is
// made anew where cells that reach it are others than before.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <unordered_map>

#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/cuts/moved_bricks.h"

namespace supple {

/// Rounding of what a piece reaches, in voxels.
constexpr double kReachSlack = 1e-3;

/// A box of places, in voxels.
struct CutBox {
  Vec3d lo{HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

  bool empty() const { return lo.x > hi.x; }
  void add(const Vec3d& p) {
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], p[a]);
      hi[a] = std::max(hi[a], p[a]);
    }
  }
  void add(const CutBox& other) {
    if (other.empty()) return;
    add(other.lo);
    add(other.hi);
  }
  /// The box in steps of bricks.
  IndexBox bricks() const {
    IndexBox box;
    if (empty()) return box;
    for (int a = 0; a < 3; ++a) {
      box.lo[a] = int(std::floor(lo[a])) >> 3;
      box.hi[a] = int(std::floor(hi[a])) >> 3;
    }
    return box;
  }
};

inline CutBox box_of(const CutPiece& piece, double margin) {
  CutBox box;
  box.add(Vec3d(piece.cell) + Vec3d(piece.lo) - Vec3d(margin));
  box.add(Vec3d(piece.cell) + Vec3d(piece.hi) + Vec3d(margin));
  return box;
}

class CutInversion {
 public:
  /// Nothing moves. `cells`: the bricks of the displacement, which outlive the inversion.
  CutInversion(const BrickTopology& cells, const BrickTopology& elements, const Vec3i& dims);

  /// Bricks of cells in which something is other than before. Before the first time, and only then,
  /// nothing is known of a displacement.
  struct Changes {
    const DisplacedBricks& u;
    BrickList torn, faces;
  };
  void follow(const VectorBricks& u, const TornCells& torn, const CutFaces& faces,
              const Changes& changes);

  /// The voxels of u without the corners of torn cells: those that a lattice of offsets can hold.
  const BrickTopology& whole() const { return m_whole; }
  /// Bricks in which the last follow() has changed them.
  const BrickList& whole_changed() const { return m_whole_changed; }

  /// Makes the split bricks, after follow(). `lattice`: the offsets of what is whole, which have
  /// changed in the bricks at `touched`. Returns, sorted, the origins of all bricks that read other
  /// offsets or faces than before.
  std::vector<Vec3i> split(const VectorBricks& u, const TornCells& torn, const CutFaces& faces,
                           const VectorBrickFinder& lattice, const std::vector<Vec3i>& touched,
                           Progress* progress);
  /// The split brick with this origin, or null.
  const SplitBrick* find(const Vec3i& origin) const {
    const auto found = m_split.find(origin);
    return found == m_split.end() ? nullptr : found->second.brick.get();
  }
  /// The split bricks, sorted by origin.
  const std::vector<std::shared_ptr<const SplitBrick>>& bricks() const { return m_bricks; }
  /// Bricks that split() has gathered since it was made.
  std::int64_t gathered() const { return m_gathered; }

  /// The offsets of split bricks at their nodes in place of those of `lattice`.
  VectorBricks joined(const VectorBricks& lattice) const;
  /// Voxels at which tissue from several places lies: in split bricks theirs replace the lattice's.
  BrickTopology overlaps(const BrickTopology& lattice) const;
  /// Adds the counts of what whole() lacks.
  void count(const TornCells& torn, InversionCertificate& certificate) const;

 private:
  struct Counts {
    std::int64_t cells = 0, folded_cells = 0, folded_air_cells = 0;
    double min_det = HUGE_VAL;
  };
  /// A source brick beside torn cells.
  struct Source {
    std::vector<CutPiece> sides;  // of its torn cells
    IndexBox sides_reach;         // bricks
    BrickMask corners{};          // voxels that are corners of torn cells
    std::vector<Vec3i> near;      // bricks that are split in any case, sorted
    Counts counts;                // of its whole cells that share such corners
  };

  Source* source(std::size_t b) const { return m_sources[b].get(); }
  Source& touch(std::size_t b);
  void follow_moves(const VectorBricks& u, const DisplacedBricks& changed);
  void widen_at_border(const Vec3i& origin, CutBox& moves) const;
  void make_sides(const VectorBricks& u, const TornCells& torn, const CutFaces& faces,
                  const BrickList& torn_changed, const BrickList& faces_changed);
  BrickList find_corners(const TornCells& torn, const BrickList& changed);
  void replace_whole(const BrickList& bricks);
  void find_near(const VectorBricks& u, const TornCells& torn, const BrickList& bricks);
  void reach_moved(const VectorBricks& u, const DisplacedBricks& moved, const BrickList& beside,
                   const std::vector<IndexBox>& reach_before);
  void reach_sides(const VectorBricks& u, const std::vector<CutPiece>& before,
                   const std::vector<CutPiece>& now);
  void reach_stale(const IndexBox& box);
  void reach_faces(const IndexBox& box);

  bool corners_of(const VectorBricks& u, const Vec3i& cell, std::array<Vec3f, 8>& moves) const;
  CutPiece whole_piece(const Vec3i& cell, const std::array<Vec3f, 8>& moves) const;
  std::uint8_t elements_of(const Vec3i& cell) const;
  void add_pieces(const VectorBricks& u, const TornCells& torn, std::size_t source,
                  const SplitBrick* before, CutBrick& brick) const;
  /// A brick that is to be gathered, and what it was before, or null.
  struct Stale {
    Vec3i origin;
    const SplitBrick* before;
  };
  std::vector<std::shared_ptr<SplitBrick>> gather(const VectorBricks& u, const TornCells& torn,
                                                  const std::vector<Stale>& stale) const;
  std::vector<Vec3i> gather_all(const VectorBricks& u, const TornCells& torn, Progress* progress);

  struct Split {
    std::shared_ptr<SplitBrick> brick;
    bool is_stale = false;  // what reaches it may be other
    bool knows_other_faces = false;
  };

  const BrickTopology& m_cells;
  BrickTopology m_elements;  // with the copies of a slice
  Vec3i m_dims;
  std::vector<CutBox> m_moves;         // displacements of the voxels of every brick
  std::vector<CutBox> m_corner_moves;  // and of its cells, with what they go on beyond the border
  std::vector<IndexBox> m_reach;       // bricks that the cells of every brick may reach
  std::vector<std::unique_ptr<Source>> m_sources;
  BrickTopology m_whole;
  BrickList m_whole_changed;
  std::unordered_map<Vec3i, int, VoxelHash> m_near;  // sources that have a brick near
  std::unordered_map<Vec3i, Split, VoxelHash> m_split;
  std::vector<std::shared_ptr<const SplitBrick>> m_bricks;
  std::int64_t m_gathered = 0;
};

}  // namespace supple

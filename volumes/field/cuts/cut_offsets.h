// Offsets of a body that was cut and whose cut has opened (thesis section 3.3.5: discontinuous
// paths; here the discontinuity comes from the model).
//
// Nothing is interpolated across a cut. Each side of a cut cell carries its displacement on, as far
// as the cut face, which lies in the middle of the cut links (cut_faces.h), and no further. What is
// not reached by any side is empty. In split bricks samples are inverted one by one from the source
// cells that reach them; a renderer need not, in the cells of such bricks that only one side
// reaches (interpolated()). Everywhere else offsets are those of invert(). Cost: 260 kB per split
// brick (those within three voxels of a face, and those where sides overlap); cut_brick.h says what
// a sample in one costs.
#pragma once

#include <array>
#include <bitset>
#include <memory>
#include <vector>

#include "volumes/field/cuts/cut_brick.h"
#include "volumes/field/cuts/cut_faces.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/offset_field.h"
#include "volumes/field/split_offsets.h"

namespace supple {

// The nodes of a lattice above a brick that are corners of its cells, as they were read last.

class UpperNodes {
 public:
  bool are_known() const { return m_are_known; }
  /// Reads the nodes above the brick at `origin`; returns the cells with another one than before.
  BrickMask follow(const VectorBrickFinder& lattice, const Vec3i& origin);

 private:
  static constexpr int kCount = 9 * 9 * 9 - kBrickVoxels;

  std::array<Vec3f, kCount> m_vectors;
  std::bitset<kCount> m_valid;
  bool m_are_known = false;
};

/// Sides that are nowhere further apart than this, in voxels, count as one.
constexpr double kClosedCut = 1.0 / 16;

/// Elements and the links between them that are cut, bricks as in `elements`. Both must outlive it.
struct CutElements {
  const BrickTopology& elements;
  const LinkCuts& cuts;
};

/// u on elements extended over `target` (elements and shell) as extend() does, but from either side
/// of a cut on its own.
Displacement extend_past_cuts(Displacement displacement, const BrickTopology& target,
                              const CutElements& body);

/// invert() for a body with cuts: `split` is set where they have opened. Without an open cut all is
/// what invert() gives. The certificate counts the cells that were torn open, whose folds are not
/// counted. Where sides overlap that wins which does in invert(). Throws as invert() does.
OffsetField invert_cut(const Displacement& displacement, const CutElements& body,
                       const InvertParams& params = {}, Progress* progress = nullptr);

/// True if a cut of the body has opened, so that the displacement jumps.
bool has_open_cut(const Displacement& displacement, const CutElements& body);

class CutInversion;
class CutOffsets;

/// An inversion that follows a body through local changes, such as drags and cuts: extension,
/// inversion and split bricks are made anew only where the changes reach. field() has the bits that
/// extend_past_cuts() and invert_cut() would give it. Memory: as IncrementalInversion; with cuts
/// the displacement a second time and 260 kB per split brick.
class IncrementalCutInversion {
 public:
  /// Inverts everything. `displacement`: extended as if nothing were cut (extend()). Throws as
  /// IncrementalInversion. The elements outlive the inversion; cuts are taken over.
  IncrementalCutInversion(const Displacement& displacement, const CutElements& body,
                          const InvertParams& params = {}, Progress* progress = nullptr);
  ~IncrementalCutInversion();

  /// Sets the cuts from the next update on.
  void set_cuts(const LinkCuts& cuts);
  /// `displacement` has the voxels of the last one; `changed` lists the bricks of its topology
  /// whose vectors may differ, ascending. Returns, sorted, the origins of the bricks of offsets
  /// that may read others than before, or see other faces.
  std::vector<Vec3i> update(const Displacement& displacement,
                            const std::vector<std::int32_t>& changed);

  /// The offsets on their lattice as they lie here, until the next update.
  VectorBrickFinder finder() const;
  /// The bricks in which offsets jump; null: none. The same object changes with the next update.
  std::shared_ptr<const SplitOffsets> split() const;
  /// All offsets, copied, without a certificate; `split` is valid until the next update.
  OffsetField offsets() const;
  /// offsets() with the certificate; `displacement`: of the last update.
  OffsetField field(const Displacement& displacement) const;

  /// Counts of the bricks that the last update made anew.
  struct Work {
    std::int64_t extended_bricks = 0;  // of displacement in the air beside cuts
    std::int64_t split_bricks = 0;     // of the output
    std::int64_t inverted_bricks = 0;  // of the output
  };
  const Work& work() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// A brick of the output that a cut splits.
struct SplitBrick {
  explicit SplitBrick(const Vec3i& origin) : cut(origin) {}

  /// Finds, after the last piece was added, offsets at nodes, and where tissue overlaps; takes over
  /// what it can from the brick as it was `before`, or null.
  void solve(const SplitBrick* before, const Vec3i& dims);
  /// Finds the faces beside its pieces, of which some may be `known`.
  void look_beside(const CutFaces& faces, bool known);
  VectorBrickView nodes() const {
    return mask_count(valid) == 0 ? VectorBrickView() : VectorBrickView{&valid, offsets.data()};
  }

  /// The surroundings of a piece: the points of faces, or, of a whole cell in which a cut ends,
  /// torn cells.
  struct Beside {
    const CutFaces::Points* seen;  // null: none
    std::uint8_t torn;
  };

  CutBrick cut;
  BrickMask valid{}, overlaps{};
  std::array<Vec3f, kBrickVoxels> offsets;
  std::vector<Beside> beside;  // of every piece
  BrickMask unsettled{};       // cells of which it must be found anew whether they are interpolated
  UpperNodes above;            // as its cells have read them
  std::vector<bool> is_beside_known;
};

class CutOffsets : public SplitOffsets {
 public:
  /// Starts without bricks and faces.
  CutOffsets(const BrickTopology& cells, const Geometry& geometry);

  /// The faces, whose places a follower of the body changes.
  CutFaces& faces() { return m_faces; }
  /// `bricks`: sorted by origin.
  void set_bricks(const std::vector<std::shared_ptr<const SplitBrick>>& bricks);

  bool sample(std::size_t b, const Vec3d& x, Sample& found) const override;
  bool offset_of(int piece, const Vec3d& x, Vec3d& offset) const override;
  bool place_at(const Vec3d& x, Vec3d& place, bool& is_ambiguous) const override;
  double depth_mm(int piece, const Vec3d& x) const override;
  Vec3d face_normal(int piece, const Vec3d& x) const override;
  Vec3d pull_back(int piece, const Vec3d& x, const Vec3d& y, const Vec3d& gradient) const override;
  bool face(int piece, const Vec3d& x, const Vec3d& y, Vec3d& normal,
            double& depth_mm) const override;
  bool face_in_source(int piece, const Vec3d& y, Vec3d& normal, double& depth_mm) const override;
  const BrickMask* interpolated(std::size_t b) const override {
    return &m_bricks[b]->cut.interpolated();
  }
  void source_box(std::size_t b, Vec3d& lo, Vec3d& hi) const override;

 protected:
  bool offset_beside(int piece, const Vec3d& place, Vec3d& offset) const override;

 private:
  struct PieceOfBrick {
    const CutPiece& piece;
    const PieceMap& map;
    const SplitBrick::Beside& beside;
  };
  PieceOfBrick piece_at(int piece) const;
  static Vec3d pulled_back(const PieceOfBrick& of, const Vec3d& y, const Vec3d& gradient);

  std::vector<std::shared_ptr<const SplitBrick>> m_bricks;
  std::vector<int> m_first_piece;        // of every brick
  std::vector<std::int32_t> m_brick_of;  // of every kPieces pieces, which are of one brick
  CutFaces m_faces;
  Vec3i m_dims;
};

}  // namespace supple

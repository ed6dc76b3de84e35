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

#include "volumes/field/cuts/cut_brick.h"
#include "volumes/field/cuts/cut_faces.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/field/split_offsets.h"

namespace supple {

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

/// An inversion that follows a cut body through local changes, such as drags: what is whole is
/// solved again only where the changes reach (IncrementalInversion), what cuts have torn is made
/// anew. field() has the bits that extend_past_cuts() and invert_cut() would give it. Where cuts
/// open or close the bricks around them count as changed. Memory: as IncrementalInversion, the
/// displacement and the field.
class IncrementalCutInversion {
 public:
  /// Inverts everything. `displacement`: extended as if nothing were cut (extend()). Throws as
  /// invert_cut(). The cuts may grow between updates.
  IncrementalCutInversion(const Displacement& displacement, const CutElements& body,
                          const InvertParams& params = {}, Progress* progress = nullptr);
  ~IncrementalCutInversion();

  /// `displacement` has the voxels of the last one. A volume of one slice is inverted as a whole.
  void update(const Displacement& displacement, Progress* progress = nullptr);

  /// Valid until the next update.
  const OffsetField& field() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

class CutOffsets : public SplitOffsets {
 public:
  /// `bricks`: sorted by origin.
  CutOffsets(std::vector<CutBrick> bricks, CutFaces faces, const Vec3i& dims);

  bool sample(std::size_t b, const Vec3d& x, Sample& found) const override;
  bool offset_of(int piece, const Vec3d& x, Vec3d& offset) const override;
  bool is_overlapped(const Vec3d& x) const override;
  double depth_mm(int piece, const Vec3d& x) const override;
  Vec3d face_normal(int piece, const Vec3d& x) const override;
  Vec3d pull_back(int piece, const Vec3d& x, const Vec3d& y, const Vec3d& gradient) const override;
  bool face(int piece, const Vec3d& x, const Vec3d& y, Vec3d& normal,
            double& depth_mm) const override;
  bool face_in_source(int piece, const Vec3d& y, Vec3d& normal, double& depth_mm) const override;
  const BrickMask* interpolated(std::size_t b) const override { return &m_cells[b].interpolated(); }
  void source_box(std::size_t b, Vec3d& lo, Vec3d& hi) const override;

 protected:
  bool offset_beside(int piece, const Vec3d& place, Vec3d& offset) const override;

 private:
  struct PieceOfBrick {
    const CutPiece& piece;
    const PieceMap& map;
  };
  PieceOfBrick piece_at(int piece) const;
  /// What a piece has beside it: the points of faces, or, of a whole cell in which a cut ends, torn
  /// cells.
  struct Beside {
    const CutFaces::Points* seen;  // null: none
    std::uint8_t torn;
  };
  Beside beside(const CutPiece& piece) const;
  static Vec3d pulled_back(const PieceOfBrick& of, const Vec3d& y, const Vec3d& gradient);

  std::vector<CutBrick> m_cells;
  std::vector<int> m_first_piece;        // of every brick
  std::vector<std::int32_t> m_brick_of;  // of every piece
  CutFaces m_faces;
  std::vector<Beside> m_beside;  // every piece
  Vec3i m_dims;
};

}  // namespace supple

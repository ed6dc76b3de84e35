// The displacement of a body, and the offset field, its inverse: the only handshake between
// solvers, renderer and exports (design.md section 4). Cost of extending a displacement into the
// air around the elements: about 100 ns per new voxel and core.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "volumes/base/value.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_values.h"

namespace supple {

class SplitOffsets;

/// A sparse vector field on voxels: one Vec3f per voxel of every occupied brick, valid where the
/// topology is active. Bricks without a vector other than 0, where nothing moves, are not stored.
/// Cost: 6 kB per stored brick, 108 bytes for any other.
struct VectorBricks {
  BrickTopology topology;  // active: the vector is valid
  BrickVectors vectors;    // of its bricks

  /// True and the vector, or false where invalid.
  bool at(const Vec3i& voxel, Vec3f& vector) const;
  /// Trilinear; false when any of the corners with a weight above 0 is invalid. At a voxel centre
  /// the vector of that voxel, exactly.
  bool sample(const Vec3d& pos_index, Vec3d& vector) const;
  std::size_t bytes() const;
};

/// One brick of a sparse vector field; null where there is none.
struct VectorBrickView {
  const BrickMask* mask = nullptr;
  const Vec3f* vectors = nullptr;  // 512, those of kZeroBrickOf where none are stored
};

/// The brick with this origin, wherever it is kept. May be asked by several threads at once.
using VectorBrickFinder = std::function<VectorBrickView(const Vec3i& origin)>;

/// A finder of the bricks of a field that outlives it.
VectorBrickFinder finder_of(const VectorBricks& field);

/// Material direction (push): voxel X is now at X + u(X). Index frame of the source, unit voxel.
struct Displacement {
  Geometry geometry;  // of the source volume
  VectorBricks u;     // valid on elements, and on shell rings once extended
};

/// Extends u from its valid voxels onto the active voxels of `target` ring by ring: each new voxel
/// takes the mean of its valid 26-neighbours of the ring before. Voxels of `target` that no ring
/// reaches stay invalid. Without it u = 0 in the air tears the surface (SSIM 0.89 against 0.9988).
Displacement extend(Displacement displacement, const BrickTopology& target);

/// Worst cases of an inversion; see design.md section 4.
struct InversionCertificate {
  double residual_max = 0;        // max |x + o + u(x + o) - x| in voxels over valid nodes off folds
  double residual_p999 = 0;       // its 99.9th percentile
  std::int64_t cells = 0;         // source cells with eight valid corners
  std::int64_t folded_cells = 0;  // cells with det F <= 0 somewhere
  std::int64_t folded_air_cells = 0;   // of them, those with a corner outside the material
  std::int64_t unresolved_voxels = 0;  // covered by a deformed cell's tetrahedra, yet no solution
  std::vector<Vec3i> unresolved;       // at most 1000 of them
  double min_det = 1;           // smallest det F = det(I + grad u) at a corner of a cell of tissue
  std::int64_t torn_cells = 0;  // cells that a cut has opened (cut_offsets.h)
  std::int64_t overlapped_voxels = 0;  // voxels that tissue from several places covers
  std::int64_t hidden_elements = -1;  // elements that are not seen where they went; -1: not counted
  bool of_part = false;               // only some offsets were wanted, and all counts are of these
};

/// Without the list of unresolved voxels.
Value to_value(const InversionCertificate& certificate);

/// Resample direction (pull): what is now at x came from x + o(x). Index frame of the source
/// volume, unit voxel; x may lie outside the source box.
struct OffsetField {
  Geometry geometry;  // of the source volume
  VectorBricks o;     // valid where deformed material (elements, extended shell) is now
  InversionCertificate certificate;
  /// Bricks in which offsets jump, so that they may not be interpolated (split_offsets.h). Null:
  /// none.
  std::shared_ptr<const SplitOffsets> split = nullptr;
  /// Voxels that tissue from several places covers; `o` holds the shortest offset there.
  BrickTopology overlaps = {};

  /// The offset at any position: that of its piece in split bricks, else trilinear as
  /// VectorBricks::sample. False where nothing is.
  bool sample(const Vec3d& pos_index, Vec3d& offset) const;

  /// The place of the source that is read at x, for every reader alike: x + o(x), or the border
  /// voxel up to half a voxel beyond it (within_border). False where nothing is, and farther out.
  bool source_of(const Vec3d& x, Vec3d& source) const;
};

enum class WarpDirection { resample, material };

/// Contents of a dense export where there is no material (design.md section 2 "The air").
enum class VoidMode {
  nearest,  // stays void: o = 0; vacated: the nearest void voxel of the source
  outside,  // void everywhere reads from outside the source box
  extend    // the offsets of the material carry on smoothly, without folds, constant far away
};

/// Offsets that each sample finds for itself, in bricks in which nothing on a lattice could be
/// interpolated: where they jump (split_offsets.h), or before an inverse exists
/// (forward_offsets.h).
class PointwiseOffsets {
 public:
  struct Sample {
    Vec3d offset{0, 0, 0};
    int piece = -1;  // where the sample was found; -1: nowhere
  };

  virtual ~PointwiseOffsets() = default;

  /// The bricks, all of their voxels active.
  const BrickTopology& bricks() const { return m_bricks; }

  /// Offset and piece at x, in index space, inside the cells of brick b. False in a gap and in the
  /// void. `found` may hold a sample found nearby, to begin with.
  virtual bool sample(std::size_t b, const Vec3d& x, Sample& found) const = 0;
  /// Box in index space around all that samples of brick b can read; lo > hi: nothing.
  virtual void source_box(std::size_t b, Vec3d& lo, Vec3d& hi) const = 0;
  /// Cells of brick b in which offsets may as well be interpolated between nodes of the lattice, as
  /// in all other bricks. Null: none.
  virtual const BrickMask* interpolated(std::size_t /*b*/) const { return nullptr; }
  /// (I + grad o)^T g of a sample found at x in this piece, which reads the source at y.
  virtual Vec3d pull_back(int piece, const Vec3d& x, const Vec3d& y,
                          const Vec3d& gradient) const = 0;
  /// The same with differences over half a voxel to both sides, on the piece's side of all jumps:
  /// derivatives that do not jump where pieces meet, for six more samples.
  Vec3d pull_back_smoothly(int piece, const Vec3d& x, const Vec3d& y, const Vec3d& gradient) const;
  /// The face behind which a sample found at x in this piece lies, which reads the source at y: its
  /// normal, into the piece, in mm per voxel, and the distance to it in mm, as in the body before
  /// it was split. False: none is known.
  virtual bool face(int piece, const Vec3d& x, const Vec3d& y, Vec3d& normal,
                    double& depth_mm) const;

  /// The same with the normal of the face in the source, in mm per voxel, where it is known there;
  /// piece -1: of a sample in a cell that is interpolated.
  virtual bool face_in_source(int piece, const Vec3d& y, Vec3d& normal, double& depth_mm) const;

 protected:
  /// The offset at a place within a voxel of a piece, on its side of all jumps. False: none.
  virtual bool offset_beside(int piece, const Vec3d& place, Vec3d& offset) const;
  /// All voxels of the bricks at these sorted origins.
  void set_bricks(std::vector<Vec3i> origins);

 private:
  BrickTopology m_bricks;
};

}  // namespace supple

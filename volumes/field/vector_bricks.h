// A sparse vector field on voxels: one Vec3f per voxel of every occupied brick, valid where the
// topology is active. Cost: 6 kB per brick.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

struct VectorBricks {
  BrickTopology topology;      // active: the vector is valid
  std::vector<Vec3f> vectors;  // [512 * b + offset]

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
  const Vec3f* vectors = nullptr;  // 512
};

/// The brick with this origin, wherever it is kept. May be asked by several threads at once.
using VectorBrickFinder = std::function<VectorBrickView(const Vec3i& origin)>;

/// Those of a field that outlives the finder.
VectorBrickFinder finder_of(const VectorBricks& field);

/// Material direction (push): voxel X is now at X + u(X). Index frame of the source, unit voxel.
struct Displacement {
  Geometry geometry;  // of the source volume
  VectorBricks u;     // valid on elements, and on shell rings once extended
};

/// Worst cases of an inversion; see design.md section 4.
struct InversionCertificate {
  double residual_max = 0;        // max |x + o + u(x + o) - x| in voxels over valid nodes off folds
  double residual_p999 = 0;       // its 99.9th percentile
  std::int64_t cells = 0;         // source cells with eight valid corners
  std::int64_t folded_cells = 0;  // cells with det F <= 0 at some corner
  std::int64_t folded_air_cells = 0;   // of them, those with a corner outside the material
  std::int64_t unresolved_voxels = 0;  // covered by a deformed cell's tetrahedra, yet no solution
  std::vector<Vec3i> unresolved;       // at most 1000 of them
  double min_det = 1;                  // smallest det F = det(I + grad u) over cell corners
  std::int64_t torn_cells = 0;         // cells that a cut has opened (cut_offsets.h)
  std::int64_t overlapped_voxels = 0;  // around cuts: voxels that tissue from several places covers
};

class SplitOffsets;

/// Resample direction (pull): what is now at x came from x + o(x). Index frame of the source
/// volume, unit voxel; x may lie outside the source box.
struct OffsetField {
  Geometry geometry;  // of the source volume
  VectorBricks o;     // valid where deformed material (elements, extended shell) is now
  InversionCertificate certificate;
  /// Where offsets jump: bricks in which they may not be interpolated (split_offsets.h). Null:
  /// nowhere.
  std::shared_ptr<const SplitOffsets> split = nullptr;

  /// The offset at any position: that of its piece in split bricks, else trilinear as
  /// VectorBricks::sample. False where nothing is.
  bool sample(const Vec3d& pos_index, Vec3d& offset) const;
};

}  // namespace supple

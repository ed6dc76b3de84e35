// Inversion of a displacement to an offset field: x + o(x) + u(x + o(x)) = x.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/field/offset_field.h"

namespace supple {

struct InvertParams {
  double residual_tolerance_voxels = 1e-4;  // Newton stops at a hundredth of it
  int max_newton_steps = 20;
  /// The elements: tissue, which hides the air that u carries along around it, and whose folds and
  /// overlaps are counted apart from those of air; null: everything is tissue.
  const BrickTopology* material = nullptr;
  /// True if offsets are wanted in the output brick whose smallest voxel this is; null: in all.
  /// Unwanted bricks that moving ones reach hold none, and the certificate leaves out source bricks
  /// that reach no wanted one. From any thread; for invert() alone.
  std::function<bool(const Vec3i& origin)> wants;
};

/// Inverts the extended displacement; u is trilinear on the cells whose eight corners are valid.
/// Deterministic and independent of the thread count. Where deformed cells overlap, one whose eight
/// corners are elements wins, then one in which the nearest voxel is, then air; among equals the
/// smallest |o| wins (then the lower source voxel), and nodes that tissue covers more than once are
/// listed in `overlaps`. Where u = 0 at all corners, o = 0 exactly. Nodes of occupied output bricks
/// that no material reaches stay invalid (the marcher extrapolates for itself).
///
/// A field without a complete cell (a single voxel, a sheet one voxel thick) gives no offsets until
/// it is extended; `certificate.cells` says so. A volume of one slice is inverted in its plane.
/// `certificate.unresolved` lists nodes inside a deformed cell's tetrahedra for which bisection
/// could show neither a solution nor its absence.
/// Throws InputError for values that are not finite or beyond 10^6 voxels and for a cell torn over
/// more than 2^24 nodes; Cancelled.
OffsetField invert(const Displacement& displacement, const InvertParams& params = {},
                   Progress* progress = nullptr);

/// An inversion that follows a displacement through local changes, such as drags: only the output
/// bricks that changed cells reach, or reached before, are solved again, and every offset and the
/// certificate have the bits that invert() would give them.
/// Memory: 6 kB per output brick with an offset other than 0, 0.1 kB per any other, 0.4 kB per
/// source brick that moved, and 6 bytes per any other.
class IncrementalInversion {
 public:
  /// Inverts everything. Throws like invert(), InputError for a volume of one slice, and
  /// std::logic_error where not all is wanted.
  explicit IncrementalInversion(const Displacement& displacement, const InvertParams& params = {},
                                Progress* progress = nullptr);
  ~IncrementalInversion();

  /// `displacement` has the voxels of the last one; `changed` lists, each once, the bricks of its
  /// topology whose vectors may differ. Returns the sorted origins of the output bricks that were
  /// solved again; some of them may hold no offsets any more. Where material was torn all are.
  std::vector<Vec3i> update(const Displacement& displacement,
                            const std::vector<std::int32_t>& changed);

  /// The offsets as they lie here, until the next update.
  VectorBrickFinder finder() const;
  /// All offsets, copied, without a certificate.
  OffsetField offsets() const;
  /// Measures the residuals of what was solved since they were last asked for, a third of the time
  /// that solving it took. `displacement`: of the last update, or of the construction; with another
  /// one residuals are wrong until those bricks are solved again. One thread at a time may ask for
  /// this or for field().
  InversionCertificate certificate(const Displacement& displacement) const;
  /// offsets() with certificate().
  OffsetField field(const Displacement& displacement) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

/// Offsets at the invalid nodes of every occupied brick and of the bricks that touch it, extended
/// ring by ring from the valid ones, for trilinear look-up at the border of the material. Zero
/// offsets extend to exact zeros; 8 rings fill every occupied brick.
VectorBricks extrapolate_into_bricks(const VectorBricks& offsets, int rings);

}  // namespace supple

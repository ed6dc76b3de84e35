// The offset field, the only handshake between solvers, renderer and exports (design.md section 4).
#pragma once

#include <memory>

#include "volumes/field/certificate.h"
#include "volumes/field/vector_bricks.h"
#include "volumes/geometry/geometry.h"

namespace supple {

class SplitOffsets;

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

}  // namespace supple

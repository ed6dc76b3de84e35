// A dense warp as files hold it, and the offset field that it stands for on a volume's lattice:
// the way back from dense_offsets (design.md sections 2 and 7).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/field/offset_field.h"
#include "volumes/geometry/geometry.h"
#include "volumes/grid/brick_values.h"

namespace supple {

// The vectors of a dense warp, i fastest, kept in runs of 512 where some is not 0: that of a local
// drag takes memory where tissue moves. Cost: 12 bytes per vector of a run that is kept, 8 bytes
// per run.

class WarpVectors {
 public:
  WarpVectors() = default;
  /// Makes `count` vectors, all 0.
  explicit WarpVectors(std::size_t count);
  WarpVectors(const std::vector<Vec3f>& all);

  std::size_t size() const { return m_count; }
  Vec3f operator[](std::size_t n) const { return m_runs.at(n); }
  std::vector<Vec3f> all() const;
  std::size_t bytes() const { return m_runs.bytes(); }

  /// Replaces `count` vectors from number `first` on.
  void put(std::size_t first, const Vec3f* vectors, std::size_t count);

  friend bool operator==(const WarpVectors& a, const WarpVectors& b) {
    return a.m_count == b.m_count && a.m_runs == b.m_runs;
  }

 private:
  std::size_t m_count = 0;
  BrickVectors m_runs;
};

/// Vectors in mm along the axes of LPS on a grid of its own.
struct Warp {
  std::string path;  // for messages
  Geometry geometry;
  std::optional<WarpDirection> direction;  // none: the file does not say
  WarpVectors vectors;                     // i fastest
};

/// The offsets of a resample-direction warp on the lattice of `source`, for any two grids: a voxel
/// at x takes the vector at its place in the warp's grid, trilinear there, exactly that of a grid
/// point within 1e-6 voxel. Bricks cover the warp's grid, so that x may lie outside the source box.
///
/// Void are voxels outside the hull of the warp's grid points, and voxels whose vector leads one
/// voxel or more out of the source box, where nothing can be read. So the border of `void
/// outside` is a border of the material again, not a seam that is interpolated across the whole
/// box.
///
/// A warp that does not record its direction counts as resample. Throws InputError for a
/// material-direction one, for a grid that spans more than 2^24 bricks of the source lattice, and
/// Cancelled. Cost: 12 bytes per voxel of every brick with an offset, 76 bytes per brick spanned;
/// about 50 ns per voxel spanned and core.
OffsetField offsets_from_warp(const Warp& warp, const Geometry& source,
                              Progress* progress = nullptr);

}  // namespace supple

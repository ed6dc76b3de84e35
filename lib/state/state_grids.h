// The grids of a state file (design.md section 7), which state_writer.cpp and state_reader.cpp
// share. Both use io::Stream over an fstream that throws, never delayed, since OpenVDB 10's
// io::File loses errors on full disks and truncated files.
//
// Grids, in this order: `q` (Vec3I, only voxels that moved), `element` (Bool), `density` (Float),
// `beyond_limits` (Vec3I, only where finite elements left links that are to be kept: how far q is
// beyond an admissible one), `rest_i`, `rest_j`, `rest_k` (Vec3I, only where links to the next
// voxel have flowed), `velocity` (Vec3D, mm/s LPS, only where something moves), `cut_links` (Int32,
// only when links are cut; bits 0, 1, 2: the link to the next voxel along i, j, k is absent; bits 3
// to 11, 12 to 20, 21 to 29: the place along it, LinkCuts::Place), `label` (Int32, only when there
// are any; 1 to 65535), `piece` (Int32, only when there are rigid pieces, from 1, whose poses are
// metadata), and derived for other programs `displacement` (Vec3S, material direction, extended
// over the shell) and `offset` (Vec3S, resample direction), in mm LPS. Those before stay in index
// space; the others carry the affine where OpenVDB takes it, and neither they nor later grids are
// read back. The nodes of all trees are those of bricks, so that the file depends on the content
// alone.
//
// A state that refers to its source has kReferringFormat. Its grids `element`, `density`,
// `displacement` and `offset` hold the bricks of its own alone (own_bricks.h), which `own_bricks`
// (Bool, one voxel (i, j, k) for the brick whose smallest voxel is (8i, 8j, 8k)) lists behind
// `density`, also those that are empty.
//
// Cost with Blosc, 3.5 million elements that all moved, one core: 0.5 s and 46 MB to write (0.75 s
// and 69 MB with offsets), 0.25 s to read.
#pragma once

#include <string>

namespace supple {

constexpr const char* kStateFormat = "state 1";
constexpr const char* kReferringFormat = "state 2";  // which readers of the first alone refuse

constexpr const char* kFixedGrid = "q";
constexpr const char* kBeyondGrid = "beyond_limits";
constexpr const char* kElementGrid = "element";
constexpr const char* kDensityGrid = "density";
constexpr const char* kOwnGrid = "own_bricks";
constexpr const char* kVelocityGrid = "velocity";
constexpr const char* kCutGrid = "cut_links";
constexpr const char* kLabelGrid = "label";
constexpr const char* kPieceGrid = "piece";

// Grids that are derived from the others, for other programs. They come last, are three quarters of
// the values of a dragged body, and are not read.
constexpr const char* kDisplacementGrid = "displacement";
constexpr const char* kOffsetGrid = "offset";

inline bool is_derived_grid(const std::string& name) {
  return name == kDisplacementGrid || name == kOffsetGrid;
}

/// The lowest bit of the place of a cut link along an axis; that of axis 3 is the first unused one.
constexpr int place_shift(int axis) {
  return 3 + 9 * axis;
}

}  // namespace supple

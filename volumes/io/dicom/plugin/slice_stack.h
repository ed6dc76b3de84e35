// Sorts the planes of a series into a stack of evenly spaced slices (PS3.3, C.7.6.2.1.1).
//
// Slices are sorted by position along row x column, so that the index frame is right-handed. One
// step of k is the vector from the first slice to the last over the number of steps: where the
// gantry was tilted it is not perpendicular to the slices, and the axes are sheared as the
// acquisition was. Distances may differ from even ones by a tenth of a step (rounded positions; a
// warning from a hundredth on). Gaps of whole steps are missing slices: each holds the values of
// its nearest neighbour, so that all others keep their true places; at most a quarter may be
// missing.
#pragma once

#include <string>
#include <vector>

#include "volumes/io/dicom/plugin/dicom_series.h"

namespace supple {

struct SliceStack {
  std::vector<ImagePlane> slices;        // k rising; a missing one repeats its neighbour
  Vec3d origin;                          // centre of the first voxel, LPS mm
  Vec3d step;                            // of k, mm
  std::vector<std::string> frame_names;  // of several at every position
  std::vector<std::string> warnings;
};

/// Throws InputError for uneven distances, for positions that occur different numbers of times, and
/// for planes at the same positions that nothing tells apart (phase_order.h); `options.frame`
/// chooses among them.
SliceStack stack_slices(const DicomSeries& series, const ReadOptions& options);

}  // namespace supple

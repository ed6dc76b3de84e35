// Meaning of the axes of a NRRD: the lattice, components and frames, and the lattice's place.
// Sources: http://teem.sourceforge.net/nrrd/format.html; without `space`, spacings span LPS axes
// and axis mins give the origin, as ITK reads them; spaces that name no patient axes count as LPS,
// with a warning.
#pragma once

#include <vector>

#include "volumes/io/format/streamed_volume.h"
#include "volumes/io/nrrd/nrrd_header.h"

namespace supple {

struct NrrdAxes {
  std::vector<std::int64_t> sizes;
  std::vector<std::vector<double>> directions;  // per axis, empty for "none"; empty without a space
  std::vector<std::size_t> spatial;             // which of them span the lattice
  std::vector<StoredAxis> order;                // of all five, fastest first
  Vec3i dims{1, 1, 1};
  int components = 1;
  std::int64_t frames = 1;
  bool holds_vectors = false;  // three components that may be a displacement
};

/// Two or three axes are the lattice: those with a direction, or without directions the first that
/// are no others. One axis may hold 2 to 16 components, as its kind says, or as the first without
/// direction; one more is a time series: of kind time, of kind list unless it is the first and
/// short (256 layers in a segmentation) and no sequence of 3D Slicer, or the last without
/// direction. Axes of one sample and no direction are dropped. Throws InputError for everything
/// else.
NrrdAxes nrrd_axes(const NrrdHeader& header);

/// The lattice's index to LPS affine.
Geometry nrrd_geometry(const NrrdHeader& header, const NrrdAxes& axes, const ReadOptions& options);

/// One line where the lengths have a unit that is none; else empty.
std::string warning_of_units(const NrrdHeader& header, const NrrdAxes& axes);

/// One line where the space names no axes of a patient; else empty.
std::string warning_of_space(const NrrdHeader& header);

/// Vectors are mm along the axes of LPS whatever `space` says, as ITK reads and writes them;
/// headers that ask for something else are refused.
void check_frame_of_vectors(const NrrdHeader& header, const NrrdAxes& axes);

/// One entry per vector of the field's text: its components, or none for "none".
std::vector<std::vector<double>> nrrd_vectors(const HeaderField& field);

/// Axes of the space, 0 when none is named; 4 when time is the last.
int nrrd_space_dimension(const NrrdHeader& header);

}  // namespace supple

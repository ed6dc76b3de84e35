// Points of 3D Slicer's markups files (.mrk.json, schema 1.0).
#pragma once

#include "volumes/io/point_file.h"

namespace supple {

/// The defined control points of all point lists, lines, angles and curves in `content`, in their
/// order; each markup says whether its numbers are LPS (also where it says nothing) or RAS. Throws
/// InputError, with file:line where there is one, for text that is no JSON, a missing or unknown
/// type (planes and regions of interest, too), a unit but mm, a position that is not three finite
/// numbers, or no points at all.
/// Cost: 100 times the bytes of the file.
PointFile read_markups(const std::string& path, std::string content);

}  // namespace supple

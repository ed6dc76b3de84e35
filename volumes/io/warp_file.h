// Warp files of other programs and of volume_writer.h: three components per voxel in any format of
// volumes, whatever their value type, byte order and compression (design.md section 7).
#pragma once

#include <string>

#include "volumes/base/progress.h"
#include "volumes/field/dense/warp.h"

namespace supple {

/// Reads a whole warp. Vectors are taken as mm in LPS, as ITK does: a RAS `space` of NRRD flips the
/// grid but not the vectors. Those of NIfTI's intent 1006 are RAS and become LPS. The direction is
/// what our own writer records in the header; files of other programs do not say.
/// Throws InputError for a file of scalars, vectors that are not finite (with their count), an
/// unknown direction, and for everything that open_volume refuses. Cost: 12 bytes per voxel.
/// `grid`: where a transform that names no grid is evaluated.
Warp read_warp(const std::string& path, Progress* progress = nullptr,
               const Geometry* grid = nullptr);

}  // namespace supple

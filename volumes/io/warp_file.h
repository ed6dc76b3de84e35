// Warp files of other programs and of volume_writer.h: three components per voxel in any format of
// volumes, whatever their value type, byte order and compression (design.md section 7).
#pragma once

#include <string>

#include "volumes/base/progress.h"
#include "volumes/field/dense/warp.h"
#include "volumes/io/transform/transform_chain.h"

namespace supple {

/// Reads a whole warp. Vectors are taken as mm in LPS, as ITK does: a RAS `space` of NRRD flips the
/// grid but not the vectors. Those of NIfTI's intent 1006 are RAS and become LPS. The direction is
/// read where our own writer recorded it in the header; files of other programs do not say. Throws
/// InputError for a file of scalars, vectors that are not finite (with their count), an unknown
/// direction, and for everything that open_volume refuses. Cost: 12 bytes per vector other than 0
/// and those beside it. `grid`: where a transform that names no grid is evaluated.
Warp read_warp(const std::string& path, Progress* progress = nullptr,
               const Geometry* grid = nullptr);

/// The transform of a file, at any place: of a registration program, or a warp of resample
/// direction in any format, which moves nothing outside of its grid, as in ITK. Throws InputError
/// as read_warp, and for a warp of material direction. `grid`: where a mesh is evaluated.
TransformChain read_transform(const std::string& path, Progress* progress = nullptr,
                              const Geometry* grid = nullptr);

}  // namespace supple

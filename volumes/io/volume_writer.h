// Dense volumes and warp fields for other programs, one slice at a time, written atomically.
// Design section 7. Cost: one slice of memory; the disk's speed.
#pragma once

#include <string>
#include <vector>

#include "volumes/field/resample.h"
#include "volumes/field/warp.h"
#include "volumes/io/volume_file.h"

namespace supple {

/// Scalar volume; the format follows the extension: .nrrd, .nhdr (+ .raw), .mha, .mhd (+ .raw).
/// Values are rounded and clamped for integer types; NaN becomes 0 there.
/// Throws InputError (unknown extension; sheared geometry in MetaImage) and SystemError.
void write_volume(const std::string& path, const Geometry& geometry, ValueType type,
                  const ScalarSliceSource& slices, Progress* progress = nullptr);

/// Vector field in LPS mm, float32, components fastest; the same extensions. The direction is
/// recorded in the header (NRRD: key `supple direction`; MetaImage: comment). Errors as above.
void write_warp(const std::string& path, const Geometry& geometry, WarpDirection direction,
                const VectorSliceSource& slices, Progress* progress = nullptr);

/// The files that writing to `path` creates or replaces: itself, and for detached headers the
/// `.raw` beside it. Throws InputError for an unknown extension.
std::vector<std::string> output_files(const std::string& path);

}  // namespace supple

// Dense volumes and warp fields for other programs, one slice at a time, written atomically.
#pragma once

#include <string>

#include "volumes/field/resample.h"
#include "volumes/io/volume_file.h"

namespace supple {

enum class WarpDirection { resample, material };

/// Scalar volume; the format follows the extension: .nrrd, .nhdr (+ .raw), .mha, .mhd (+ .raw).
/// Values are rounded and clamped for integer types.
/// Throws InputError (unknown extension; sheared geometry in MetaImage) and SystemError.
void write_volume(const std::string& path, const Geometry& geometry, ValueType type,
                  const ScalarSliceSource& slices, Progress* progress = nullptr);

/// Vector field in LPS mm, float32: .nrrd (kinds vector domain domain domain) or .mha. The
/// direction is recorded in the header. Errors as above.
void write_warp(const std::string& path, const Geometry& geometry, WarpDirection direction,
                const VectorSliceSource& slices, Progress* progress = nullptr);

}  // namespace supple

// Slices in files of their own: TIFF or PNG images of a folder, or those that a pattern such as
// slice_%04d.tif names, in the order of their numbers.
#pragma once

#include <memory>
#include <string>

#include "volumes/io/format/volume_file.h"

namespace supple {

/// True when `path` is no file but a pattern with one %d, %4d or %04d in its file name.
bool is_series_pattern(const std::string& path);

/// The volume of a folder's images, or of those that a pattern names. Throws InputError: no image,
/// several formats; when a slice is read: one that differs from the first in size or type.
std::unique_ptr<VolumeFile> open_image_series(const std::string& path, const ReadOptions& options);

}  // namespace supple

// A stack of DICOM slices as a volume. Values stay as they are stored, with the rescale of all
// slices as slope and intercept; where slices differ in it (PET), they become float32 after each
// slice's own. Memory: the attributes of the series (about 1 kB per slice) and one frame.
#pragma once

#include <memory>
#include <string>

#include "volumes/io/format/volume_file.h"

namespace supple {

/// Throws as open_dicom does.
std::unique_ptr<VolumeFile> open_series(const std::string& path, const ReadOptions& options);

}  // namespace supple

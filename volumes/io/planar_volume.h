// A volume of several components per voxel that a file holds one whole volume after another, as
// NIfTI does: slices come out with the components together.
// Cost: a source per component, each at its own place, and one slice of one component. Of plain
// files every byte is read once. Deflated ones are decoded from their start for every component:
// for n components (n + 1) / 2 times the whole stream.
#pragma once

#include <memory>

#include "volumes/io/streamed_volume.h"

namespace supple {

/// `layout.range` is the place of the first component; the next one starts `stride` bytes behind
/// it in the decompressed stream. Throws InputError where the file is too short.
std::unique_ptr<VolumeFile> open_planes(const std::shared_ptr<const InputFile>& data,
                                        StreamLayout layout, std::int64_t stride);

}  // namespace supple

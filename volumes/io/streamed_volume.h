// A volume whose values lie in one run of bytes, i fastest: what raw, NRRD, MetaImage and NIfTI
// files are once their headers are understood. Cost: no memory beyond the caller's slice.
#pragma once

#include <memory>

#include "volumes/io/byte_source.h"
#include "volumes/io/volume_file.h"

namespace supple {

/// Everything that a header says about the values that follow it.
struct StreamLayout {
  VolumeHeader header;
  bool big_endian = false;
  ByteRange range;  // `size` is filled in by open_stream
};

/// Checks the claimed size against the file and returns the volume, before its first slice.
std::unique_ptr<VolumeFile> open_stream(std::shared_ptr<const InputFile> data, StreamLayout layout);

}  // namespace supple

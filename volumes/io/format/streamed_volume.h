// A volume whose values lie in runs of bytes, as those of raw, NRRD, MetaImage and NIfTI files once
// their headers are understood. The axes of the values may lie in any order that keeps i before j
// before k, components and frames of a time series before, between or behind them.
// Cost: no memory beyond the caller's slice where the values lie as the caller wants them; else all
// that lies between one slice and the next.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

// The values of a volume in one file or in several, one after the other. All files are checked when
// the volume is opened; afterwards one of them is open at a time.

struct DataPart {
  std::string path;
  ByteRange range;
};

using DataParts = std::vector<DataPart>;

/// All bytes of checked parts, from the first on.
std::unique_ptr<ByteSource> open_parts(std::shared_ptr<const DataParts> parts);

enum class StoredAxis { component, i, j, k, frame };

/// Everything that a header says about the values that follow it.
struct StreamLayout {
  VolumeHeader header;
  bool big_endian = false;
  ByteRange range;  // in every file; `size` is filled in by open_stream
  /// Axes of the values, fastest first.
  std::vector<StoredAxis> order = {StoredAxis::component, StoredAxis::i, StoredAxis::j,
                                   StoredAxis::k, StoredAxis::frame};
  std::int64_t frames = 1;
  std::int64_t frame = 0;  // the one to read
};

/// Files that hold equal shares of the values, in their order.
struct DataFiles {
  std::int64_t count = 1;
  std::function<std::string(std::int64_t)> path_of;  // asked for 0 to count - 1
  /// Adapts a range to its file, such as for headers of the files' own; may be empty.
  std::function<void(const InputFile&, ByteRange&)> adapt;
};

/// Bytes of all values of all frames, decoded. Throws InputError where 64 bits do not suffice.
std::int64_t claimed_bytes(const StreamLayout& layout);

/// Checks the claimed sizes against the files, one after the other, and returns the volume before
/// its first slice.
std::unique_ptr<VolumeFile> open_stream(const DataFiles& files, StreamLayout layout);
std::unique_ptr<VolumeFile> open_stream(std::shared_ptr<const InputFile> data, StreamLayout layout);

}  // namespace supple

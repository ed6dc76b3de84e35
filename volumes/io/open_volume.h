// Opens a volume file of any supported format.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "volumes/base/fields.h"
#include "volumes/base/progress.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

/// Chooses the format by the file's content first and its extension second. Throws InputError:
/// missing, empty, unknown format, bad header, wrong length, an option that does not fit the file,
/// several frames or channels of which none was chosen, vectors instead of scalars (read_warp of
/// warp_file.h takes those). `progress` receives the warnings about a file that can be read.
std::unique_ptr<VolumeFile> open_volume(const std::string& path, const ReadOptions& options = {},
                                        Progress* progress = nullptr);

/// Options for reading a volume that a user names.
Fields fields(ReadOptions& options);

/// Opens the files of open_volume(), and files of vectors when no channel is chosen.
std::unique_ptr<VolumeFile> open_scalars_or_vectors(const std::string& path,
                                                    const ReadOptions& options = {});

/// Every file that the volume is read from.
std::vector<std::string> files_of(const VolumeHeader& header);

}  // namespace supple

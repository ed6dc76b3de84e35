// A volume that is read, passed through filters, and written in the format of its new name.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "volumes/base/fields.h"
#include "volumes/base/progress.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

/// Opens the volume, filters included, at its first slice.
using VolumeOpener = std::function<std::unique_ptr<VolumeFile>()>;

/// Keys for writing densities as renderers take them.
Fields fog_fields(WriteOptions& options);

/// Warnings of the input and the output go to the progress. `open` is called a second time where
/// integers with slope and intercept meet a format without: the new type depends on how far they
/// reach.
void write_converted(const VolumeOpener& open, const std::string& output,
                     const WriteOptions& options, Progress& progress);

}  // namespace supple::tools

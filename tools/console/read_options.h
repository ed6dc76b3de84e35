// --raw, --frame, --channel and --spacing: what the user says of a volume that does not say it; and
// how files are to be written.
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "tools/console/console.h"
#include "volumes/io/format/dense_writer.h"

namespace supple::tools {

void add_read_options(CLI::App& app, ReadOptions& options);

/// --compress.
void add_write_options(CLI::App& app, WriteOptions& options);
/// --intent of NIfTI warps.
void add_warp_options(CLI::App& app, WriteOptions& options);

/// open_volume, with what the reader warns of printed.
std::unique_ptr<VolumeFile> open_input(const std::string& path, const ReadOptions& options,
                                       Console& console);

/// Throws InputError when an option is set: `path` is a state, which says everything itself.
void require_unused(const ReadOptions& options, const std::string& path);

}  // namespace supple::tools

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

}  // namespace supple::tools

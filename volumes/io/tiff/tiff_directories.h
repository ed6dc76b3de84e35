// Places of the directories of a TIFF or BigTIFF file. Pages are then reached by offset instead of
// by number, which libtiff finds only by walking the chain from its start.
// Source: TIFF 6.0, section 2; BigTIFF (libtiff.gitlab.io/libtiff/specification/bigtiff.html).
// Cost: two small reads and 8 bytes per directory.
#pragma once

#include <cstdint>
#include <vector>

#include "volumes/io/bytes/byte_source.h"

namespace supple {

/// True when the bytes start like a TIFF or BigTIFF file.
bool is_tiff(const std::string& head);

/// Byte offsets of the directories of the main chain, in order; one at least. Throws InputError for
/// a chain that leaves the file or comes back to itself.
std::vector<std::uint64_t> tiff_directories(const InputFile& file);

/// True when the values of the file are big-endian.
bool is_big_endian_tiff(const InputFile& file);

}  // namespace supple

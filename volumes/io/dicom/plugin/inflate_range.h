// Part of a deflated dataset (PS3.5, A.5): a raw deflate stream that starts inside the file.
#pragma once

#include <cstdint>
#include <string>

#include "volumes/io/bytes/byte_source.h"

namespace supple {

/// Up to `count` bytes of the stream from `skip` on, fewer only at its end. Throws InputError for a
/// damaged stream. Cost: all in front is inflated again and dropped; memory is the result.
std::string inflate_range(const InputFile& file, std::int64_t file_offset, std::int64_t skip,
                          std::size_t count);

}  // namespace supple

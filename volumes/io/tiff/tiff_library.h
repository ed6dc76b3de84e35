// The messages of libtiff, kept instead of printed.
#pragma once

#include <string>

#include <tiffio.h>

namespace supple {

/// The most that libtiff may allocate at once.
constexpr tmsize_t kMaxTiffAllocation = tmsize_t(1) << 30;

/// Opens a file as TIFFOpen does; the first error goes to `message`, which must outlive the handle.
/// Files are not mapped into memory, so that one that shrinks meanwhile is an error and no signal.
TIFF* open_tiff_quietly(const std::string& path, const std::string& mode, std::string& message);

}  // namespace supple

// How the pixels of a file are stored (PS3.3, C.7.6.3; PS3.5, 8.1), and the values in them.
#pragma once

#include <cstdint>
#include <string>

#include "volumes/io/dicom/plugin/dicom_file.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

struct PixelFormat {
  int rows = 0, columns = 0;
  int bits_allocated = 0, bits_stored = 0, high_bit = 0;
  bool is_signed = false;
  bool inverted = false;  // MONOCHROME1: the smallest value is the brightest

  std::int64_t frame_bytes() const { return std::int64_t(rows) * columns * (bits_allocated / 8); }
  ValueType type() const;
};

/// Throws InputError for colour and for all but 8, 16 and 32-bit grey images.
PixelFormat pixel_format(const std::string& path, DcmItem& dataset);

/// Leaves of every value the stored bits, as a number of the allocated width: other bits (overlays)
/// are masked, the sign is extended. `values` holds one frame in native byte order.
void unpack_stored_bits(const PixelFormat& format, void* values);

/// slope * stored + intercept of an inverted image, as a rescale of the stored values.
void invert_rescale(const PixelFormat& format, double& slope, double& intercept);

}  // namespace supple

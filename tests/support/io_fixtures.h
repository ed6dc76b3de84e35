// Files for the reader tests, written byte by byte or by the formats' own libraries, never by the
// project's writers.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {

/// Values as they lie in memory, or with every value's bytes reversed.
template <class T>
std::string bytes_of_values(const std::vector<T>& values, bool big_endian = false) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  if (!big_endian) return bytes;
  std::string swapped = bytes;
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    swapped[n] = bytes[n - n % sizeof(T) + sizeof(T) - 1 - n % sizeof(T)];
  }
  return swapped;
}

std::string gzip(const std::string& bytes);
std::string zlib_stream(const std::string& bytes);

/// A NIfTI-1 header of 352 bytes (int16, dims, 1 mm, sform and qform unset), to be patched.
std::string nifti_header(const std::vector<int>& dims);
template <class T>
void patch(std::string& bytes, std::size_t offset, T value) {
  bytes.replace(offset, sizeof value, reinterpret_cast<const char*>(&value), sizeof value);
}

void write_png(const std::string& path, int width, int height, int bits, int color_type,
               const std::string& rows, bool interlaced = false);

struct TiffOptions {
  int bits = 8;
  int sample_format = 1;  // 1 unsigned, 2 signed, 3 float
  int photometric = 1;    // 0 MinIsWhite, 1 MinIsBlack
  int compression = 1;    // 1 none, 8 deflate
  int tile = 0;           // tile size, 0 for strips
  int samples = 1;
  bool planar = false;     // rows hold one plane after the other
  int subfile = 0;         // 1 a reduced-resolution copy
  const char* mode = "w";  // "w8" BigTIFF, "wb" big-endian, "a" one more page
  std::string description = {};
  double x_resolution = 0, y_resolution = 0;
  int resolution_unit = 0;
};
void write_tiff(const std::string& path, int width, int height, const TiffOptions& options,
                const std::string& rows);

/// All stored values in native byte order.
std::string read_all(VolumeFile& file);

/// The line of the InputError that opening and reading the file throws; "" when it reads.
std::string failure_of(const std::string& path, const ReadOptions& options = {});

}  // namespace supple::test

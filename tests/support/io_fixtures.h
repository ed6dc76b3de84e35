// Files for the reader tests, written byte by byte or by the formats' own libraries, never by the
// project's writers.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {

const std::vector<std::int16_t> kShorts = {-5, 0, 1, 2, 300, -300, 7, 8, 9, 10, 11, 12};

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

/// The same of one value.
template <class T>
std::string bytes_of_value(T value, bool big_endian = false) {
  return bytes_of_values(std::vector<T>{value}, big_endian);
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

ReadOptions choice(std::optional<int> frame, std::optional<int> channel = {});

/// All stored values in native byte order.
std::string read_all(VolumeFile& file);
std::string read_all(const std::string& path);

/// The line of the InputError that opening and reading the file throws; "" when it reads.
std::string failure_of(const std::string& path, const ReadOptions& options = {});
/// The same of reading it as a warp.
std::string failure_of_warp(const std::string& path);
/// The file must fail with a single short line that holds all of `parts`.
void expect_failure(const std::string& path, const std::vector<std::string>& parts,
                    const ReadOptions& options = {});
/// Expects an error `line` about `path` that holds all of `parts`.
void expect_parts(const std::string& path, const std::string& line,
                  const std::vector<std::string>& parts);

}  // namespace supple::test

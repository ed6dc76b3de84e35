// NIfTI files for the reader tests: headers of version 1, patched byte by byte, and extensions.
#pragma once

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {

// Offsets of fields in the header of NIfTI-1.
constexpr std::size_t kIntent = 68, kDatatype = 70, kBitpix = 72, kOffset = 108, kUnits = 123;

template <class T>
std::vector<T> counted(int count, int first = 0) {
  std::vector<T> values;
  for (int n = 0; n < count; ++n) values.push_back(T(first + n));
  return values;
}

inline std::string nifti_header_of(const std::vector<int>& dims, int datatype, int bits,
                                   int intent = 0) {
  std::string header = nifti_header(dims);
  patch(header, kDatatype, std::int16_t(datatype));
  patch(header, kBitpix, std::int16_t(bits));
  patch(header, kIntent, std::int16_t(intent));
  return header;
}

/// All slices with their components together.
inline std::string all_slices(VolumeFile& file) {
  const Vec3i& dims = file.header().geometry.dims();
  const std::size_t slice = std::size_t(stored_bytes(file.header())) / std::size_t(dims.z);
  std::string bytes(slice * std::size_t(dims.z), '\0');
  for (int k = 0; k < dims.z; ++k) file.read_slice(bytes.data() + slice * std::size_t(k));
  return bytes;
}

template <class T>
std::vector<T> values_of(const std::string& path, const ReadOptions& options = {}) {
  const auto file = open_scalars_or_vectors(path, options);
  const std::string bytes = all_slices(*file);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

inline ReadOptions frame(int number) {
  ReadOptions options;
  options.frame = number;
  return options;
}

inline std::string nifti_failure(const std::string& path, const ReadOptions& options = {}) {
  try {
    all_slices(*open_scalars_or_vectors(path, options));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline void expect_refused(const std::string& path, const std::vector<std::string>& parts,
                           const ReadOptions& options = {}) {
  const std::string line = nifti_failure(path, options);
  EXPECT_NE(line, "") << path << " was read";
  for (const std::string& part : parts) {
    EXPECT_NE(line.find(part), std::string::npos) << "\"" << part << "\" in: " << line;
  }
}

/// The header's numbers with their bytes reversed.
inline std::string reversed_fields(std::string header) {
  const auto reverse = [&](std::size_t from, std::size_t to, std::size_t width) {
    for (std::size_t at = from; at < to; at += width) {
      std::reverse(header.begin() + std::ptrdiff_t(at),
                   header.begin() + std::ptrdiff_t(at + width));
    }
  };
  reverse(0, 4, 4);
  reverse(40, 56, 2);
  reverse(68, 74, 2);
  reverse(76, 120, 4);
  reverse(252, 256, 2);
  reverse(256, 328, 4);
  return header;
}

/// esize, ecode and the text, padded to a multiple of 16.
inline std::string nifti_extension_of(std::int32_t code, std::string text) {
  while ((8 + text.size()) % 16 != 0) text += '\0';
  std::string head(8, '\0');
  patch(head, 0, std::int32_t(8 + text.size()));
  patch(head, 4, code);
  return head + text;
}

inline std::string with_extensions(std::string header, const std::string& extensions) {
  header[348] = 1;
  patch(header, kOffset, float(352 + extensions.size()));
  return header + extensions;
}

/// Three components of 3 x 2 x 2 voxels, slowest.
inline const std::vector<int> kWarpDims = {3, 2, 2, 1, 3};
inline std::string warp_header(int intent) {
  return nifti_header_of(kWarpDims, 16, 32, intent);
}

}  // namespace supple::test

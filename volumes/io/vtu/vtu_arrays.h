// The arrays of VTK's XML files as numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// How a file stores its arrays.
struct VtuEncoding {
  std::string path;  // for errors
  bool is_big_endian = false;
  bool is_header_64 = false;
  bool is_compressed = false;    // by zlib
  std::string_view appended;     // behind its "_"
  bool is_appended_raw = false;  // else base64
};

/// One <DataArray>.
struct VtuArray {
  std::string name, type, format, text;
  std::int64_t offset = 0;  // of appended data
};

/// All numbers of an array. Throws InputError: a type, format or encoding that there is not, data
/// that end early or cannot be decoded.
std::vector<double> numbers_of(const VtuArray& array, const VtuEncoding& encoding);

}  // namespace supple

#include "volumes/io/vtu/vtu_arrays.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>

#include <zlib.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// No mesh has arrays of more bytes; damaged headers claim them.
constexpr std::uint64_t kMostBytes = std::uint64_t(1) << 34;

[[noreturn]] void fail_array(const VtuArray& array, const VtuEncoding& encoding,
                             const std::string& found, const std::string& expected) {
  throw InputError({encoding.path, "DataArray " + array.name, found, expected});
}

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/// The bytes of an array, plain or in base64, front to back.
class ArrayBytes {
 public:
  ArrayBytes(const VtuArray& array, const VtuEncoding& encoding)
      : m_array(array), m_encoding(encoding) {
    const bool is_appended = array.format == "appended";
    m_is_base64 = !is_appended || !encoding.is_appended_raw;
    m_rest = array.text;
    if (is_appended) {
      if (array.offset < 0 || std::uint64_t(array.offset) >= encoding.appended.size()) {
        fail("offset " + std::to_string(array.offset), "a place in the appended data");
      }
      m_rest = encoding.appended.substr(std::size_t(array.offset));
    }
    if (m_is_base64) skip_blanks();
  }

  /// The next `size` bytes. A group of base64 of its own begins and ends with them.
  std::string group(std::uint64_t size) {
    if (!m_is_base64) {
      if (size > m_rest.size()) fail_short(size);
      const std::string bytes(m_rest.substr(0, std::size_t(size)));
      m_rest.remove_prefix(std::size_t(size));
      return bytes;
    }
    const std::uint64_t letters = (size + 2) / 3 * 4;
    if (letters > m_rest.size()) fail_short(size);
    std::string bytes = decoded(m_rest.substr(0, std::size_t(letters)));
    m_rest.remove_prefix(std::size_t(letters));
    if (bytes.size() < size) fail_short(size);
    bytes.resize(std::size_t(size));
    return bytes;
  }

  /// A header and what follows in the same group of base64, or in one of its own: `more(header)`
  /// says how much.
  template <class More>
  std::string header_and(std::uint64_t header, const More& more) {
    if (!m_is_base64) {
      const std::string first = group(header);
      return group(more(first));
    }
    const std::string_view begin = m_rest;
    const std::string first = group(header);
    const std::uint64_t size = more(first);
    // A group that ends with the header holds it alone.
    const std::string_view letters = begin.substr(0, begin.size() - m_rest.size());
    const std::size_t padding = letters.size() - letters.find_last_not_of('=') - 1;
    if (padding > 0 && padding == (3 - header % 3) % 3) return group(size);
    m_rest = begin;
    return group(header + size).substr(std::size_t(header));
  }

 private:
  void skip_blanks() {
    while (!m_rest.empty() && std::isspace(static_cast<unsigned char>(m_rest.front())) != 0) {
      m_rest.remove_prefix(1);
    }
  }

  std::string decoded(std::string_view letters) const {
    std::string bytes;
    bytes.reserve(letters.size() / 4 * 3);
    for (std::size_t n = 0; n + 4 <= letters.size(); n += 4) {
      std::uint32_t bits = 0;
      int padding = 0;
      for (std::size_t c = 0; c < 4; ++c) {
        const char letter = letters[n + c];
        const int digit = base64_digit(letter);
        padding += letter == '=';
        if (digit < 0 && letter != '=') fail("'" + std::string(1, letter) + "'", "base64");
        bits = bits << 6 | std::uint32_t(std::max(0, digit));
      }
      for (int byte = 0; byte < 3 - padding; ++byte) bytes += char(bits >> (16 - 8 * byte) & 0xFF);
    }
    return bytes;
  }

  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    fail_array(m_array, m_encoding, found, expected);
  }
  [[noreturn]] void fail_short(std::uint64_t size) const {
    fail(std::to_string(m_rest.size()) + " characters", std::to_string(size) + " bytes");
  }

  const VtuArray& m_array;
  const VtuEncoding& m_encoding;
  std::string_view m_rest;
  bool m_is_base64;
};

void to_native_order(char* value, std::size_t size, const VtuEncoding& encoding) {
  if (encoding.is_big_endian) std::reverse(value, value + size);
}

/// Number n of a header.
std::uint64_t header_word(std::string header, std::size_t n, const VtuEncoding& encoding) {
  const std::size_t size = encoding.is_header_64 ? 8 : 4;
  char* at = &header[n * size];
  to_native_order(at, size, encoding);
  std::uint64_t word = 0;
  std::memcpy(&word, at, size);
  return word;
}

std::string inflated_blocks(const VtuArray& array, const VtuEncoding& encoding, ArrayBytes& bytes) {
  const std::uint64_t word = encoding.is_header_64 ? 8 : 4;
  std::uint64_t blocks = 0, block_size = 0, last_size = 0;
  // Blocks, their size, that of the last (0: whole), then the compressed size of each.
  const std::string listed = bytes.header_and(3 * word, [&](const std::string& header) {
    blocks = std::min(header_word(header, 0, encoding), kMostBytes / word);
    block_size = header_word(header, 1, encoding);
    last_size = header_word(header, 2, encoding);
    return blocks * word;
  });
  std::vector<std::uint64_t> sizes(blocks);  // which the file is long enough for
  for (std::size_t n = 0; n < sizes.size(); ++n) sizes[n] = header_word(listed, n, encoding);
  std::uint64_t all = 0;
  for (const std::uint64_t size : sizes) all += std::min(size, kMostBytes);
  if (block_size > kMostBytes || last_size > block_size || all > kMostBytes) {
    fail_array(array, encoding, "blocks of " + std::to_string(block_size) + " bytes",
               "sizes of blocks");
  }
  const std::string compressed = bytes.group(all);
  std::string content, block;
  std::size_t at = 0;
  for (std::size_t n = 0; n < sizes.size(); ++n) {
    const bool is_short = n + 1 == sizes.size() && last_size > 0;
    uLongf size = uLongf(is_short ? last_size : block_size);
    // A block larger than zlib can make of so few bytes is damage.
    if (size / 1100 > sizes[n] + 1) fail_array(array, encoding, "a short block", "data by zlib");
    block.resize(size);
    const int done = uncompress(reinterpret_cast<Bytef*>(&block[0]), &size,
                                reinterpret_cast<const Bytef*>(&compressed[at]), uLong(sizes[n]));
    if (done != Z_OK || size != block.size()) {
      fail_array(array, encoding, "a damaged block", "data by zlib");
    }
    content += block;
    at += std::size_t(sizes[n]);
  }
  return content;
}

std::string plain_bytes(const VtuEncoding& encoding, ArrayBytes& bytes) {
  return bytes.header_and(encoding.is_header_64 ? 8 : 4, [&](const std::string& header) {
    return std::min(header_word(header, 0, encoding), kMostBytes);
  });
}

template <class T>
std::vector<double> values_of(const std::string& bytes, const VtuEncoding& encoding) {
  std::vector<double> values(bytes.size() / sizeof(T));
  for (std::size_t n = 0; n < values.size(); ++n) {
    char stored[sizeof(T)];
    std::memcpy(stored, &bytes[n * sizeof(T)], sizeof(T));
    to_native_order(stored, sizeof(T), encoding);
    T value;
    std::memcpy(&value, stored, sizeof(T));
    values[n] = double(value);
  }
  return values;
}

std::vector<double> text_numbers(const VtuArray& array, const VtuEncoding& encoding) {
  std::vector<double> values;
  const char* at = array.text.c_str();
  while (true) {
    while (std::isspace(static_cast<unsigned char>(*at)) != 0) ++at;
    if (*at == '\0') return values;
    char* end = nullptr;
    values.push_back(std::strtod(at, &end));
    if (end == at) fail_array(array, encoding, "'" + std::string(at, 1) + "'", "numbers");
    at = end;
  }
}

}  // namespace

std::vector<double> numbers_of(const VtuArray& array, const VtuEncoding& encoding) {
  if (array.format == "ascii") return text_numbers(array, encoding);
  if (array.format != "binary" && array.format != "appended") {
    fail_array(array, encoding, "format \"" + array.format + "\"", "ascii, binary or appended");
  }
  ArrayBytes stored(array, encoding);
  const std::string bytes = encoding.is_compressed ? inflated_blocks(array, encoding, stored)
                                                   : plain_bytes(encoding, stored);
  if (array.type == "Float64") return values_of<double>(bytes, encoding);
  if (array.type == "Float32") return values_of<float>(bytes, encoding);
  if (array.type == "Int64") return values_of<std::int64_t>(bytes, encoding);
  if (array.type == "UInt64") return values_of<std::uint64_t>(bytes, encoding);
  if (array.type == "Int32") return values_of<std::int32_t>(bytes, encoding);
  if (array.type == "UInt32") return values_of<std::uint32_t>(bytes, encoding);
  if (array.type == "Int16") return values_of<std::int16_t>(bytes, encoding);
  if (array.type == "UInt16") return values_of<std::uint16_t>(bytes, encoding);
  if (array.type == "Int8") return values_of<std::int8_t>(bytes, encoding);
  if (array.type == "UInt8") return values_of<std::uint8_t>(bytes, encoding);
  fail_array(array, encoding, "type \"" + array.type + "\"", "Float32, Float64 or a whole number");
}

}  // namespace supple

#include "volumes/io/tiff/tiff_directories.h"

#include <unordered_set>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// Reads the numbers of a TIFF file, in its byte order.
class TiffNumbers {
 public:
  explicit TiffNumbers(const InputFile& file) : m_file(file) {
    const std::string head = file.head(4);
    if (!is_tiff(head)) {
      throw InputError({file.path(), "TIFF", "no TIFF header", "\"II\" or \"MM\", then 42 or 43"});
    }
    m_big_endian = head[0] == 'M';
    m_is_bigtiff = head[m_big_endian ? 3 : 2] == 43;
  }

  bool is_big_endian() const { return m_big_endian; }
  std::uint64_t first_directory() const { return m_is_bigtiff ? number(8, 8) : number(4, 4); }

  std::uint64_t next_directory(std::uint64_t directory) const {
    const std::uint64_t count_bytes = m_is_bigtiff ? 8 : 2, entry_bytes = m_is_bigtiff ? 20 : 12;
    const std::uint64_t count = number(directory, count_bytes);
    if (count > std::uint64_t(m_file.size()) / entry_bytes) {
      throw InputError({m_file.path(), "TIFF directory at byte " + std::to_string(directory),
                        std::to_string(count) + " entries", "entries that fit into the file"});
    }
    return number(directory + count_bytes + count * entry_bytes, m_is_bigtiff ? 8 : 4);
  }

 private:
  std::uint64_t number(std::uint64_t offset, std::uint64_t bytes) const {
    unsigned char text[8];
    const auto size = std::uint64_t(m_file.size());
    if (offset > size || size - offset < bytes ||
        m_file.read_at(std::int64_t(offset), text, bytes) < bytes) {
      throw InputError({m_file.path(), "TIFF directories",
                        "one at byte " + std::to_string(offset) + " of " + std::to_string(size),
                        "directories inside the file"});
    }
    std::uint64_t value = 0;
    for (std::uint64_t n = 0; n < bytes; ++n) {
      value = value << 8 | text[m_big_endian ? n : bytes - 1 - n];
    }
    return value;
  }

  const InputFile& m_file;
  bool m_big_endian = false;
  bool m_is_bigtiff = false;
};

}  // namespace

bool is_tiff(const std::string& head) {
  for (const char* mark : {"II*\0", "MM\0*", "II+\0", "MM\0+"}) {
    if (head.compare(0, 4, mark, 4) == 0) return true;
  }
  return false;
}

std::vector<std::uint64_t> tiff_directories(const InputFile& file) {
  const TiffNumbers numbers(file);
  std::vector<std::uint64_t> directories;
  std::unordered_set<std::uint64_t> seen;
  for (std::uint64_t at = numbers.first_directory(); at != 0; at = numbers.next_directory(at)) {
    if (!seen.insert(at).second) {
      throw InputError(
          {file.path(), "TIFF directories",
           "directory " + std::to_string(directories.size()) + " is followed by an earlier one",
           "a chain that ends"});
    }
    directories.push_back(at);
  }
  if (directories.empty()) throw InputError({file.path(), "TIFF pages", "none", "one or more"});
  return directories;
}

bool is_big_endian_tiff(const InputFile& file) {
  return TiffNumbers(file).is_big_endian();
}

}  // namespace supple

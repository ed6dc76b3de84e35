// A file to read from any place in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace supple {

/// An open regular file. Throws InputError for a missing or empty file, a folder or a device.
class InputFile {
 public:
  explicit InputFile(std::string path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& path() const { return m_path; }
  std::int64_t size() const { return m_size; }
  /// Reads up to `size` bytes from `offset` on; fewer only at the end of the file.
  std::size_t read_at(std::int64_t offset, void* out, std::size_t size) const;
  /// The first bytes of the file, at most `limit`.
  std::string head(std::size_t limit) const;

 private:
  std::string m_path;
  int m_descriptor;
  std::int64_t m_size;
};

}  // namespace supple

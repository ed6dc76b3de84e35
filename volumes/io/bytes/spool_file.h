// A file without a name for values that must be written in another order than they come, so that
// nothing of it remains however the program ends. File systems that know no such files give it a
// name for a moment; a program that is killed then leaves it empty.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace supple {

class SpoolFile {
 public:
  /// Opens a file in the folder of `final_path`, which has room for the result and which errors
  /// name. Throws SystemError.
  explicit SpoolFile(const std::string& final_path);
  ~SpoolFile();
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;

  /// Throws SystemError (disk full).
  void write_at(std::int64_t offset, const void* data, std::size_t size);
  /// Throws SystemError; bytes that were never written are one.
  void read_at(std::int64_t offset, void* out, std::size_t size) const;

 private:
  std::string m_final_path;
  int m_descriptor;
};

}  // namespace supple

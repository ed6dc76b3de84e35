// Files of the tests: a temporary folder, whole files as bytes, and a file-size limit that makes
// writing fail as a full disk does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/resource.h>

#include "volumes/base/files.h"

namespace supple::test {

class TemporaryFolder : public ScratchFolder {
 public:
  TemporaryFolder();

  /// Names of everything in it, sorted.
  std::vector<std::string> entries() const;
  /// Writes the bytes and returns the path.
  std::string write(const std::string& name, const std::string& bytes) const;
};

/// A whole file; throws std::runtime_error where it cannot be opened.
std::string read_text(const std::string& path);
/// A file that is kept, under SUPPLE_TEST_OUTPUT or the system's temporary folder; makes its
/// folder.
std::string output_path(const std::string& name);
/// A new file each time: truncating an old one makes some file systems flush it on close.
void write_text(const std::string& path, const std::string& bytes);

/// While it lives no file of this process can grow beyond `bytes`.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes);
  ~FileSizeLimit();
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit m_before{};
  void (*m_handler)(int) = nullptr;
};

}  // namespace supple::test

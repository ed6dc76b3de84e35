// A file that appears under its final name only when it is complete.
#pragma once

#include <string>

namespace supple {

/// Owns a temporary file beside `final_path`. Write to `path()` by any means, then commit().
/// Without commit() the destructor removes the temporary file and the final name is untouched.
class AtomicFile {
 public:
  /// Creates the temporary file. Throws SystemError (no permission, disk full) or InputError
  /// (the folder does not exist, the final path is a folder).
  explicit AtomicFile(std::string final_path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::string& path() const { return m_temporary_path; }
  const std::string& final_path() const { return m_final_path; }

  /// Flushes to disk (fsync) and renames to the final name. Throws SystemError.
  void commit();

 private:
  std::string m_final_path;
  std::string m_temporary_path;
};

}  // namespace supple
